"""Datasets of PyVista, which is imported when it is used."""

from __future__ import annotations

import dataclasses
import warnings
from typing import TYPE_CHECKING

import numpy

from ._errors import Error
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
    type_name,
    warn_lost,
)

if TYPE_CHECKING:
    import pyvista


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
    others = [
        f"{kind} ({count})" for count, kind in ((whole.n_lines, "lines"), (whole.n_verts, "vertex cells")) if count
    ]
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


def _polydata(points: Array, triangles: Array) -> pyvista.PolyData:
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


def to_pyvista(mesh: Mesh) -> pyvista.PolyData:
    """A point for each wedge, without a copy, which keeps the mesh alive, unless the mesh has an origin; normals and colours
    as point data "Normals" and "RGBA", and active texture coordinates. A warning names materials, which it has not."""
    warn_lost("to_pyvista", looks_of(mesh), stacklevel=2)
    surface = _polydata(coordinates_of(mesh), mesh.wedge_triangles)
    if mesh.normals is not None:
        surface.point_data["Normals"] = mesh.normals
    if mesh.colors is not None:
        surface.point_data["RGBA"] = mesh.colors
    if mesh.texture_coordinates is not None:
        surface.active_texture_coordinates = from_bottom(mesh)
    return surface
