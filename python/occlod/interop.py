"""Meshes of other packages. trimesh and PyVista are imported when they are used."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy

from ._occlod import Mesh

if TYPE_CHECKING:
    import pyvista
    import trimesh


def from_trimesh(mesh: trimesh.Trimesh) -> Mesh:
    """A copy, with vertex colours where the mesh has such. Build from its clean(): trimesh keeps equal positions apart."""
    colors = mesh.visual.vertex_colors if mesh.visual.kind == "vertex" else None
    return Mesh(mesh.vertices, mesh.faces, colors=None if colors is None else numpy.asarray(colors, numpy.uint8))


def to_trimesh(mesh: Mesh) -> trimesh.Trimesh:
    """A copy: trimesh computes in float64. Vertices keep their order."""
    import trimesh

    return trimesh.Trimesh(
        vertices=mesh.positions,
        faces=mesh.triangles,
        vertex_normals=mesh.normals,
        vertex_colors=mesh.colors,
        process=False,
    )


def from_pyvista(mesh: pyvista.PolyData) -> Mesh:
    """A copy, triangulated. Point data "Normals" and "RGBA" (uint8) become normals and colours."""
    surface = mesh.triangulate()
    faces = numpy.asarray(surface.faces).reshape(-1, 4)[:, 1:]
    data = surface.point_data
    return Mesh(
        surface.points,
        faces,
        normals=data["Normals"] if "Normals" in data else None,
        colors=data["RGBA"] if "RGBA" in data else None,
    )


def to_pyvista(mesh: Mesh) -> pyvista.PolyData:
    """Points without a copy, which keep the mesh alive; normals and colours as point data "Normals" and "RGBA"."""
    import pyvista

    triangles = mesh.triangles
    faces = numpy.empty((len(triangles), 4), numpy.int64)
    faces[:, 0] = 3
    faces[:, 1:] = triangles
    surface = pyvista.PolyData(mesh.positions, faces.ravel())
    if mesh.normals is not None:
        surface.point_data["Normals"] = mesh.normals
    if mesh.colors is not None:
        surface.point_data["RGBA"] = mesh.colors
    return surface
