"""Meshes of other packages. trimesh, PyVista and Open3D are imported when they are used."""

from __future__ import annotations

import copy
import dataclasses
import warnings
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy
import numpy.typing

from ._errors import Error
from ._occlod import Material, Mesh, Texture, TextureOrigin, nearest_points
from ._trimesh_materials import MaterialsFrom, material_to

if TYPE_CHECKING:
    import open3d
    import pyvista
    import trimesh

_Array = numpy.typing.NDArray[Any]


@dataclasses.dataclass
class Soup:
    """A mesh as other packages hold it, with attributes by vertex, by corner or by face."""

    positions: _Array  # (n, 3)
    triangles: _Array  # (m, 3)
    normals: _Array | None = None  # (n, 3)
    colors: _Array | None = None  # (n, 4) uint8
    coordinates: _Array | None = None  # (n, 2), v grows upwards
    corner_coordinates: _Array | None = None  # (3 * m, 2)
    face_colors: _Array | None = None  # (m, 4) uint8
    face_materials: _Array | None = None  # (m,) ids of `materials`, or, without these, any integers
    materials: list[Material] = dataclasses.field(default_factory=list)
    textures: list[Texture] = dataclasses.field(default_factory=list)
    point_data: dict[str, _Array] = dataclasses.field(default_factory=dict)  # what a Mesh has no place for, by vertex
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
            normals=_taken(self.normals, corner),
            colors=_taken(self.colors, corner) if colors is None else numpy.repeat(colors, 3, axis=0),
            coordinates=_taken(self.coordinates, corner) if coordinates is None else coordinates,
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

    def materials_of(self, mesh: Mesh) -> _Array | None:
        """`face_materials` of what mesh() without `materials` has become."""
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
    """Without materials. Normals are left to trimesh, which computes them."""
    soup = Soup(mesh.vertices, mesh.faces)
    soup.point_data, unfitting = _fitting(mesh.vertex_attributes, len(mesh.vertices))
    soup.lost += named("vertex attribute", unfitting) + named("face attribute", mesh.face_attributes)
    visual = mesh.visual
    if visual.kind == "vertex":
        soup.colors = rgba_of(visual.vertex_colors)
    elif visual.kind == "face":
        soup.face_colors = rgba_of(visual.face_colors)
    elif visual.kind == "texture":
        by_vertex, unfitting = _fitting(visual.vertex_attributes, len(mesh.vertices))
        uv, colors = by_vertex.pop("uv", None), by_vertex.pop("color", None)
        soup.coordinates = None if uv is None else uv[:, :2]
        soup.colors = None if colors is None else rgba_of(colors)
        soup.lost += named("attribute of the visual", [*by_vertex, *unfitting])
        materials = getattr(visual, "face_materials", None)
        if materials is not None and len(materials) == len(mesh.faces):
            soup.face_materials = numpy.asarray(materials)
    return soup


def trimesh_like(like: trimesh.Trimesh, soup: Soup, mesh: Mesh) -> trimesh.Trimesh:
    """What has become of a mesh of trimesh, with its material and metadata."""
    import trimesh

    colors = None if soup.colors is None else mesh.colors
    wedges, triangles = vertices_of(mesh, colors, mesh.texture_coordinates)
    result = trimesh.Trimesh(coordinates_of(mesh)[wedges], triangles, process=False, metadata=copy.deepcopy(like.metadata))
    result.vertex_attributes.update(soup.point_data_at(result.vertices))
    if like.visual.kind == "texture":
        visual = trimesh.visual.TextureVisuals(
            uv=_taken(mesh.texture_coordinates, wedges), material=like.visual.material.copy(), face_materials=soup.materials_of(mesh)
        )
        if colors is not None:
            visual.vertex_attributes["color"] = colors[wedges]
        result.visual = visual
    elif colors is not None:
        result.visual = trimesh.visual.ColorVisuals(result, vertex_colors=colors[wedges])
    elif soup.face_colors is not None:
        result.visual = trimesh.visual.ColorVisuals(result, face_colors=mesh.colors[mesh.wedge_triangles[:, 0]])
    return result


def _soup_with_materials(mesh: trimesh.Trimesh, look: MaterialsFrom) -> Soup:
    """With ids of the materials of `look`, to which its own are added."""
    soup, first = soup_of_trimesh(mesh), len(look.materials)
    look.add(mesh.visual.material if mesh.visual.kind == "texture" else None)
    soup.face_materials = numpy.full(len(mesh.faces), first) if soup.face_materials is None else first + soup.face_materials
    soup.lost += named("vertex attribute", soup.point_data)
    return soup


def _joined(parts: list[tuple[_Array, Soup]]) -> Soup:
    """One of several at their places. What one of them lacks is white, or (0, 0)."""
    soups = [soup.by_vertex() for _, soup in parts]
    firsts = numpy.cumsum([0] + [len(soup.positions) for soup in soups])

    def filled(name: str, nothing: _Array) -> _Array | None:
        values = [getattr(soup, name) for soup in soups]
        if all(value is None for value in values):
            return None
        return numpy.vstack([numpy.tile(nothing, (len(soup.positions), 1)) if value is None else value for soup, value in zip(soups, values)])

    positions, triangles = [], []
    for (place, _), soup, first in zip(parts, soups, firsts):
        faces = numpy.asarray(soup.triangles) + first
        positions.append(soup.positions @ place[:3, :3].T + place[:3, 3])
        triangles.append(faces if numpy.linalg.det(place[:3, :3]) >= 0 else faces[:, ::-1])
    return Soup(
        numpy.vstack(positions),
        numpy.vstack(triangles),
        colors=filled("colors", numpy.full(4, 255, numpy.uint8)),
        coordinates=filled("coordinates", numpy.zeros(2)),
        face_materials=numpy.concatenate([soup.face_materials for soup in soups]),
    )


def _soup_of_scene(scene: trimesh.Scene, look: MaterialsFrom) -> Soup:
    known: dict[str, Soup] = {}
    lost: list[str] = []
    for name, part in scene.geometry.items():
        if is_of(part, "trimesh", "Trimesh"):
            known[name] = _soup_with_materials(part, look)
            lost += [f'{text} of "{name}"' for text in known[name].lost]
        else:
            lost.append(f'{type(part).__name__} "{name}"')
    places = [scene.graph.get(node) for node in scene.graph.nodes_geometry]
    parts = [(numpy.asarray(place), known[name]) for place, name in places if name in known]
    if not parts:
        raise Error("scene", "", "has no meshes", "give one with meshes")
    soup = _joined(parts)
    soup.lost = lost
    return soup


def from_trimesh(mesh: trimesh.Trimesh | trimesh.Scene) -> Mesh:
    """A copy, with texture coordinates, colours of vertices or faces, materials and their images; of a scene all meshes, at
    their places. A warning names what is left out. Build from its clean(): trimesh keeps equal positions apart. TypeError for
    anything else."""
    look = MaterialsFrom()
    if is_of(mesh, "trimesh", "Trimesh"):
        soup = _soup_with_materials(mesh, look)
    elif is_of(mesh, "trimesh", "Scene"):
        soup = _soup_of_scene(mesh, look)
    else:
        raise TypeError(f"from_trimesh: {type_name(mesh)} is no mesh of trimesh; give a trimesh.Trimesh or trimesh.Scene")
    warn_lost("from_trimesh", soup.lost + look.lost, stacklevel=2)
    if look.has_any():
        soup.materials, soup.textures = look.materials, look.textures
    if len(look.materials) == 1 or not look.has_any():
        soup.face_materials = None
    return soup.mesh()


def to_trimesh(mesh: Mesh) -> trimesh.Trimesh:
    """A copy: trimesh computes in float64, and gets coordinates, which are origin + positions. A vertex for each wedge, in
    their order. With texture coordinates or materials its visual is a TextureVisuals, which has colours as its attribute
    "color"; a warning names images that are not in the mesh, as they are in GLB files."""
    import trimesh

    coordinates, lost = _from_bottom(mesh), []
    result = trimesh.Trimesh(coordinates_of(mesh), mesh.wedge_triangles, vertex_normals=mesh.normals, process=False)
    if coordinates is not None or any(material != Material(material.name) for material in mesh.materials):
        visual = trimesh.visual.TextureVisuals(
            uv=coordinates, material=material_to(mesh, lost) if mesh.materials else None, face_materials=mesh.triangle_materials
        )
        if mesh.colors is not None:
            visual.vertex_attributes["color"] = mesh.colors
        result.visual = visual
    elif mesh.colors is not None:
        result.visual = trimesh.visual.ColorVisuals(result, vertex_colors=mesh.colors)
    warn_lost("to_trimesh", lost, stacklevel=2)
    return result


@dataclasses.dataclass
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


def from_pyvista(mesh: pyvista.DataSet) -> Mesh:
    """A copy of the surface of any dataset, triangulated. Normals and texture coordinates of points that are active, or
    called "Normals", are kept, and one array of colours: "RGBA", "RGB", else the first of uint8 with 3 or 4 columns. A warning
    names what is left out. Error without a surface, TypeError for anything else."""
    if not hasattr(mesh, "extract_surface"):
        raise TypeError(f"from_pyvista: {type_name(mesh)} is no dataset of PyVista; give one with a surface")
    soup, _ = soup_of_pyvista(mesh)
    warn_lost("from_pyvista", named("point data", soup.point_data) + soup.lost, stacklevel=2)
    return soup.mesh()


def _materials_of(mesh: Mesh) -> list[str]:
    """What warn_lost() says of materials that are more than plain."""
    return named("materials", (m.name for m in mesh.materials)) if any(m != Material(m.name) for m in mesh.materials) else []


def to_pyvista(mesh: Mesh) -> pyvista.PolyData:
    """A point for each wedge, without a copy, which keeps the mesh alive, unless the mesh has an origin; normals and colours
    as point data "Normals" and "RGBA", and active texture coordinates. A warning names materials, which it has not."""
    warn_lost("to_pyvista", _materials_of(mesh), stacklevel=2)
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


def from_open3d(mesh: open3d.geometry.TriangleMesh | open3d.t.geometry.TriangleMesh) -> Mesh:
    """A copy of a mesh of either kind, with normals, colours (8 bits) and texture coordinates. Materials are only told apart. A
    warning names what is left out. TypeError for anything else."""
    if not is_of(mesh, "open3d", "TriangleMesh"):
        raise TypeError(f"from_open3d: {type_name(mesh)} is no mesh of Open3D; give an open3d.geometry.TriangleMesh or open3d.t.geometry.TriangleMesh")
    if hasattr(mesh, "vertex"):
        soup = soup_of_open3d_tensors(mesh.cpu())
        soup.lost += ["the material"] if mesh.has_valid_material() else []
    else:
        soup = soup_of_open3d(mesh)
        soup.lost += [f"textures ({len(mesh.textures)})"] if mesh.has_textures() else []
    warn_lost("from_open3d", named("vertex attribute", soup.point_data) + soup.lost, stacklevel=2)
    return soup.mesh()


@overload
def to_open3d(mesh: Mesh) -> open3d.geometry.TriangleMesh: ...
@overload
def to_open3d(mesh: Mesh, *, tensor: Literal[False]) -> open3d.geometry.TriangleMesh: ...
@overload
def to_open3d(mesh: Mesh, *, tensor: Literal[True]) -> open3d.t.geometry.TriangleMesh: ...
def to_open3d(mesh: Mesh, *, tensor: bool = False) -> Any:
    """A copy, of the newer kind on the CPU with `tensor`. A vertex for each wedge, without those that differ in texture
    coordinates and material only: these are by triangle. A warning names what is left out: alpha and looks of materials."""
    import open3d

    lost = _materials_of(mesh)
    if mesh.colors is not None and (mesh.colors[:, 3] < 255).any():
        lost.append("alpha of colors")
    warn_lost("to_open3d", lost, stacklevel=2)
    wedges, triangles = vertices_of(mesh, mesh.normals, mesh.colors)
    uv, ids = _from_bottom(mesh), mesh.triangle_materials
    corners = None if uv is None else uv[mesh.wedge_triangles]
    if not tensor:
        return _legacy(coordinates_of(mesh)[wedges], triangles, _taken(mesh.normals, wedges), _taken(mesh.colors, wedges), corners, ids)
    result = open3d.t.geometry.TriangleMesh()
    result.vertex["positions"] = _tensor(coordinates_of(mesh)[wedges])
    result.triangle["indices"] = _tensor(triangles.astype(numpy.int64))
    if mesh.normals is not None:
        result.vertex["normals"] = _tensor(mesh.normals[wedges])
    if mesh.colors is not None:
        result.vertex["colors"] = _tensor(mesh.colors[wedges, :3].astype(numpy.float32) / 255)
    if corners is not None:
        result.triangle["texture_uvs"] = _tensor(corners)
    if ids is not None:
        result.triangle["material_ids"] = _tensor(ids.astype(numpy.int32)[:, None])
    return result


def _tensor(values: _Array) -> Any:
    import open3d

    return open3d.core.Tensor(numpy.ascontiguousarray(values))


def _legacy(
    positions: _Array, triangles: _Array, normals: _Array | None, colors: _Array | None, corners: _Array | None, ids: _Array | None
) -> open3d.geometry.TriangleMesh:
    import open3d

    utility = open3d.utility
    result = open3d.geometry.TriangleMesh(
        utility.Vector3dVector(positions.astype(numpy.float64)), utility.Vector3iVector(triangles.astype(numpy.int32))
    )
    if normals is not None:
        result.vertex_normals = utility.Vector3dVector(normals.astype(numpy.float64))
    if colors is not None:
        result.vertex_colors = utility.Vector3dVector(colors[:, :3] / 255)
    if corners is not None:
        result.triangle_uvs = utility.Vector2dVector(corners.reshape(-1, 2).astype(numpy.float64))
    if ids is not None:
        result.triangle_material_ids = utility.IntVector(ids.astype(numpy.int32))
    return result


def open3d_like(like: open3d.geometry.TriangleMesh, soup: Soup, mesh: Mesh) -> open3d.geometry.TriangleMesh:
    """What has become of a mesh of Open3D, with its textures; normals of triangles are computed anew."""
    wedges, triangles = vertices_of(mesh, mesh.normals, mesh.colors)
    corners = None if soup.corner_coordinates is None else mesh.texture_coordinates[mesh.wedge_triangles]
    result = _legacy(
        coordinates_of(mesh)[wedges], triangles, _taken(mesh.normals, wedges), _taken(mesh.colors, wedges), corners, soup.materials_of(mesh)
    )
    result.textures = like.textures
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
        to[key] = _tensor(values.astype(of[key].numpy().dtype).reshape(-1, *of[key].shape[1:]))

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
