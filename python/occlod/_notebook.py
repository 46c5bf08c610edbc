"""How notebooks show images; and meshes, hierarchies and HLODs: a small picture, and counts."""

from __future__ import annotations

import base64
import pathlib
import tempfile
from collections.abc import Callable
from typing import Any

import numpy
import numpy.typing

from ._errors import Error
from ._occlod import Camera, Hierarchy, Hlod, Mesh, Refiner, Selector, write_png
from .picture import Drawable, picture

_WIDTH, _HEIGHT = 400, 300
_BUDGET = 100_000  # triangles


def _drawable(thing: Mesh | Hierarchy | Hlod, camera: Camera) -> Drawable:
    if isinstance(thing, Hierarchy):
        return Refiner(thing).refine(camera, _BUDGET)
    if isinstance(thing, Hlod):
        return Selector(thing).select(camera, budget=_BUDGET).mesh()
    return thing


def _bytes_of(image: numpy.typing.NDArray[numpy.uint8]) -> bytes:
    with tempfile.TemporaryDirectory(prefix="occlod-") as folder:
        path = pathlib.Path(folder, "shown.png")
        write_png(path, image)
        return path.read_bytes()


class _Shown:
    """A picture as the value of a cell."""

    def __init__(self, png: bytes) -> None:
        self._png = png

    def _repr_png_(self) -> bytes:
        return self._png


def show(image: numpy.typing.NDArray[numpy.uint8]) -> object:
    """What a notebook shows as a picture when it is the last value of a cell: an image of picture() or shade()."""
    return _Shown(_bytes_of(image))


def _png(thing: Mesh | Hierarchy | Hlod) -> bytes | None:
    """None of what cannot be drawn, as a mesh without vertices."""
    try:
        camera = Camera.looking_at(thing, width=_WIDTH, height=_HEIGHT)
        return _bytes_of(picture(_drawable(thing, camera), camera, wire=False))
    except Error:
        return None


def _counts_of_mesh(mesh: Mesh) -> dict[str, int]:
    counts = {"vertices": mesh.vertex_count, "triangles": mesh.triangle_count}
    if mesh.wedge_count > mesh.vertex_count:
        counts["wedges"] = mesh.wedge_count
    return counts


def _counts_of_hierarchy(h: Hierarchy) -> dict[str, int]:
    return {"vertices": h.vertex_count, "triangles": h.input_triangle_count, "splits": h.split_count, "bytes": h.bytes}


def _counts_of_hlod(h: Hlod) -> dict[str, int]:
    return {"triangles": h.input_triangle_count, "nodes": h.node_count, "levels": h.level_count, "bytes": h.bytes}


def _html(thing: Mesh | Hierarchy | Hlod, counts: dict[str, int]) -> str:
    png = _png(thing)
    data = "" if png is None else base64.b64encode(png).decode()
    image = data and f'<img src="data:image/png;base64,{data}" width="{_WIDTH}" height="{_HEIGHT}">'
    text = ", ".join(f"{count:,} {name}" for name, count in counts.items())
    return f"<div>{image}<div>occlod.{type(thing).__name__}: {text}</div></div>"


def _show(shown: type[Any], counts_of: Callable[[Any], dict[str, int]]) -> None:
    shown._repr_png_ = _png
    shown._repr_html_ = lambda self: _html(self, counts_of(self))


_show(Mesh, _counts_of_mesh)
_show(Hierarchy, _counts_of_hierarchy)
_show(Hlod, _counts_of_hlod)
