"""Hierarchies: built, stored, cut, and what their arrays mean."""
import gc
import os
import pathlib
import signal
import sys
import tempfile
import threading
import time
import unittest

import numpy
import occlod
from support import corners, planet


class Wedges(unittest.TestCase):
    def setUp(self):
        # A flat grid of two charts, whose texture coordinates are two apart at the seam x = 0.
        lines, size = [], 16
        for j in range(size + 1):
            for i in range(size + 1):
                lines += [f"v {i / 8 - 1} {j / 8 - 1} {0.2 * ((i * i + j) % 3)}", f"vt {i / 8} {j / 8}", f"vt {i / 8 + 2} {j / 8}"]
        for j in range(size):
            for i in range(size):
                a, b = j * (size + 1) + i, (j + 1) * (size + 1) + i
                side = 1 if i < size // 2 else 2
                lines.append("f " + " ".join(f"{v + 1}/{2 * v + side}" for v in (a, a + 1, b + 1, b)))
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        path = pathlib.Path(folder.name) / "grid.obj"
        path.write_text("\n".join(lines))
        self.mesh = occlod.read_mesh(path)
        self.hierarchy = occlod.build_hierarchy(self.mesh, base_triangles=8)

    def test_arrays_are_by_wedge(self):
        hierarchy = self.hierarchy
        self.assertEqual(hierarchy.vertex_count, 17 * 17)
        extra = hierarchy.extra_wedges
        self.assertEqual(hierarchy.wedge_count, 17 * 17 + len(extra))
        self.assertGreaterEqual(len(extra), 17)
        self.assertTrue((numpy.diff(extra.astype(int)) >= 0).all())
        self.assertEqual(hierarchy.texture_coordinates.shape, (hierarchy.wedge_count, 2))
        numpy.testing.assert_array_equal(hierarchy.positions[hierarchy.vertex_count:], hierarchy.positions[extra])
        self.assertEqual(len(hierarchy.attribute_errors), hierarchy.split_count)
        self.assertGreater(hierarchy.attribute_errors.max(), 0)
        self.assertIsNone(hierarchy.wedge_materials)
        self.assertTrue(hierarchy.restores(self.mesh))

    def test_triangles_of_wedges_have_one_chart(self):
        cut = self.hierarchy.cut(triangles=60)
        wedges = cut.wedge_triangles()
        self.assertEqual(len(wedges), cut.triangle_count)
        extra = self.hierarchy.extra_wedges
        vertex = numpy.concatenate([numpy.arange(self.hierarchy.vertex_count), extra])
        numpy.testing.assert_array_equal(vertex[wedges], cut.triangles())
        u = self.hierarchy.texture_coordinates[wedges][:, :, 0]
        self.assertTrue(((u <= 1.0).all(axis=1) | (u >= 3.0).all(axis=1)).all())

    def test_a_view_may_leave_attributes_out(self):
        view = occlod.View(occlod.Camera(eye=(0, 0, 3)))
        options = occlod.RefineOptions(budget=512, tolerance_px=2.0)
        counts = []
        for attributes in (True, False):
            item = occlod.Object(self.hierarchy, two_sided=True, attributes=attributes)
            self.assertEqual(item.attributes, attributes)
            counts.append(occlod.Refiner(item).refine(view, options=options).stats.triangles)
        self.assertGreaterEqual(counts[0], counts[1])

    def test_meshes_without_seams_have_none(self):
        _, hierarchy = planet(2)
        self.assertIsNone(hierarchy.texture_coordinates)
        self.assertIsNone(hierarchy.attribute_errors)
        self.assertEqual(len(hierarchy.extra_wedges), 0)


class Build(unittest.TestCase):
    def test_restores_the_input(self):
        mesh, hierarchy = planet(3)
        self.assertEqual(hierarchy.input_triangle_count, mesh.triangle_count)
        self.assertTrue(hierarchy.restores(mesh))
        self.assertEqual(hierarchy.validate(random_cuts=2), [])
        self.assertEqual(corners(hierarchy.positions, hierarchy.cut().triangles()), corners(mesh.positions, mesh.triangles))

    def test_options_count(self):
        mesh, hierarchy = planet(3)
        small = occlod.build_hierarchy(mesh, base_triangles=16, threads=1)
        self.assertLessEqual(small.base_triangle_count, 16)
        self.assertGreater(hierarchy.base_triangle_count, 16)
        tight = occlod.build_hierarchy(mesh, error_bound=occlod.ErrorBound.measured)
        self.assertLess(tight.error_bound, hierarchy.error_bound)
        with self.assertRaisesRegex(occlod.Error, "boundary_weight|boundary weight"):
            occlod.build_hierarchy(mesh, boundary_weight=-1)

    def test_progress_rises_and_may_end_it(self):
        told = []
        mesh = occlod.generate("rough-planet", level=8)
        occlod.build_hierarchy(mesh, progress=told.append)
        self.assertGreater(len(told), 1)
        self.assertEqual((told, told[-1]), (sorted(told), 1.0))

        def stop(done):
            raise KeyError("enough")

        with self.assertRaises(KeyError):
            occlod.build_hierarchy(mesh, progress=stop)

    def test_ctrl_c_ends_it(self):
        # Programs in the background of a script ignore Ctrl-C; this one is not to.
        self.addCleanup(signal.signal, signal.SIGINT, signal.signal(signal.SIGINT, signal.default_int_handler))
        mesh = occlod.generate("rough-planet", level=6)
        with self.assertRaises(KeyboardInterrupt):
            occlod.build_hierarchy(mesh, progress=lambda done: os.kill(os.getpid(), signal.SIGINT))

    def test_other_threads_run_meanwhile(self):
        # No thread is asked to give up the GIL, so another one runs only if the build has released it. The
        # machine may have no core left for it while one build lasts; then the next one may.
        interval = sys.getswitchinterval()
        sys.setswitchinterval(1000)
        self.addCleanup(sys.setswitchinterval, interval)
        mesh = occlod.generate("rough-planet", level=7)
        counted, is_over = [0], threading.Event()

        def count():
            while not is_over.is_set():
                counted[0] += 1
                time.sleep(1e-4)

        counter = threading.Thread(target=count)
        counter.start()
        meanwhile, end = 0, time.monotonic() + 60
        try:
            while meanwhile == 0 and time.monotonic() < end:
                before = counted[0]
                occlod.build_hierarchy(mesh)
                meanwhile = counted[0] - before
        finally:
            is_over.set()
            counter.join()
        self.assertGreater(meanwhile, 0)


class Stored(unittest.TestCase):
    def test_round_trip(self):
        mesh, hierarchy = planet(3)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.olod")
            for compression in (occlod.Compression.none, occlod.Compression.zstd):
                hierarchy.write(path, report=mesh.report(), compression=compression)
                again, report = occlod.read_hierarchy_and_report(path)
                numpy.testing.assert_array_equal(again.positions, hierarchy.positions)
                numpy.testing.assert_array_equal(again.errors, hierarchy.errors)
                self.assertEqual(report.components, 1)
            copied = occlod.read_hierarchy(path, access=occlod.Access.copied)
        copied.require_all()

    def test_views_keep_a_mapped_file(self):
        _, hierarchy = planet(4)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.olod")
            hierarchy.write(path)
            errors = occlod.read_hierarchy(path).errors
            gc.collect()
        numpy.testing.assert_array_equal(errors, hierarchy.errors)  # were it unmapped, this would crash

    def test_damage_is_told(self):
        _, hierarchy = planet(4)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.olod")
            hierarchy.write(path)
            data = bytearray(path.read_bytes())
            data[len(data) // 2] ^= 1
            path.write_bytes(data)
            with self.assertRaisesRegex(occlod.Error, "a.olod"):
                occlod.read_hierarchy(path).require_all()


class Meaning(unittest.TestCase):
    def test_arrays_are_read_only_views(self):
        _, hierarchy = planet(3)
        for array in (hierarchy.positions, hierarchy.errors, hierarchy.guaranteed_errors, hierarchy.spheres, hierarchy.base_triangles):
            self.assertFalse(array.flags.writeable)
            self.assertFalse(array.flags.owndata)
        self.assertEqual(hierarchy.spheres.shape, (hierarchy.split_count, 4))

    def test_errors_fall_along_dependencies(self):
        # The sphere of each split holds its vertex, and errors are saturated: the first ones are no smaller than the last.
        _, hierarchy = planet(3)
        born = hierarchy.positions[-hierarchy.split_count:]
        distance = numpy.linalg.norm(born - hierarchy.spheres[:, :3], axis=1)
        self.assertTrue((distance <= hierarchy.spheres[:, 3] * (1 + 1e-5)).all())
        self.assertGreaterEqual(hierarchy.errors[0], hierarchy.errors[-1])

    def test_collapses_lead_to_the_base(self):
        _, hierarchy = planet(3)
        history = hierarchy.collapses()
        base = hierarchy.vertex_count - hierarchy.split_count
        # Splits undo collapses, so the last vertex goes first, and each goes once.
        numpy.testing.assert_array_equal(history[:, 0], numpy.arange(hierarchy.vertex_count - 1, base - 1, -1))
        self.assertTrue((history[:, 1] < history[:, 0]).all())

    def test_replaying_collapses_gives_the_cut(self):
        _, hierarchy = planet(3)
        cut = hierarchy.cut(triangles=150)
        target = numpy.arange(hierarchy.vertex_count)
        for gone, kept in hierarchy.collapses()[: hierarchy.split_count - cut.splits]:
            target[target == gone] = kept
        moved = target[hierarchy.cut().triangles()]
        left = moved[(moved[:, 0] != moved[:, 1]) & (moved[:, 1] != moved[:, 2]) & (moved[:, 0] != moved[:, 2])]
        self.assertEqual(corners(hierarchy.positions, left), corners(hierarchy.positions, cut.triangles()))


class Cuts(unittest.TestCase):
    def test_keep_to_what_is_asked(self):
        _, hierarchy = planet(3)
        cut = hierarchy.cut(triangles=100)
        self.assertLessEqual(cut.triangle_count, 100)
        self.assertGreater(cut.triangle_count, 95)
        self.assertEqual(len(cut.triangles()), cut.triangle_count)
        self.assertEqual(int(cut.applied.sum()), cut.splits)
        close = hierarchy.cut(error=0.05)
        self.assertLessEqual(close.guaranteed_error, 0.05)
        self.assertTrue((hierarchy.guaranteed_errors[~close.applied] <= 0.05).all())
        for wrong in ({"triangles": 1, "error": 1.0}, {"error": -1.0}, {"error": float("nan")}):
            with self.assertRaises(ValueError):
                hierarchy.cut(**wrong)

    def test_vertex_map_says_who_stands_for_whom(self):
        mesh, hierarchy = planet(3)
        cut = hierarchy.cut(triangles=100)
        small, vertices, stands = cut.mesh(), cut.vertices(), cut.vertex_map()
        numpy.testing.assert_array_equal(small.positions, hierarchy.positions[vertices])
        # A vertex of the cut stands for itself; any other is stood for by what its collapses, replayed, lead to.
        numpy.testing.assert_array_equal(stands[vertices], numpy.arange(len(vertices)))
        target = numpy.arange(hierarchy.vertex_count)
        for gone, kept in hierarchy.collapses()[: hierarchy.split_count - cut.splits]:
            target[target == gone] = kept
        numpy.testing.assert_array_equal(vertices[stands], target)
        # By way of find(), for each vertex of the input.
        found = hierarchy.find(mesh.positions)
        numpy.testing.assert_array_equal(hierarchy.positions[found], mesh.positions)
        self.assertEqual(hierarchy.find([[9, 9, 9]])[0], occlod.NO_ID)


if __name__ == "__main__":
    unittest.main()
