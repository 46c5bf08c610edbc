"""Meshes of Open3D, of the older kind and of tensors. It is imported when it is used."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, overload

import numpy

from ._occlod import Mesh
from ._soup import (
    Array,
    Soup,
    colors_like,
    coordinates_of,
    from_bottom,
    is_of,
    looks_of,
    named,
    rgba_of,
    taken,
    type_name,
    vertices_of,
    warn_lost,
)

if TYPE_CHECKING:
    import open3d


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
        raise TypeError(
            f"from_open3d: {type_name(mesh)} is no mesh of Open3D; give an open3d.geometry.TriangleMesh or open3d.t.geometry.TriangleMesh"
        )
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
    coordinates and material only: these are by triangle. A warning names what is left out: alpha and looks of materials.
    """
    import open3d

    lost = looks_of(mesh)
    if mesh.colors is not None and (mesh.colors[:, 3] < 255).any():
        lost.append("alpha of colors")
    warn_lost("to_open3d", lost, stacklevel=2)
    wedges, triangles = vertices_of(mesh, mesh.normals, mesh.colors)
    uv, ids = from_bottom(mesh), mesh.triangle_materials
    corners = None if uv is None else uv[mesh.wedge_triangles]
    if not tensor:
        return _legacy(
            coordinates_of(mesh)[wedges],
            triangles,
            taken(mesh.normals, wedges),
            taken(mesh.colors, wedges),
            corners,
            ids,
        )
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


def _tensor(values: Array) -> Any:
    import open3d

    return open3d.core.Tensor(numpy.ascontiguousarray(values))


def _legacy(
    positions: Array,
    triangles: Array,
    normals: Array | None,
    colors: Array | None,
    corners: Array | None,
    ids: Array | None,
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
        coordinates_of(mesh)[wedges],
        triangles,
        taken(mesh.normals, wedges),
        taken(mesh.colors, wedges),
        corners,
        soup.materials_of(mesh),
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

    def put(to: Any, key: str, values: Array, of: Any) -> None:
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
