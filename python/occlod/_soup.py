"""Meshes as other packages hold them, and what to say of what a Mesh has no place for."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Iterable
from typing import Any

import numpy
import numpy.typing

from ._errors import Error
from ._occlod import Material, Mesh, Texture, TextureOrigin, nearest_points

Array = numpy.typing.NDArray[Any]


@dataclasses.dataclass
class Soup:
    """A mesh as other packages hold it, with attributes by vertex, by corner or by face."""

    positions: Array  # (n, 3)
    triangles: Array  # (m, 3)
    normals: Array | None = None  # (n, 3)
    colors: Array | None = None  # (n, 4) uint8
    coordinates: Array | None = None  # (n, 2), v grows upwards
    corner_coordinates: Array | None = None  # (3 * m, 2)
    face_colors: Array | None = None  # (m, 4) uint8
    face_materials: Array | None = None  # (m,) ids of `materials`, or, without these, any integers
    materials: list[Material] = dataclasses.field(default_factory=list)
    textures: list[Texture] = dataclasses.field(default_factory=list)
    point_data: dict[str, Array] = dataclasses.field(default_factory=dict)  # what a Mesh has no place for, by vertex
    lost: list[str] = dataclasses.field(default_factory=list)  # what it has no place for otherwise, in words

    def by_vertex(self) -> Soup:
        """With a vertex for each corner where something belongs to corners or faces: clean() welds them."""
        if all(values is None for values in (self.corner_coordinates, self.face_colors, self.face_materials)):
            return self
        positions, corner = numpy.asarray(self.positions), numpy.asarray(self.triangles).reshape(-1)
        _require_ids(corner, len(positions))
        coordinates, colors = self.corner_coordinates, self.face_colors
        return dataclasses.replace(
            self,
            positions=positions[corner],
            triangles=numpy.arange(len(corner), dtype=numpy.uint32).reshape(-1, 3),
            normals=taken(self.normals, corner),
            colors=taken(self.colors, corner) if colors is None else numpy.repeat(colors, 3, axis=0),
            coordinates=taken(self.coordinates, corner) if coordinates is None else coordinates,
            corner_coordinates=None,
            face_colors=None,
        )

    def mesh(self) -> Mesh:
        """For clean() to weld."""
        soup, numbers, materials = self.by_vertex(), self.face_materials, self.materials
        if numbers is not None and not materials:
            known, numbers = numpy.unique(numbers, return_inverse=True)
            materials = [Material(str(number)) for number in known]
        return Mesh(
            soup.positions,
            soup.triangles,
            soup.normals,
            soup.colors,
            soup.coordinates,
            triangle_materials=numbers,
            materials=materials,
            textures=self.textures,
        )

    def materials_of(self, mesh: Mesh) -> Array | None:
        """`face_materials` of what mesh() without `materials` has become."""
        if self.face_materials is None:
            return None
        known = numpy.unique(self.face_materials)
        of_triangle = mesh.triangle_materials
        return known[numpy.zeros(mesh.triangle_count, int) if of_triangle is None else of_triangle]

    def point_data_at(self, places: Array) -> dict[str, Array]:
        """`point_data` of the used vertices nearest to the places."""
        if not self.point_data:
            return {}
        used = numpy.unique(self.triangles)
        nearest = used[nearest_points(places, numpy.asarray(self.positions)[used])]
        return {name: values[nearest] for name, values in self.point_data.items()}


def _require_ids(ids: Array, count: int) -> None:
    if len(ids) and (ids.min() < 0 or ids.max() >= count):
        bad = int(numpy.flatnonzero((ids < 0) | (ids >= count))[0])
        raise Error("mesh", f"triangle {bad // 3}", f"uses vertex {ids[bad]} of {count}", "vertices are counted from 0")


def taken(values: Array | None, ids: Array) -> Array | None:
    return None if values is None else numpy.asarray(values)[ids]


def vertices_of(mesh: Mesh, *attributes: Array | None) -> tuple[Array, Array]:
    """The mesh for packages that keep only these attributes by vertex: wedges that are to be its vertices, and triangles that
    index these. Wedges of one vertex that differ in none of the attributes are one."""
    if mesh.corners is None:
        return numpy.arange(mesh.wedge_count), mesh.triangles
    vertex = numpy.concatenate([numpy.arange(mesh.vertex_count), mesh.extra_wedges])
    key = [vertex[:, None]]
    for values in attributes:
        if values is not None:
            key.append(values if values.dtype.kind != "f" else numpy.ascontiguousarray(values).view(numpy.int32))
    _, wedges, numbers = numpy.unique(numpy.hstack(key), axis=0, return_index=True, return_inverse=True)
    return wedges, numbers.reshape(-1).astype(numpy.uint32)[mesh.corners]


def warn_lost(call: str, lost: Iterable[str], stacklevel: int) -> None:
    """One line about all that is not carried."""
    if lost := list(lost):
        warnings.warn(f"{call}: leaves out {', '.join(lost)}", stacklevel=stacklevel + 1)


def named(kind: str, names: Iterable[str]) -> list[str]:
    """What warn_lost() says of arrays: `kind "a", "b"`."""
    quoted = [f'"{name}"' for name in names]
    return [f"{kind} {', '.join(quoted)}"] if quoted else []


def is_of(thing: object, package: str, name: str) -> bool:
    """Whether it is an instance of that class, which need not be imported."""
    return any(c.__name__ == name and c.__module__.split(".")[0] == package for c in type(thing).__mro__)


def type_name(thing: object) -> str:
    """In words, with an article: "a list", "an open3d PointCloud"."""
    package = type(thing).__module__.split(".")[0]
    name = type(thing).__name__ if package in ("builtins", "occlod") else f"{package} {type(thing).__name__}"
    return f"{'an' if name[0].lower() in 'aeiou' else 'a'} {name}"


def rgba_of(colors: Any) -> Array | None:
    """(n, 4) uint8 of 3 or 4 channels, uint8 or floats from 0 to 1; None of anything else."""
    values = numpy.asarray(colors)
    if values.ndim != 2 or values.shape[1] not in (3, 4) or (values.dtype != numpy.uint8 and values.dtype.kind != "f"):
        return None
    if values.dtype != numpy.uint8:
        values = numpy.rint(numpy.clip(numpy.nan_to_num(values), 0, 1) * 255).astype(numpy.uint8)
    if values.shape[1] == 4:
        return values
    return numpy.hstack([values, numpy.full((len(values), 1), 255, numpy.uint8)])


def colors_like(colors: Array, like: Any) -> Array:
    """The inverse of rgba_of(), in the type and with the channels of what it got."""
    like = numpy.asarray(like)
    channels = colors[:, : like.shape[1]]
    return channels if like.dtype == numpy.uint8 else (channels / 255).astype(like.dtype)


def coordinates_of(mesh: Mesh) -> Array:
    """Positions as they are, or coordinates in float64 where the mesh has an origin."""
    return mesh.positions + numpy.array(mesh.origin) if any(mesh.origin) else mesh.positions


def from_bottom(mesh: Mesh) -> Array | None:
    """Texture coordinates with v growing upwards, as the other packages have them."""
    coordinates = mesh.texture_coordinates
    if coordinates is None or mesh.texture_origin == TextureOrigin.bottom_left:
        return coordinates
    return coordinates * numpy.float32((1, -1)) + numpy.float32((0, 1))


def looks_of(mesh: Mesh) -> list[str]:
    """What warn_lost() says of materials that are more than plain."""
    return (
        named("materials", (m.name for m in mesh.materials))
        if any(m != Material(m.name) for m in mesh.materials)
        else []
    )
