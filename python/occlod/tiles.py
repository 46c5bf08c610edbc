"""3D Tiles in one call."""

from __future__ import annotations

import os
import pathlib
from collections.abc import Callable
from typing import Literal

from ._occlod import (
    Borders,
    ErrorBound,
    Grouping,
    Hlod,
    Mesh,
    Scene,
    TilesetCounts,
    UpAxis,
    build_hlod,
    check_tileset_output,
    read_hlod_and_report,
    read_mesh_and_report,
    write_tileset,
)


def _read(path: pathlib.Path) -> Mesh | Hlod:
    if path.suffix == ".ohlod":
        return read_hlod_and_report(path)[0]
    if path.suffix == ".json":
        return Scene.read(path).flatten()[0]
    return read_mesh_and_report(path)[0]


def write_tiles(
    what: Mesh | Hlod | str | os.PathLike[str],
    folder: str | os.PathLike[str],
    *,
    node_triangles: int = 2000,
    threads: int = 0,
    meshopt: bool = False,
    quantise_bits: int | None = None,
    skirts: bool = False,
    up: UpAxis | None = None,
    origin: tuple[float, float, float] | None = None,
    images: str | os.PathLike[str] | None = None,
    texture_format: Literal["png", "jpeg"] | None = None,
    replace: bool = False,
    progress: Callable[[float], object] | None = None,
) -> TilesetCounts:
    """Writes a mesh, a scene or an HLOD of nested groups as 3D Tiles 1.1: the files that `occlod tiles` writes.

    `node_triangles`: as in build_hlod(), for what is no HLOD. `threads`: 0: one for each core. `meshopt`: EXT_meshopt_compression, where it is built.
    `quantise_bits`: of a coordinate within its tile, 8 to 16; 0: floats; None: 14 with meshopt, else 0. `skirts` cover gaps
    between levels. `up` overrules the axis of the input. `origin`: longitude and latitude in degrees and metres above the
    ellipsoid of coordinate 0. `images`: the folder that image names lead from; None: that of a path, else the current one.
    `texture_format`: of the images that tiles have of their own; None: as those of the input.
    `folder` is new or empty, or with `replace` a tileset of occlod; a name that ends in .3tz is that of an archive, one file.
    `progress` is called with the share done; what it raises, and Ctrl-C, leave what is there. Error for what cannot be read
    or written.
    """
    check_tileset_output(folder, replace)
    if not isinstance(what, (Mesh, Hlod)):
        path = pathlib.Path(what)
        images = path.parent if images is None else images
        what = _read(path)
    begin = 0.0
    if isinstance(what, Mesh):
        begin = 0.8
        what = build_hlod(
            what,
            node_triangles=node_triangles,
            grouping=Grouping.nested,
            borders=Borders.free,
            error_bound=ErrorBound.measured,
            threads=threads,
            progress=progress and (lambda done: progress(0.8 * done)),
        )
    counts = write_tileset(
        folder,
        what,
        meshopt=meshopt,
        quantise_bits=quantise_bits,
        skirts=skirts,
        up=up,
        origin=origin,
        images=images or "",
        texture_format=texture_format,
        threads=threads,
        replace=replace,
        progress=progress and (lambda done: progress(begin + (1.0 - begin) * done)),
    )
    if progress:
        progress(1.0)
    return counts
