"""Continuous level of detail under a triangle budget, where occlusion decides.

    mesh = occlod.read_mesh("statue.ply")
    hierarchy = occlod.build_hierarchy(mesh)
    refined = occlod.Refiner(hierarchy).refine(occlod.Camera(eye=(0, 0, 3)), budget=10_000)
    refined.triangles()  # (m, 3) uint32, ids into hierarchy.positions

Bad files, meshes, options and set-ups raise occlod.Error; wrong shapes and types of arrays TypeError. What takes long
releases the GIL; building and reading obey Ctrl-C. All but refiners, backends and scenes may be shared by threads.
"""

from __future__ import annotations

import os
from collections.abc import Callable

from ._errors import Error
from ._occlod import (
    NO_ID,
    Access,
    Alpha,
    AutoRefiner,
    BackendCosts,
    Borders,
    Calibration,
    Camera,
    CameraPath,
    Coherence,
    Compression,
    Culling,
    Cut,
    Device,
    DrawObject,
    EffectReport,
    EffortForecast,
    ErrorBound,
    FrameStats,
    FrameTimes,
    Grouping,
    Hierarchy,
    Hlod,
    HlodFrame,
    HlodNode,
    HlodNodeMesh,
    HlodObject,
    ItemBuffer,
    LeftOut,
    Mesh,
    MeshFile,
    MeshReport,
    Metric,
    MorphedPositions,
    Object,
    OccluderMode,
    OccluderOptions,
    PictureDistance,
    Popping,
    PriorityOptions,
    Proxy,
    QueryOptions,
    RefineOptions,
    RefineStats,
    Refinement,
    Refiner,
    Scene,
    SceneObject,
    Strategy,
    TraverseOptions,
    Traverser,
    UpdateOptions,
    View,
    Visibility,
    Within,
    birdseye,
    build_hierarchy,
    build_hlod,
    compare_pictures,
    count_unexplained_pixels,
    device_presets,
    draw_items,
    generate_city,
    generate_pipes,
    generate_plant,
    generate_rough_planet,
    generate_spheres_behind_wall,
    measure_popping,
    read_hierarchy_and_report,
    read_hlod_and_report,
    read_mesh_and_report,
    shade,
    version,
    visibility_names,
    write_png,
)
from .interop import from_pyvista, from_trimesh, to_pyvista, to_trimesh
from .picture import draw_objects, full_picture, picture

__version__ = version()


def read_mesh(path: str | os.PathLike[str], progress: Callable[[float], object] | None = None) -> Mesh:
    """The mesh of a PLY, OBJ, OFF, STL or glTF file, cleaned. See read_mesh_and_report()."""
    return read_mesh_and_report(path, progress)[0]


def read_hierarchy(path: str | os.PathLike[str], *, access: Access = Access.mapped) -> Hierarchy:
    """The hierarchy of an .olod file. See read_hierarchy_and_report()."""
    return read_hierarchy_and_report(path, access=access)[0]


def read_hlod(path: str | os.PathLike[str], *, access: Access = Access.mapped) -> Hlod:
    """The HLOD of an .ohlod file. See read_hlod_and_report()."""
    return read_hlod_and_report(path, access=access)[0]


__all__ = [
    "NO_ID",
    "Access",
    "Alpha",
    "AutoRefiner",
    "BackendCosts",
    "Borders",
    "Calibration",
    "Camera",
    "CameraPath",
    "Coherence",
    "Compression",
    "Culling",
    "Cut",
    "Device",
    "DrawObject",
    "EffectReport",
    "EffortForecast",
    "Error",
    "ErrorBound",
    "FrameStats",
    "FrameTimes",
    "Grouping",
    "Hierarchy",
    "Hlod",
    "HlodFrame",
    "HlodNode",
    "HlodNodeMesh",
    "HlodObject",
    "ItemBuffer",
    "LeftOut",
    "Mesh",
    "MeshFile",
    "MeshReport",
    "Metric",
    "MorphedPositions",
    "Object",
    "OccluderMode",
    "OccluderOptions",
    "PictureDistance",
    "Popping",
    "PriorityOptions",
    "Proxy",
    "QueryOptions",
    "RefineOptions",
    "RefineStats",
    "Refinement",
    "Refiner",
    "Scene",
    "SceneObject",
    "Strategy",
    "TraverseOptions",
    "Traverser",
    "UpdateOptions",
    "View",
    "Visibility",
    "Within",
    "birdseye",
    "build_hierarchy",
    "build_hlod",
    "compare_pictures",
    "count_unexplained_pixels",
    "device_presets",
    "draw_items",
    "draw_objects",
    "from_pyvista",
    "from_trimesh",
    "full_picture",
    "generate_city",
    "generate_pipes",
    "generate_plant",
    "generate_rough_planet",
    "generate_spheres_behind_wall",
    "measure_popping",
    "picture",
    "read_hierarchy",
    "read_hierarchy_and_report",
    "read_hlod",
    "read_hlod_and_report",
    "read_mesh",
    "read_mesh_and_report",
    "shade",
    "to_pyvista",
    "to_trimesh",
    "version",
    "visibility_names",
    "write_png",
]
