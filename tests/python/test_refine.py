"""Refinement: what the arrays of a result are, how long they live, and that nothing leaks."""
import ctypes
import gc
import pathlib
import subprocess
import sys
import threading
import unittest

import numpy
import occlod
from support import VIEW, planet


def orbit(frame, frames=60):
    angle = 2 * numpy.pi * frame / frames
    return occlod.Camera(eye=(3 * numpy.sin(angle), 0, 3 * numpy.cos(angle)))


class Results(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.mesh, cls.hierarchy = planet(6)  # 32,768 triangles

    def test_keep_to_the_budget(self):
        refiner = occlod.Refiner(self.hierarchy)
        for budget in (refiner.base_triangles, 1000, 10_000, refiner.full_triangles):
            refined = refiner.refine(VIEW, budget)
            self.assertLessEqual(len(refined.triangles()), budget)
            self.assertEqual(refined.stats.triangles, len(refined.triangles()))
            self.assertEqual(refined.stats.budget, budget)
        with self.assertRaisesRegex(occlod.Error, "budget"):
            refiner.refine(VIEW, refiner.base_triangles - 1)

    def test_are_read_only_views(self):
        refined = occlod.Refiner(self.hierarchy).refine(VIEW, 2000)
        for array in (refined.triangles(), refined.splits(), refined.changes(), refined.positions()):
            self.assertFalse(array.flags.writeable)
            self.assertFalse(array.flags.owndata)
        self.assertTrue(numpy.shares_memory(refined.triangles(), refined.triangles()))
        self.assertTrue(numpy.shares_memory(refined.positions(), self.hierarchy.positions))
        self.assertEqual(refined.splits().tolist(), sorted(refined.splits().tolist()))
        with self.assertRaises(IndexError):
            refined.triangles(1)

    def test_stay_as_they_are_when_more_is_asked(self):
        refiner = occlod.Refiner(self.hierarchy)
        first = refiner.update(orbit(0), 500)
        triangles, splits = first.triangles(), first.splits()
        address = triangles.ctypes.data
        before = triangles.copy(), splits.copy(), first.hash, first.stats.triangles
        for frame in range(1, 6):  # more than the memory of the first holds
            refiner.update(orbit(frame), 20_000)
        numpy.testing.assert_array_equal(triangles, before[0])
        numpy.testing.assert_array_equal(splits, before[1])
        self.assertEqual((first.hash, first.stats.triangles), before[2:])
        self.assertEqual(triangles.ctypes.data, address)  # not copied: it got the memory
        numpy.testing.assert_array_equal(first.triangles(), before[0])

    def test_outlive_the_refiner(self):
        triangles = occlod.Refiner(occlod.build_hierarchy(self.mesh)).refine(VIEW, 3000).triangles()
        before = triangles.copy()
        gc.collect()
        junk = [numpy.full_like(before, 9) for _ in range(10)]
        numpy.testing.assert_array_equal(triangles, before)
        del junk

    def test_holding_a_result_does_not_change_the_next(self):
        holding, dropping = occlod.Refiner(self.hierarchy), occlod.Refiner(self.hierarchy)
        held = []
        for frame in range(20):
            held.append(holding.update(orbit(frame), 4000))
            self.assertEqual(held[-1].hash, dropping.update(orbit(frame), 4000).hash)
            numpy.testing.assert_array_equal(holding.visibility_ages(), dropping.visibility_ages())
        self.assertEqual(len({result.hash for result in held}), 20)

    def test_changes_lead_from_one_frame_to_the_next(self):
        refiner = occlod.Refiner(self.hierarchy)
        before = refiner.update(orbit(0), 4000).triangles().copy()
        for frame in range(1, 10):
            refined = refiner.update(orbit(frame), 4000)
            now = refined.triangles()
            buffer = numpy.zeros_like(now)
            shared = min(len(before), len(now))
            buffer[:shared] = before[:shared]
            for first, count in refined.changes():
                buffer[first : first + count] = now[first : first + count]
            numpy.testing.assert_array_equal(buffer, now)
            self.assertLess(refined.changes()[:, 1].sum(), len(now))
            before = now.copy()

    def test_geomorphs_slide_home(self):
        refiner = occlod.Refiner(self.hierarchy)
        options = occlod.RefineOptions(budget=4000, geomorph_frames=4)
        morphed = occlod.MorphedPositions(self.hierarchy)
        positions = morphed.positions
        refiner.update(orbit(0), options=options)
        refined = refiner.update(orbit(1), options=options)
        vertices, parents, t = refined.geomorphs()
        self.assertGreater(len(vertices), 0)
        self.assertTrue(((t >= 0) & (t <= 1)).all())
        morphed.update(refined)
        self.assertTrue(set(vertices.tolist()) <= set(morphed.moved.tolist()))
        # A vertex whose parent does not slide is drawn on the line between both.
        alone = ~numpy.isin(parents, vertices)
        own, parent = self.hierarchy.positions[vertices[alone]], self.hierarchy.positions[parents[alone]]
        expected = parent + (own - parent) * t[alone, None]
        numpy.testing.assert_allclose(positions[vertices[alone]], expected, atol=1e-6)
        for _ in range(20):  # until the mesh has come to rest before the still camera
            refined = refiner.update(orbit(1), options=options)
            morphed.update(refined)
        self.assertEqual(len(refined.geomorphs()[0]), 0)
        numpy.testing.assert_array_equal(positions, self.hierarchy.positions)

    def test_mesh_is_the_refined_one(self):
        refined = occlod.Refiner(self.hierarchy).refine(VIEW, 700)
        mesh = refined.mesh()
        numpy.testing.assert_array_equal(mesh.positions[mesh.triangles], refined.positions()[refined.triangles()])
        self.assertEqual(len(numpy.unique(mesh.triangles)), mesh.vertex_count)


class Options(unittest.TestCase):
    def test_parts_are_changed_in_place(self):
        options = occlod.RefineOptions()
        self.assertEqual(options.budget, 10_000)
        options.method = occlod.Method.paper
        self.assertEqual(options.method, occlod.Method.paper)
        self.assertNotEqual(options, occlod.RefineOptions())
        self.assertEqual(occlod.RefineOptions(max_changes=3).max_changes, 3)

    def test_change_what_comes_out(self):
        _, hierarchy = planet(6)
        refiner = occlod.Refiner(hierarchy)
        default = refiner.refine(VIEW, 1000).hash
        self.assertNotEqual(refiner.refine(VIEW, 1000, options=occlod.RefineOptions(method=occlod.Method.paper)).hash, default)
        self.assertEqual(refiner.refine(VIEW, options=occlod.RefineOptions(budget=1000, threads=2)).hash, default)
        loose = refiner.refine(VIEW, options=occlod.RefineOptions(tolerance_px=50))
        self.assertLessEqual(loose.stats.max_error_px, 50)
        self.assertLess(len(loose.triangles()), 10_000)

    def test_bad_ones_are_told(self):
        _, hierarchy = planet(2)
        refiner = occlod.Refiner(hierarchy)
        with self.assertRaisesRegex(occlod.Error, "threads"):
            refiner.refine(VIEW, options=occlod.RefineOptions(threads=-1))
        with self.assertRaisesRegex(occlod.Error, "fov_y_deg"):
            refiner.refine(occlod.Camera(fov_y_deg=180))
        with self.assertRaises(TypeError):
            refiner.refine("from here")
        with self.assertRaises(TypeError):
            occlod.Refiner([1])


class Objects(unittest.TestCase):
    def test_move(self):
        _, hierarchy = planet(4)
        away = numpy.eye(4)
        away[0, 3] = 2.5
        two = [hierarchy, occlod.Object(hierarchy, away, two_sided=True)]
        refiner = occlod.Refiner(two)
        moved = occlod.Refiner([hierarchy, hierarchy])
        self.assertEqual(len(refiner.refine(VIEW)), 2)
        moved.refine(VIEW)
        self.assertEqual(two[1].transform[0, 3], 2.5)
        behind = numpy.eye(4)
        behind[2, 3] = -10
        refiner.set_transform(1, behind)
        moved.set_transform(1, behind)
        self.assertEqual(refiner.refine(VIEW, 3000).stats.triangles <= 3000, True)
        objects = refiner.refine(VIEW, 3000).draw_objects()
        self.assertEqual(len(objects), 2)
        with self.assertRaisesRegex(occlod.Error, "object 2"):
            refiner.set_transform(2, behind)
        with self.assertRaises(occlod.Error):
            refiner.set_transform(0, numpy.zeros((4, 4)))
        with self.assertRaisesRegex(TypeError, "transform"):
            refiner.set_transform(0, numpy.eye(3))

    def test_move_along_the_last_column(self):
        # Seen from +z, an object that is moved by +x appears in the right half.
        _, hierarchy = planet(3)
        right = numpy.eye(4)
        right[0, 3] = 1.5
        refined = occlod.Refiner(occlod.Object(hierarchy, right)).refine(VIEW)
        items = occlod.draw_items(refined.draw_objects(), VIEW).items
        columns = numpy.nonzero((items != occlod.NO_ID).any(axis=0))[0]
        self.assertGreater(columns.mean(), VIEW.width / 2)


class Backends(unittest.TestCase):
    def test_by_name(self):
        self.assertEqual(occlod.visibility_names()[:2], ["software", "none"])
        mesh = occlod.generate("spheres-behind-wall", spheres=16, level=3)
        hierarchy = occlod.build_hierarchy(mesh)
        view = occlod.Camera(eye=(3, 0, 0), up=(0, 0, 1))
        refiner = occlod.Refiner(hierarchy)
        seen = {name: refiner.refine(view, 1000, occlod.Visibility(name)) for name in ("software", "none")}
        self.assertGreater(seen["software"].stats.queries_hidden, 0)
        self.assertEqual(seen["none"].stats.queries, 0)
        self.assertEqual(refiner.refine(view, 1000).hash, seen["software"].hash)
        with self.assertRaisesRegex(occlod.Error, "no backend"):
            occlod.Visibility("guess")

    def test_show_pictures(self):
        _, hierarchy = planet(5)
        refiner, visibility = occlod.Refiner(hierarchy), occlod.Visibility()
        with self.assertRaisesRegex(occlod.Error, "before the first view"):
            visibility.show(numpy.zeros((VIEW.height, VIEW.width), numpy.float32))
        hidden = []
        for frame in range(4):
            refined = refiner.update(orbit(frame), 2000, visibility)
            self.assertEqual(refined.stats.occluder_draws == 0, frame == 3)
            hidden.append(refined.stats.queries_hidden)
            if frame == 2:
                visibility.show(occlod.draw_items(refined.draw_objects(), orbit(frame)).nearness)
        self.assertGreater(hidden[3], 0)
        with self.assertRaisesRegex(occlod.Error, "3 x 2 pixels"):
            visibility.show(numpy.zeros((2, 3), numpy.float32))
        with self.assertRaises(TypeError):
            visibility.show([1.0])
        with self.assertRaisesRegex(occlod.Error, "takes no pictures"):
            occlod.Visibility("none").show(numpy.zeros((2, 3), numpy.float32))

    def test_gl_where_built(self):
        _, hierarchy = planet(4)
        software = occlod.Refiner(hierarchy).refine(VIEW, 1000)
        if "gl-query" not in occlod.visibility_names():
            with self.assertRaisesRegex(occlod.Error, "without OpenGL"):
                occlod.Visibility("gl-query")
            return
        try:
            visibility = occlod.Visibility("gl-query")
        except occlod.Error as error:
            self.skipTest(f"SKIPPED: no OpenGL here: {error}")
        refined = occlod.Refiner(hierarchy).refine(VIEW, 1000, visibility)
        self.assertEqual(visibility.name, "gl-query")
        self.assertAlmostEqual(len(refined.triangles()), len(software.triangles()), delta=100)

    def test_auto(self):
        _, hierarchy = planet(5)
        calibration = occlod.Calibration.measure()
        self.assertGreater(calibration.visit_ns, 0)
        same = [occlod.AutoRefiner(hierarchy, calibration=calibration) for _ in range(2)]
        for frame in range(3):
            one, other = (refiner.update(orbit(frame), 2000) for refiner in same)
            self.assertEqual(one.hash, other.hash)
            self.assertLessEqual(one.stats.triangles, 2000)
        report = same[0].report()
        self.assertEqual([f.backend for f in report.forecasts if f.chosen], [report.backend])
        self.assertIsNone(report.forecasts[0].backend)
        calibration.triangle_ns = -1
        with self.assertRaisesRegex(occlod.Error, "triangle_ns"):
            occlod.AutoRefiner(hierarchy, calibration=calibration)


class Threads(unittest.TestCase):
    def test_may_share_a_refiner(self):
        _, hierarchy = planet(5)
        alone = {budget: occlod.Refiner(hierarchy).refine(VIEW, budget).hash for budget in (500, 2000)}
        refiner, visibility, wrong = occlod.Refiner(hierarchy), occlod.Visibility(), []

        def work(budget):
            for _ in range(30):
                refined = refiner.refine(VIEW, budget, visibility)
                if refined.hash != alone[budget] or len(refined.triangles()) > budget:
                    wrong.append(budget)

        threads = [threading.Thread(target=work, args=(budget,)) for budget in alone]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])


class Leaks(unittest.TestCase):
    def test_ten_thousand_updates_leave_nothing(self):
        class Mallinfo2(ctypes.Structure):
            _fields_ = [(name, ctypes.c_size_t) for name in "arena ordblks smblks hblks hblkhd usmblks fsmblks uordblks fordblks keepcost".split()]

        try:
            mallinfo2 = ctypes.CDLL(None).mallinfo2
        except AttributeError:
            self.skipTest("SKIPPED: this C library does not count what is allocated")
        mallinfo2.restype = Mallinfo2

        def allocated():  # by C++, and blocks of Python
            gc.collect()
            info = mallinfo2()
            return info.uordblks + info.hblkhd, sys.getallocatedblocks()

        _, hierarchy = planet(3)
        refiner, visibility = occlod.Refiner(hierarchy), occlod.Visibility()
        views = [occlod.View(orbit(frame)) for frame in range(50)]

        def run(calls):
            for call in range(calls):
                refined = refiner.update(views[call % 50], 200, visibility)
                refined.triangles(), refined.splits(), refined.changes(), refined.stats

        run(1000)  # until all buffers have their size
        before = allocated()
        run(10_000)
        after = allocated()
        # One lost array header a call would be a million bytes and 10,000 blocks.
        self.assertLess(after[0] - before[0], 20_000)
        self.assertLess(after[1] - before[1], 100)

    def test_nothing_is_left_at_the_end(self):
        # nanobind tells on stderr what is still alive when Python ends.
        code = ("import occlod; h = occlod.build_hierarchy(occlod.generate('rough-planet', level=3)); r = occlod.Refiner(h); "
                "x = r.update(occlod.Camera(), 100); t = x.triangles(); y = r.update(occlod.Camera(), 90)")
        ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=pathlib.Path(__file__).parent)
        self.assertEqual(ended.stderr, "")


if __name__ == "__main__":
    unittest.main()
