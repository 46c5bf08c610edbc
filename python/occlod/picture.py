"""Pictures in one call."""

from __future__ import annotations

from collections.abc import Iterable

import numpy

from ._occlod import (
    Camera,
    CellCut,
    Cut,
    DrawObject,
    Hierarchy,
    Mesh,
    Object,
    Refinement,
    View,
    WalkedFrame,
    draw_items,
    shade,
)

Drawable = Mesh | Refinement | CellCut | WalkedFrame | Cut | Hierarchy | Object


def _moved_by(origin: tuple[float, float, float]) -> numpy.typing.NDArray[numpy.float64] | None:
    """The transform that moves positions to their coordinates."""
    if not any(origin):
        return None
    transform = numpy.eye(4)
    transform[:3, 3] = origin
    return transform


def draw_objects(what: Drawable | Iterable[Drawable]) -> list[DrawObject]:
    """What draw_items() and shade() take, of meshes, refinements, cuts of any kind, frames of a walk, hierarchies and objects
    at their finest."""
    if isinstance(what, (Refinement, CellCut, WalkedFrame)):
        return what.draw_objects()
    if isinstance(what, Mesh):
        return [DrawObject(what.positions, what.wedge_triangles, what.colors, _moved_by(what.origin))]
    if isinstance(what, Cut):
        return draw_objects(what.mesh())
    if isinstance(what, Hierarchy):
        return [DrawObject(what.positions, what.cut().wedge_triangles(), what.colors, _moved_by(what.origin))]
    if isinstance(what, Object):
        h = what.hierarchy
        return [DrawObject(h.positions, h.cut().wedge_triangles(), h.colors, what.transform)]
    return [part for one in what for part in draw_objects(one)]


def picture(
    what: Drawable | Iterable[Drawable], view: View | Camera, *, wire: bool = True
) -> numpy.typing.NDArray[numpy.uint8]:
    """(height, width, 4) uint8, sRGB and alpha: everything as the camera sees it."""
    objects = draw_objects(what)
    return shade(draw_items(objects, view), objects, view, wire=wire)


def full_picture(
    objects: Object | Hierarchy | Iterable[Object | Hierarchy], view: View | Camera, *, wire: bool = False
) -> numpy.typing.NDArray[numpy.uint8]:
    """The same of the input meshes of these objects: what a refinement is compared with."""
    if isinstance(objects, (Object, Hierarchy)):
        objects = [objects]
    return picture(list(objects), view, wire=wire)
