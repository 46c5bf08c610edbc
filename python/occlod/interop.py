"""Meshes of other packages. trimesh and PyVista are imported when they are used."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy
import numpy.typing

from ._occlod import Mesh, TextureOrigin

if TYPE_CHECKING:
    import pyvista
    import trimesh


def _from_bottom(mesh: Mesh) -> numpy.typing.NDArray[numpy.float32] | None:
    """Texture coordinates with v growing upwards, as trimesh and PyVista have them."""
    coordinates = mesh.texture_coordinates
    if coordinates is None or mesh.texture_origin == TextureOrigin.bottom_left:
        return coordinates
    return coordinates * numpy.float32((1, -1)) + numpy.float32((0, 1))


def _coordinates(mesh: Mesh) -> numpy.typing.NDArray[numpy.floating]:
    """Positions as they are, or coordinates in float64 where the mesh has an origin."""
    return mesh.positions + numpy.array(mesh.origin) if any(mesh.origin) else mesh.positions


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
    """A copy: trimesh computes in float64, and gets coordinates, which are origin + positions. A vertex for each wedge, in their order. Of colours and texture coordinates,
    which trimesh has not both, the latter; without materials."""
    import trimesh

    coordinates = _from_bottom(mesh)
    return trimesh.Trimesh(
        vertices=_coordinates(mesh),
        faces=mesh.wedge_triangles,
        vertex_normals=mesh.normals,
        vertex_colors=mesh.colors if coordinates is None else None,
        visual=None if coordinates is None else trimesh.visual.TextureVisuals(uv=coordinates),
        process=False,
    )


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
    """A point for each wedge, without a copy, which keeps the mesh alive, unless the mesh has an origin; normals and colours as point data "Normals" and
    "RGBA", and active texture coordinates."""
    import pyvista

    triangles = mesh.wedge_triangles
    faces = numpy.empty((len(triangles), 4), numpy.int64)
    faces[:, 0] = 3
    faces[:, 1:] = triangles
    surface = pyvista.PolyData(_coordinates(mesh), faces.ravel())
    if mesh.normals is not None:
        surface.point_data["Normals"] = mesh.normals
    if mesh.colors is not None:
        surface.point_data["RGBA"] = mesh.colors
    if mesh.texture_coordinates is not None:
        surface.active_texture_coordinates = _from_bottom(mesh)
    return surface
