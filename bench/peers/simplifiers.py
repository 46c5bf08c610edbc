#!/usr/bin/env python3
"""simplifiers.py TOOL MESH TRIANGLES OUTPUT.npz [--meshoptimizer LIBRARY]: reduces a mesh by one package on one thread, several times, and prints
as JSON the least processor and wall time, from arrays to arrays. bench/simplify_peers.py runs it, a process for each tool, so that each
imports only its own package and has its own memory.

Each tool gets the mesh welded by position. Those that can keep texture coordinates get a vertex for each wedge, as renderers have them."""
import argparse
import ctypes
import json
import os
import time

os.environ["OMP_NUM_THREADS"] = "1"

import numpy  # noqa: E402
import occlod  # noqa: E402

SECONDS = 1.5  # after which no further run begins
RUNS = 5


def compacted(positions, triangles, *others):
    used, triangles = numpy.unique(triangles, return_inverse=True)
    return [positions[used], triangles.reshape(-1, 3), *(other[used] for other in others)]


def by_occlod(mesh, triangles, refit=True):
    reduced = occlod.simplify(mesh, triangles=triangles, threads=1, refit=refit)
    return reduced.positions, reduced.wedge_triangles, reduced.texture_coordinates


def without_refit(mesh, triangles):
    return by_occlod(mesh, triangles, refit=False)


def by_fast_simplification(mesh, triangles):
    import fast_simplification

    return *fast_simplification.simplify(mesh.positions[: mesh.vertex_count], mesh.triangles, target_count=triangles), None


def by_pyfqmr(mesh, triangles):
    import pyfqmr

    simplifier = pyfqmr.Simplify()
    simplifier.setMesh(mesh.positions[: mesh.vertex_count], mesh.triangles)
    simplifier.simplify_mesh(target_count=triangles, verbose=False)
    return *simplifier.getMesh()[:2], None


def by_open3d(mesh, triangles):
    import open3d

    whole = open3d.geometry.TriangleMesh(
        open3d.utility.Vector3dVector(mesh.positions[: mesh.vertex_count].astype(numpy.float64)),
        open3d.utility.Vector3iVector(mesh.triangles.astype(numpy.int32)))
    reduced = whole.simplify_quadric_decimation(triangles)
    return numpy.asarray(reduced.vertices), numpy.asarray(reduced.triangles), None


def poly_data(positions, triangles):
    import pyvista

    return pyvista.PolyData(positions, numpy.column_stack((numpy.full(len(triangles), 3), triangles)).ravel())


def share_removed(mesh, triangles):
    return 1 - triangles / mesh.triangle_count


def by_pyvista(mesh, triangles):
    reduced = poly_data(mesh.positions[: mesh.vertex_count], mesh.triangles).decimate(share_removed(mesh, triangles))
    return reduced.points, reduced.faces.reshape(-1, 4)[:, 1:], None


def by_pyvista_with_texture(mesh, triangles):
    whole = poly_data(mesh.positions, mesh.wedge_triangles)
    whole.active_texture_coordinates = mesh.texture_coordinates
    reduced = whole.decimate(share_removed(mesh, triangles), tcoords=True)
    return reduced.points, reduced.faces.reshape(-1, 4)[:, 1:], numpy.asarray(reduced.active_texture_coordinates)


def by_pyvista_pro(mesh, triangles):
    whole = poly_data(mesh.positions, mesh.wedge_triangles)
    if mesh.texture_coordinates is not None:
        whole.active_texture_coordinates = mesh.texture_coordinates
    reduced = whole.decimate_pro(share_removed(mesh, triangles))
    texture = reduced.active_texture_coordinates
    return reduced.points, reduced.faces.reshape(-1, 4)[:, 1:], None if texture is None else numpy.asarray(texture)


class Meshoptimizer:
    """meshoptimizer's simplifiers, in a shared library of its own sources."""

    permissive = 1 << 5

    def __init__(self, file):
        self.library = ctypes.CDLL(file)
        for name in ("meshopt_simplify", "meshopt_simplifyWithAttributes", "meshopt_simplifyWithUpdate"):
            getattr(self.library, name).restype = ctypes.c_size_t

    @staticmethod
    def pointer(array):
        return None if array is None else array.ctypes.data_as(ctypes.c_void_p)

    @staticmethod
    def texture_scale(mesh):
        """Of the largest side of the box, which is the library's unit: one unit of the texture, by the roots of the areas."""
        def area(points):
            a, b, c = (points[mesh.wedge_triangles[:, i]].astype(numpy.float64) for i in range(3))
            cross = numpy.cross(b - a, c - a)
            return numpy.abs(cross).sum() if cross.ndim == 1 else numpy.linalg.norm(cross, axis=1).sum()

        flat = numpy.column_stack((mesh.texture_coordinates, numpy.zeros(mesh.wedge_count)))
        return numpy.sqrt(area(mesh.positions) / area(flat)) / numpy.ptp(mesh.positions, axis=0).max()

    def start(self, mesh):
        """What the functions begin with, and texture coordinates as attributes where there are some."""
        texture = mesh.texture_coordinates
        if texture is None:
            return mesh.positions[: mesh.vertex_count].copy(), mesh.triangles.astype(numpy.uint32).ravel(), None, None
        weights = numpy.full(2, self.texture_scale(mesh), numpy.float32)
        return mesh.positions.copy(), mesh.wedge_triangles.astype(numpy.uint32).ravel(), texture.copy(), weights

    def attributes(self, texture, weights):
        stride = ctypes.c_size_t(0 if texture is None else 8)
        return self.pointer(texture), stride, self.pointer(weights), ctypes.c_size_t(0 if texture is None else 2), None

    def in_place(self, mesh, triangles, options=0):
        positions, indices, texture, weights = self.start(mesh)
        left = numpy.empty_like(indices)
        size = ctypes.c_size_t
        count = self.library.meshopt_simplifyWithAttributes(
            self.pointer(left), self.pointer(indices), size(len(indices)), self.pointer(positions), size(len(positions)), size(12),
            *self.attributes(texture, weights), size(3 * triangles), ctypes.c_float(3.4e38), ctypes.c_uint(options), None)
        return positions, left[:count].reshape(-1, 3), texture

    def permissively(self, mesh, triangles):
        return self.in_place(mesh, triangles, self.permissive)

    def with_update(self, mesh, triangles, options=0):
        positions, indices, texture, weights = self.start(mesh)
        size = ctypes.c_size_t
        count = self.library.meshopt_simplifyWithUpdate(
            self.pointer(indices), size(len(indices)), self.pointer(positions), size(len(positions)), size(12),
            *self.attributes(texture, weights), size(3 * triangles), ctypes.c_float(3.4e38), ctypes.c_uint(options), None)
        return positions, indices[:count].reshape(-1, 3), texture

    def with_update_permissively(self, mesh, triangles):
        return self.with_update(mesh, triangles, self.permissive)


def function_of(tool, library):
    functions = {
        "occlod": by_occlod,
        "occlod, no refit": without_refit,
        "fast-simplification": by_fast_simplification,
        "pyfqmr": by_pyfqmr,
        "Open3D": by_open3d,
        "PyVista decimate": by_pyvista,
        "PyVista decimate, texture": by_pyvista_with_texture,
        "PyVista decimate_pro": by_pyvista_pro,
    }
    if library:
        meshoptimizer = Meshoptimizer(library)
        functions |= {
            "meshoptimizer": meshoptimizer.in_place,
            "meshoptimizer, permissive": meshoptimizer.permissively,
            "meshoptimizer, update": meshoptimizer.with_update,
            "meshoptimizer, update, permissive": meshoptimizer.with_update_permissively,
        }
    return functions[tool]


def main():
    parser = argparse.ArgumentParser(description="Reduces a mesh by one package")
    parser.add_argument("tool")
    parser.add_argument("mesh")
    parser.add_argument("triangles", type=int)
    parser.add_argument("output")
    parser.add_argument("--meshoptimizer", help="the shared library")
    options = parser.parse_args()
    mesh = occlod.read_mesh(options.mesh)
    function = function_of(options.tool, options.meshoptimizer)
    cpu, wall, begin = [], [], time.perf_counter()
    while not wall or (len(wall) < RUNS and time.perf_counter() - begin < SECONDS):
        before = time.perf_counter(), time.process_time()
        result = function(mesh, options.triangles)
        wall.append(time.perf_counter() - before[0])
        cpu.append(time.process_time() - before[1])
    positions, triangles, texture = result
    arrays = compacted(positions, triangles, *([] if texture is None else [texture]))
    numpy.savez(options.output, **dict(zip(("positions", "triangles", "texture"), arrays)))
    print(json.dumps({"cpu_ms": 1e3 * min(cpu), "wall_ms": 1e3 * min(wall)}))


if __name__ == "__main__":
    main()
