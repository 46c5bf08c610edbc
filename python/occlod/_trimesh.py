"""Meshes and scenes of trimesh, which is imported when it is used."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy

from ._errors import Error
from ._occlod import Material, Mesh
from ._soup import (
    Array,
    Soup,
    coordinates_of,
    from_bottom,
    is_of,
    named,
    rgba_of,
    taken,
    type_name,
    vertices_of,
    warn_lost,
)
from ._trimesh_materials import MaterialsFrom, material_to

if TYPE_CHECKING:
    import trimesh


def _fitting(data: Mapping[str, Any], count: int) -> tuple[dict[str, Array], list[str]]:
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
    result = trimesh.Trimesh(
        coordinates_of(mesh)[wedges], triangles, process=False, metadata=copy.deepcopy(like.metadata)
    )
    result.vertex_attributes.update(soup.point_data_at(result.vertices))
    if like.visual.kind == "texture":
        visual = trimesh.visual.TextureVisuals(
            uv=taken(mesh.texture_coordinates, wedges),
            material=like.visual.material.copy(),
            face_materials=soup.materials_of(mesh),
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
    soup.face_materials = (
        numpy.full(len(mesh.faces), first) if soup.face_materials is None else first + soup.face_materials
    )
    soup.lost += named("vertex attribute", soup.point_data)
    return soup


def _joined(parts: list[tuple[Array, Soup]]) -> Soup:
    """One of several at their places. What one of them lacks is white, or (0, 0)."""
    soups = [soup.by_vertex() for _, soup in parts]
    firsts = numpy.cumsum([0] + [len(soup.positions) for soup in soups])

    def filled(name: str, nothing: Array) -> Array | None:
        values = [getattr(soup, name) for soup in soups]
        if all(value is None for value in values):
            return None
        return numpy.vstack(
            [
                numpy.tile(nothing, (len(soup.positions), 1)) if value is None else value
                for soup, value in zip(soups, values)
            ]
        )

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
        raise TypeError(
            f"from_trimesh: {type_name(mesh)} is no mesh of trimesh; give a trimesh.Trimesh or trimesh.Scene"
        )
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

    coordinates, lost = from_bottom(mesh), []
    result = trimesh.Trimesh(coordinates_of(mesh), mesh.wedge_triangles, vertex_normals=mesh.normals, process=False)
    if coordinates is not None or any(material != Material(material.name) for material in mesh.materials):
        visual = trimesh.visual.TextureVisuals(
            uv=coordinates,
            material=material_to(mesh, lost) if mesh.materials else None,
            face_materials=mesh.triangle_materials,
        )
        if mesh.colors is not None:
            visual.vertex_attributes["color"] = mesh.colors
        result.visual = visual
    elif mesh.colors is not None:
        result.visual = trimesh.visual.ColorVisuals(result, vertex_colors=mesh.colors)
    warn_lost("to_trimesh", lost, stacklevel=2)
    return result
