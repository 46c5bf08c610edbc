"""Meshes of other packages. trimesh, PyVista and Open3D are imported when they are used."""

from __future__ import annotations

import copy
import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy
import numpy.typing

from ._errors import Error
from ._occlod import Material, Mesh, TextureOrigin, nearest_points

if TYPE_CHECKING:
    import open3d
    import pyvista
    import trimesh

_Array = numpy.typing.NDArray[Any]


@dataclass
class Soup:
    """A mesh as other packages hold it, with attributes by vertex, by corner or by face."""

    positions: _Array  # (n, 3)
    triangles: _Array  # (m, 3)
    normals: _Array | None = None  # (n, 3)
    colors: _Array | None = None  # (n, 4) uint8
    coordinates: _Array | None = None  # (n, 2), v grows upwards
    corner_coordinates: _Array | None = None  # (3 * m, 2)
    face_colors: _Array | None = None  # (m, 4) uint8
    face_materials: _Array | None = None  # (m,) any integers
    point_data: dict[str, _Array] = field(default_factory=dict)  # what a Mesh has no place for, by vertex
    lost: list[str] = field(default_factory=list)  # what it has no place for otherwise, in words

    def mesh(self) -> Mesh:
        """With a vertex for each corner where something belongs to corners or faces: clean() welds them."""
        positions, triangles = numpy.asarray(self.positions), numpy.asarray(self.triangles)
        normals, colors, coordinates = self.normals, self.colors, self.coordinates
        if any(values is not None for values in (self.corner_coordinates, self.face_colors, self.face_materials)):
            corner = triangles.reshape(-1)
            _require_ids(corner, len(positions))
            positions, triangles = positions[corner], numpy.arange(len(corner), dtype=numpy.uint32).reshape(-1, 3)
            normals, colors, coordinates = (_taken(values, corner) for values in (normals, colors, coordinates))
            coordinates = coordinates if self.corner_coordinates is None else self.corner_coordinates
            colors = colors if self.face_colors is None else numpy.repeat(self.face_colors, 3, axis=0)
        numbers, materials = None, []
        if self.face_materials is not None:
            known, numbers = numpy.unique(self.face_materials, return_inverse=True)
            materials = [Material(str(number)) for number in known]
        return Mesh(positions, triangles, normals, colors, coordinates, triangle_materials=numbers, materials=materials)

    def materials_of(self, mesh: Mesh) -> _Array | None:
        """`face_materials` of what mesh() has become."""
        if self.face_materials is None:
            return None
        known = numpy.unique(self.face_materials)
        of_triangle = mesh.triangle_materials
        return known[numpy.zeros(mesh.triangle_count, int) if of_triangle is None else of_triangle]

    def point_data_at(self, places: _Array) -> dict[str, _Array]:
        """`point_data` of the used vertices nearest to the places."""
        if not self.point_data:
            return {}
        used = numpy.unique(self.triangles)
        nearest = used[nearest_points(places, numpy.asarray(self.positions)[used])]
        return {name: values[nearest] for name, values in self.point_data.items()}


def _require_ids(ids: _Array, count: int) -> None:
    if len(ids) and (ids.min() < 0 or ids.max() >= count):
        bad = int(numpy.flatnonzero((ids < 0) | (ids >= count))[0])
        raise Error("mesh", f"triangle {bad // 3}", f"uses vertex {ids[bad]} of {count}", "vertices are counted from 0")


def _taken(values: _Array | None, ids: _Array) -> _Array | None:
    return None if values is None else numpy.asarray(values)[ids]


def vertices_of(mesh: Mesh, *attributes: _Array | None) -> tuple[_Array, _Array]:
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


def rgba_of(colors: Any) -> _Array | None:
    """(n, 4) uint8 of 3 or 4 channels, uint8 or floats from 0 to 1; None of anything else."""
    values = numpy.asarray(colors)
    if values.ndim != 2 or values.shape[1] not in (3, 4) or (values.dtype != numpy.uint8 and values.dtype.kind != "f"):
        return None
    if values.dtype != numpy.uint8:
        values = numpy.rint(numpy.clip(numpy.nan_to_num(values), 0, 1) * 255).astype(numpy.uint8)
    if values.shape[1] == 4:
        return values
    return numpy.hstack([values, numpy.full((len(values), 1), 255, numpy.uint8)])


def colors_like(colors: _Array, like: Any) -> _Array:
    """The inverse of rgba_of(), in the type and with the channels of what it got."""
    like = numpy.asarray(like)
    channels = colors[:, : like.shape[1]]
    return channels if like.dtype == numpy.uint8 else (channels / 255).astype(like.dtype)


def coordinates_of(mesh: Mesh) -> _Array:
    """Positions as they are, or coordinates in float64 where the mesh has an origin."""
    return mesh.positions + numpy.array(mesh.origin) if any(mesh.origin) else mesh.positions


def _from_bottom(mesh: Mesh) -> _Array | None:
    """Texture coordinates with v growing upwards, as the other packages have them."""
    coordinates = mesh.texture_coordinates
    if coordinates is None or mesh.texture_origin == TextureOrigin.bottom_left:
        return coordinates
    return coordinates * numpy.float32((1, -1)) + numpy.float32((0, 1))


def _fitting(data: Mapping[str, Any], count: int) -> tuple[dict[str, _Array], list[str]]:
    """Arrays with one entry for each of so many, and the names of the others."""
    arrays = {str(name): numpy.asarray(values) for name, values in data.items()}
    fitting = {name: values for name, values in arrays.items() if values.ndim > 0 and len(values) == count}
    return fitting, [name for name in arrays if name not in fitting]


def soup_of_trimesh(mesh: trimesh.Trimesh) -> Soup:
    """Normals are left to trimesh, which computes them."""
    soup = Soup(mesh.vertices, mesh.faces)
    visual = mesh.visual
    if visual.kind == "vertex":
        soup.colors = rgba_of(visual.vertex_colors)
    elif visual.kind == "face":
        soup.face_colors = rgba_of(visual.face_colors)
    elif visual.kind == "texture":
        uv = None if visual.uv is None else numpy.asarray(visual.uv)
        if uv is not None and uv.shape[1] >= 2:
            soup.coordinates = uv[:, :2]
        materials = getattr(visual, "face_materials", None)
        if materials is not None and len(materials) == len(mesh.faces):
            soup.face_materials = numpy.asarray(materials)
    soup.point_data, unfitting = _fitting(mesh.vertex_attributes, len(mesh.vertices))
    soup.lost += named("vertex attribute", unfitting) + named("face attribute", mesh.face_attributes)
    return soup


def trimesh_like(like: trimesh.Trimesh, soup: Soup, mesh: Mesh) -> trimesh.Trimesh:
    """What has become of a mesh of trimesh, with its material and metadata."""
    import trimesh

    wedges, triangles = vertices_of(mesh, None if soup.colors is None else mesh.colors, mesh.texture_coordinates)
    result = trimesh.Trimesh(coordinates_of(mesh)[wedges], triangles, process=False, metadata=copy.deepcopy(like.metadata))
    result.vertex_attributes.update(soup.point_data_at(result.vertices))
    if soup.colors is not None:
        result.visual = trimesh.visual.ColorVisuals(result, vertex_colors=mesh.colors[wedges])
    elif soup.face_colors is not None:
        result.visual = trimesh.visual.ColorVisuals(result, face_colors=mesh.colors[mesh.wedge_triangles[:, 0]])
    elif like.visual.kind == "texture":
        result.visual = trimesh.visual.TextureVisuals(
            uv=_taken(mesh.texture_coordinates, wedges), material=like.visual.material.copy(), face_materials=soup.materials_of(mesh)
        )
    return result


def from_trimesh(mesh: trimesh.Trimesh) -> Mesh:
    """A copy, with vertex colours or texture coordinates where the mesh has such. Build from its clean(): trimesh keeps
    equal positions apart."""
    kind = mesh.visual.kind
    colors = mesh.visual.vertex_colors if kind == "vertex" else None
    return Mesh(
        mesh.vertices,
        mesh.faces,
        colors=None if colors is None else numpy.asarray(colors, numpy.uint8),
        texture_coordinates=mesh.visual.uv if kind == "texture" else None,
    )


def to_trimesh(mesh: Mesh) -> trimesh.Trimesh:
    """A copy: trimesh computes in float64, and gets coordinates, which are origin + positions. A vertex for each wedge, in
    their order. Of colours and texture coordinates, which trimesh has not both, the latter; without materials."""
    import trimesh

    coordinates = _from_bottom(mesh)
    return trimesh.Trimesh(
        vertices=coordinates_of(mesh),
        faces=mesh.wedge_triangles,
        vertex_normals=mesh.normals,
        vertex_colors=mesh.colors if coordinates is None else None,
        visual=None if coordinates is None else trimesh.visual.TextureVisuals(uv=coordinates),
        process=False,
    )


@dataclass
class _Names:
    """The arrays of a surface of PyVista that a Mesh has a place for; None where there is none."""

    normals: str | None
    colors: str | None
    coordinates: str | None


def _names_of(data: pyvista.DataSetAttributes) -> _Names:
    normals = data.active_normals_name or ("Normals" if "Normals" in data else None)
    colored = [name for name in data if data[name].dtype == numpy.uint8 and rgba_of(data[name]) is not None]
    preferred = [name for name in ("RGBA", "RGB") if name in colored] + colored
    return _Names(normals, preferred[0] if preferred else None, data.active_texture_coordinates_name)


def _surface_of(dataset: pyvista.DataSet) -> pyvista.PolyData:
    if is_of(dataset, "pyvista", "MultiBlock"):
        raise TypeError("a MultiBlock is several datasets; give one of them, or its combine()")
    if not is_of(dataset, "pyvista", "PolyData"):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # newer versions ask by which algorithm
            return dataset.extract_surface(pass_pointid=False, pass_cellid=False)
    return dataset


def soup_of_pyvista(dataset: pyvista.DataSet) -> tuple[Soup, pyvista.PolyData]:
    """Also the triangulated surface that it is of. Error when there is none."""
    whole = _surface_of(dataset)
    surface = whole.triangulate()
    faces = numpy.asarray(surface.faces).reshape(-1, 4)[:, 1:]
    others = [f"{kind} ({count})" for count, kind in ((whole.n_lines, "lines"), (whole.n_verts, "vertex cells")) if count]
    if len(faces) == 0:
        has = " and ".join(others) or f"points ({dataset.n_points})"
        raise Error(type(dataset).__name__, "", f"has {has} and no faces", "give a dataset with a surface")
    names, data = _names_of(surface.point_data), surface.point_data
    soup = Soup(numpy.asarray(surface.points), faces)
    if names.normals is not None:
        soup.normals = numpy.asarray(data[names.normals])
    if names.colors is not None:
        soup.colors = rgba_of(data[names.colors])
    if names.coordinates is not None:
        soup.coordinates = numpy.asarray(data[names.coordinates])[:, :2]
    taken = (names.normals, names.colors, names.coordinates)
    soup.point_data = {name: numpy.asarray(data[name]) for name in data if name not in taken}
    soup.lost += others + named("cell data", surface.cell_data)
    return soup, surface


def _polydata(points: _Array, triangles: _Array) -> pyvista.PolyData:
    import pyvista

    faces = numpy.empty((len(triangles), 4), numpy.int64)
    faces[:, 0] = 3
    faces[:, 1:] = triangles
    return pyvista.PolyData(points, faces.ravel())


def pyvista_like(like: pyvista.PolyData, soup: Soup, mesh: Mesh) -> pyvista.PolyData:
    """What has become of a surface of PyVista, with arrays of the same names."""
    names, data = _names_of(like.point_data), like.point_data
    result = _polydata(coordinates_of(mesh).astype(like.points.dtype, copy=False), mesh.wedge_triangles)
    for name, values in soup.point_data_at(result.points).items():
        result.point_data[name] = values
    if names.colors is not None:
        result.point_data[names.colors] = colors_like(mesh.colors, data[names.colors])
    if names.normals is not None:
        result.point_data[names.normals] = mesh.normals
        result.point_data.active_normals_name = names.normals
    if names.coordinates is not None:
        result.point_data[names.coordinates] = mesh.texture_coordinates
        result.point_data.active_texture_coordinates_name = names.coordinates
    result.point_data.active_scalars_name = data.active_scalars_name
    result.field_data.update(like.field_data)
    return result


def from_pyvista(mesh: pyvista.PolyData) -> Mesh:
    """A copy, triangulated. Point data "Normals" and "RGBA" (uint8) become normals and colours, active texture coordinates
    texture coordinates."""
    surface = mesh.triangulate()
    faces = numpy.asarray(surface.faces).reshape(-1, 4)[:, 1:]
    data = surface.point_data
    return Mesh(
        surface.points,
        faces,
        normals=data["Normals"] if "Normals" in data else None,
        colors=data["RGBA"] if "RGBA" in data else None,
        texture_coordinates=surface.active_texture_coordinates,
    )


def to_pyvista(mesh: Mesh) -> pyvista.PolyData:
    """A point for each wedge, without a copy, which keeps the mesh alive, unless the mesh has an origin; normals and colours
    as point data "Normals" and "RGBA", and active texture coordinates."""
    surface = _polydata(coordinates_of(mesh), mesh.wedge_triangles)
    if mesh.normals is not None:
        surface.point_data["Normals"] = mesh.normals
    if mesh.colors is not None:
        surface.point_data["RGBA"] = mesh.colors
    if mesh.texture_coordinates is not None:
        surface.active_texture_coordinates = _from_bottom(mesh)
    return surface


def soup_of_open3d(mesh: open3d.geometry.TriangleMesh) -> Soup:
    """Of the older kind of mesh."""
    soup = Soup(numpy.asarray(mesh.vertices), numpy.asarray(mesh.triangles))
    if mesh.has_vertex_normals():
        soup.normals = numpy.asarray(mesh.vertex_normals)
    if mesh.has_vertex_colors():
        soup.colors = rgba_of(mesh.vertex_colors)
    if mesh.has_triangle_uvs():
        soup.corner_coordinates = numpy.asarray(mesh.triangle_uvs)
    if mesh.has_triangle_material_ids():
        soup.face_materials = numpy.asarray(mesh.triangle_material_ids)
    return soup


def open3d_like(like: open3d.geometry.TriangleMesh, soup: Soup, mesh: Mesh) -> open3d.geometry.TriangleMesh:
    """What has become of a mesh of Open3D, with its textures; normals of triangles are computed anew."""
    import open3d

    vector, wide = open3d.utility.Vector3dVector, numpy.float64
    wedges, triangles = vertices_of(mesh, mesh.normals, mesh.colors)
    result = open3d.geometry.TriangleMesh(vector(coordinates_of(mesh)[wedges].astype(wide)),
                                          open3d.utility.Vector3iVector(triangles.astype(numpy.int32)))
    if mesh.normals is not None:
        result.vertex_normals = vector(mesh.normals[wedges].astype(wide))
    if mesh.colors is not None:
        result.vertex_colors = vector(colors_like(mesh.colors[wedges], like.vertex_colors))
    if soup.corner_coordinates is not None:
        corners = mesh.texture_coordinates[mesh.wedge_triangles].reshape(-1, 2)
        result.triangle_uvs = open3d.utility.Vector2dVector(corners.astype(wide))
        result.textures = like.textures
    if soup.face_materials is not None:
        result.triangle_material_ids = open3d.utility.IntVector(soup.materials_of(mesh).astype(numpy.int32))
    if like.has_triangle_normals():
        result.compute_triangle_normals()
    if like.has_adjacency_list():
        result.compute_adjacency_list()
    return result


_VERTEX_KEYS = ("positions", "normals", "colors")
_TRIANGLE_KEYS = ("indices", "normals", "colors", "texture_uvs", "material_ids")


def soup_of_open3d_tensors(mesh: open3d.t.geometry.TriangleMesh) -> Soup:
    """Of the newer kind of mesh, on the CPU."""
    vertex = {name: values.numpy() for name, values in mesh.vertex.items()}
    triangle = {name: values.numpy() for name, values in mesh.triangle.items()}
    soup = Soup(vertex["positions"], triangle.get("indices", numpy.empty((0, 3), numpy.int32)), vertex.get("normals"))
    soup.point_data = {name: values for name, values in vertex.items() if name not in _VERTEX_KEYS}
    left = [name for name in triangle if name not in _TRIANGLE_KEYS]
    if "colors" in vertex and (colors := rgba_of(vertex["colors"])) is not None:
        soup.colors = colors
    elif "colors" in vertex:
        soup.point_data["colors"] = vertex["colors"]
    if "colors" in triangle:
        soup.face_colors = None if "colors" in vertex else rgba_of(triangle["colors"])
        left += ["colors"] if soup.face_colors is None else []
    if "texture_uvs" in triangle:
        soup.corner_coordinates = triangle["texture_uvs"].reshape(-1, 2)
    if "material_ids" in triangle:
        soup.face_materials = triangle["material_ids"].reshape(-1)
    soup.lost += named("triangle attribute", left)
    return soup


def open3d_tensors_like(like: open3d.t.geometry.TriangleMesh, soup: Soup, mesh: Mesh) -> open3d.t.geometry.TriangleMesh:
    """What has become of a mesh of Open3D, with its material, on its device; normals of triangles are computed anew."""
    import open3d

    def put(to: Any, key: str, values: _Array, of: Any) -> None:
        to[key] = open3d.core.Tensor(numpy.ascontiguousarray(values, of[key].numpy().dtype).reshape(-1, *of[key].shape[1:]))

    source, by_vertex = like.cpu(), None if soup.colors is None else mesh.colors
    result = open3d.t.geometry.TriangleMesh()
    wedges, triangles = vertices_of(mesh, mesh.normals, by_vertex)
    places = coordinates_of(mesh)[wedges]
    put(result.vertex, "positions", places, source.vertex)
    put(result.triangle, "indices", triangles, source.triangle)
    if mesh.normals is not None:
        put(result.vertex, "normals", mesh.normals[wedges], source.vertex)
    if by_vertex is not None:
        put(result.vertex, "colors", colors_like(by_vertex[wedges], source.vertex["colors"].numpy()), source.vertex)
    for name, values in soup.point_data_at(places).items():
        put(result.vertex, name, values, source.vertex)
    if soup.face_colors is not None:
        of_triangle = mesh.colors[mesh.wedge_triangles[:, 0]]
        put(result.triangle, "colors", colors_like(of_triangle, source.triangle["colors"].numpy()), source.triangle)
    if soup.corner_coordinates is not None:
        put(result.triangle, "texture_uvs", mesh.texture_coordinates[mesh.wedge_triangles], source.triangle)
    if soup.face_materials is not None:
        put(result.triangle, "material_ids", soup.materials_of(mesh), source.triangle)
    if "normals" in source.triangle:
        result.compute_triangle_normals()
    if like.has_valid_material():
        result.material = like.material
    return result.to(like.device)
