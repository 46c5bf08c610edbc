"""View cells: questions for all eyes of a cell, what hides, what is drawn."""
import gc
import itertools
import pathlib
import pickle
import tempfile
import threading
import unittest

import numpy
import occlod
from support import planet

CUBE = occlod.CellBox((-1, -1, -1), (1, 1, 1))
EYES = occlod.EyeModel(focal_length_px=100, cos_corner_angle=0.5, near=0.1)


def eyes_of(cell):
    """Corners and middle."""
    yield tuple((low + high) / 2 for low, high in zip(cell.min, cell.max))
    yield from itertools.product(*zip(cell.min, cell.max))


class Questions(unittest.TestCase):
    def test_scales(self):
        # f / (D cos^2 a) from the nearest point of the cell: D = 3; inside the cell f / (near cos a).
        view = occlod.CellView(CUBE, EYES)
        numpy.testing.assert_allclose(view.sphere_scales_px([[0, 0, -5, 1], [0, 0, 0, 1]]), [100 / (3 / 4), 2000], rtol=1e-5)
        boxes = numpy.array([[-1, -1, -5, 1, 1, -4]])
        numpy.testing.assert_allclose(view.box_scales_px(boxes), [100 / (3 / 4)], rtol=1e-5)
        # Its point that is farthest from any eye: (1, 1, -5) from (-1, -1, 1).
        numpy.testing.assert_allclose(view.smallest_scales_px(boxes), [400 / 44**0.5], rtol=1e-6)
        twice = occlod.CellView(CUBE, EYES, numpy.diag([2, 2, 2, 1]))
        numpy.testing.assert_allclose(twice.sphere_scales_px([[0, 0, -2.5, 0.5]]), [200 / (3 / 4)], rtol=1e-5)

    def test_facing(self):
        # The unit square in z = 0 faces +z: no eye below z = 0 sees its front, some of the cube does.
        positions = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]
        below = occlod.CellView(occlod.CellBox((-1, -1, -3), (1, 1, -0.01)), EYES)
        self.assertEqual(below.faces_away(positions, [[0, 1, 2], [0, 2, 1]]).tolist(), [True, False])
        self.assertEqual(occlod.CellView(CUBE, EYES).faces_away(positions, [[0, 1, 2], [0, 2, 1]]).tolist(), [False, False])
        self.assertEqual(below.cones_face_away([[0, 0, 1, 1], [0, 0, -1, 1]], [[0, 0, 0, 0.001]] * 2).tolist(), [True, False])
        with self.assertRaises(IndexError):
            below.faces_away(positions, [[0, 1, 3]])

    def test_box_in_the_world(self):
        box = occlod.CellView(CUBE, EYES, numpy.diag([1, 2, 1, 1])).world_box((0, 0, 0), (1, 1, 1), 0.5)
        numpy.testing.assert_allclose([box.min, box.max], [(-0.5, -1, -0.5), (1.5, 3, 1.5)], atol=1e-6)

    def test_eyes_of_a_view(self):
        camera = occlod.Camera(width=512, height=512, fov_y_deg=90, near=0.25)
        eyes = occlod.eye_model(camera)
        self.assertAlmostEqual(eyes.focal_length_px, 256)
        self.assertAlmostEqual(eyes.cos_corner_angle, 1 / 3**0.5)
        self.assertEqual(eyes.near, 0.25)
        with self.assertRaises(occlod.Error):
            occlod.eye_model(camera.orthographic())

    def test_bad_ones_are_told(self):
        with self.assertRaises(occlod.Error):
            occlod.CellView(occlod.CellBox((1, 0, 0), (0, 1, 1)), EYES)
        with self.assertRaises(occlod.Error):
            occlod.CellView(CUBE, occlod.EyeModel(near=0))
        view = occlod.CellView(CUBE, EYES)
        for wrong in ([[0, 0, 0]], [0, 0, 0, 1], [["a", 0, 0, 1]]):
            with self.assertRaisesRegex(TypeError, "spheres"):
                view.sphere_scales_px(wrong)
        with self.assertRaisesRegex(TypeError, "one for each cone"):
            view.cones_face_away([[0, 0, 1, 1]], [[0, 0, 0, 1]] * 2)


class Occluders(unittest.TestCase):
    def test_a_wall_hides_what_it_covers(self):
        # A wall of 10 x 10 at z = 0. The hull of the cell and of what lies behind it meets it inside; beside it, outside.
        wall = occlod.build_hierarchy(occlod.Mesh([[-5, -5, 0], [5, -5, 0], [5, 5, 0], [-5, 5, 0]], [[0, 1, 2], [0, 2, 3]]))
        occluders = occlod.CellOccluders(wall, 0)
        self.assertEqual(occluders.triangle_count, 2)
        cell = occlod.CellBox((-1, -1, 2), (1, 1, 3))
        self.assertTrue(occluders.hides(cell, occlod.CellBox((-1, -1, -3), (1, 1, -2))))
        self.assertFalse(occluders.hides(cell, occlod.CellBox((4, -1, -3), (12, 1, -2))))
        self.assertFalse(occluders.hides(cell, occlod.CellBox((-1, -1, -3), (1, 1, -2)), near_reach=2.5))
        with self.assertRaises(occlod.Error):
            occlod.CellOccluders(wall, -1)
        with self.assertRaises(TypeError):
            occlod.CellOccluders("wall", 0)


class Cuts(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.city = occlod.build_hierarchy(occlod.generate("city", blocks=3, facade_cells=4))
        cls.cell = occlod.CellBox((58, 58, 1), (62, 62, 2.5))
        cls.camera = occlod.Camera(width=128, height=128, fov_y_deg=90, near=0.1, far=1000)
        cls.options = occlod.CellOptions(eyes=occlod.eye_model(cls.camera))
        cls.occluders = occlod.CellOccluders(cls.city, 0.5)

    def test_arrays_are_views_that_outlive(self):
        builder = occlod.CellBuilder(self.city, self.occluders, self.options)
        cut = builder.build(self.cell)
        triangles, applied = cut.triangles(), cut.applied()
        for array in (triangles, applied, cut.positions()):
            self.assertFalse(array.flags.writeable)
            self.assertFalse(array.flags.owndata)
        self.assertTrue(numpy.shares_memory(cut.triangles(), triangles))
        self.assertTrue(numpy.shares_memory(cut.positions(), self.city.positions))
        before = triangles.copy(), applied.copy()
        self.assertEqual(len(triangles), cut.drawn_triangles)
        self.assertLess(cut.drawn_triangles, cut.active_triangles)
        self.assertTrue((numpy.diff(applied.astype(int)) > 0).all())
        self.assertLessEqual(cut.error_px, 1)
        self.assertGreater(cut.stats.queries_hidden, 0)
        builder.build(occlod.CellBox((90, 70, 30), (98, 78, 38)))
        del builder, cut
        gc.collect()
        numpy.testing.assert_array_equal(triangles, before[0])
        numpy.testing.assert_array_equal(applied, before[1])

    def test_shows_what_the_input_shows(self):
        cut = occlod.CellBuilder(self.city, self.occluders, self.options).build(self.cell)
        mesh = cut.mesh()
        numpy.testing.assert_array_equal(mesh.positions[mesh.triangles], cut.positions()[cut.triangles()])
        full = occlod.draw_objects(self.city)
        for eye in eyes_of(self.cell):
            for target in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)):
                self.camera.eye, self.camera.target, self.camera.up = eye, tuple(numpy.add(eye, target)), (0, 0, 1)
                # The tolerance is a pixel, and what a pixel shows may be half of one to each side.
                seen = occlod.draw_items(full, self.camera)
                drawn = occlod.draw_items(cut.draw_objects(), self.camera)
                self.assertEqual(occlod.count_unexplained_pixels(self.camera, seen, drawn, 2), 0)

    def test_without_occluders_nothing_is_hidden(self):
        cut = occlod.CellBuilder([self.city], options=self.options).build(self.cell)
        self.assertEqual(cut.stats.queries, 0)
        hidden = occlod.CellBuilder([self.city], self.occluders, self.options).build(self.cell)
        self.assertGreater(cut.drawn_triangles, hidden.drawn_triangles)
        self.assertEqual(occlod.picture(hidden, self.camera).shape, (128, 128, 4))

    def test_objects_at_places(self):
        ball = planet(3)[1]
        away = numpy.eye(4)
        away[0, 3] = 5
        objects = [ball, occlod.Object(ball, away)]
        cell = occlod.CellBox((2.4, 2.9, -0.1), (2.6, 3.1, 0.1))  # as far from both, mirrored
        cut = occlod.CellBuilder(objects, options=occlod.CellOptions(tolerance_px=2)).build(cell)
        self.assertEqual(len(cut), 2)
        self.assertGreater(len(cut.triangles(1)), 0)
        with self.assertRaises(IndexError):
            cut.triangles(2)
        drawn = occlod.draw_items(cut.draw_objects(), occlod.Camera(eye=(2.5, 3, 0), target=(5, 0, 0), width=64, height=48))
        self.assertGreater(drawn.nearness[24, 32], 0)  # at its place

    def test_bad_ones_are_told(self):
        with self.assertRaisesRegex(occlod.Error, "tolerance"):
            occlod.CellBuilder(self.city, options=occlod.CellOptions(tolerance_px=0))
        builder = occlod.CellBuilder(self.city, options=self.options)
        with self.assertRaises(occlod.Error):
            builder.build(occlod.CellBox((0, 0, 0), (numpy.nan, 1, 1)))
        with self.assertRaises(TypeError):
            builder.build((0, 0, 0))

    def test_threads_may_share_a_builder(self):
        builder = occlod.CellBuilder(planet(4)[1])
        cells = [occlod.CellBox((x, 0, 2), (x + 0.1, 0.1, 2.1)) for x in (0, 0.5)]
        alone = [builder.build(cell).triangles().tolist() for cell in cells]
        wrong = []

        def work(i):
            for _ in range(5):
                if builder.build(cells[i]).triangles().tolist() != alone[i]:
                    wrong.append(i)

        threads = [threading.Thread(target=work, args=(i,)) for i in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])


if __name__ == "__main__":
    unittest.main()


class Files(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.hierarchy = planet(5)[1]
        cls.options = occlod.CellTreeOptions([occlod.CellBox((-2, -2, 1.5), (2, 2, 2.5))], cell=occlod.CellOptions(eyes=EYES), root_cell=2, smallest_cell=0.5)
        cls.build = occlod.CellBuild(cls.hierarchy, cls.options)
        told = []
        cls.build.write(cls.folder / "a.vlod", threads=1, progress=told.append)
        cls.told = told

    def test_parts_give_the_same_bytes(self):
        self.assertEqual((self.build.root_cells, self.told[0], self.told[-1]), (4, 0, 1))
        build = occlod.CellBuild(self.hierarchy, pickle.loads(pickle.dumps(self.options)))
        parts = []
        for shard in (build.shard(i, 3) for i in range(3)):
            parts.append(self.folder / build.part_name(shard))
            self.assertFalse(build.has_part(parts[-1], shard))
            build.write_part(parts[-1], shard)
            self.assertTrue(build.has_part(parts[-1], shard))
        occlod.merge_cells(parts, self.folder / "b.vlod")
        self.assertEqual((self.folder / "a.vlod").read_bytes(), (self.folder / "b.vlod").read_bytes())
        self.assertEqual(build.cuts, self.build.cuts)
        with self.assertRaisesRegex(occlod.Error, "missing|root cells"):
            occlod.merge_cells(parts[1:], self.folder / "c.vlod")
        self.assertFalse((self.folder / "c.vlod").exists())

    def test_cells_are_those_of_the_builder(self):
        file = occlod.VlodFile(self.folder / "a.vlod", self.hierarchy)
        self.assertEqual((file.options.root_cell, file.options.cell.eyes.near, file.file_bytes), (2, 0.1, (self.folder / "a.vlod").stat().st_size))
        leaf = file.leaf_of((0.6, 0.7, 2))
        node = file.node(leaf)
        self.assertTrue(all(low <= x <= high for low, x, high in zip(node.box.min, (0.6, 0.7, 2), node.box.max)))
        occluders = occlod.CellOccluders(self.hierarchy, 0.5 / 4)
        expected = occlod.CellBuilder(self.hierarchy, occluders, self.options.cell).build(node.box)
        cut = file.cut(leaf)
        numpy.testing.assert_array_equal(cut.applied(), expected.applied())
        numpy.testing.assert_array_equal(cut.triangles(), expected.triangles())
        self.assertEqual((cut.drawn_triangles, node.drawn_triangles), (len(expected.triangles()),) * 2)
        self.assertEqual(len(file.neighbours(leaf)), 2)
        self.assertIsNone(file.leaf_of((9, 9, 9)))

    def test_options_are_sent(self):
        cell = occlod.CellOptions(eyes=EYES, tolerance_px=3, occlusion=occlod.CellOcclusion.sampled, sampled_eyes=2, budget=77)
        options = occlod.CellTreeOptions([CUBE], cell=cell, root_cell=9, smallest_cell=3, max_triangles=5, division=occlod.CellDivision.gain, occluder_motion=0.5)
        again = pickle.loads(pickle.dumps(options))
        self.assertEqual(again.regions, [CUBE])
        for name in ("root_cell", "smallest_cell", "max_triangles", "division", "occluder_motion"):
            self.assertEqual(getattr(again, name), getattr(options, name), name)
        for name in ("tolerance_px", "occlusion", "sampled_eyes", "budget"):
            self.assertEqual(getattr(again.cell, name), getattr(cell, name), name)
        for name in ("focal_length_px", "cos_corner_angle", "near", "clearance"):
            self.assertEqual(getattr(again.cell.eyes, name), getattr(EYES, name), name)

    def test_bad_calls_are_told(self):
        file = occlod.VlodFile(self.folder / "a.vlod")
        with self.assertRaises(ValueError):
            file.cut(file.leaf_of((0, 0, 2)))
        with self.assertRaises(IndexError):
            file.node(len(file))
        with self.assertRaises(IndexError):
            occlod.VlodFile(self.folder / "a.vlod", self.hierarchy).cut(0)  # the root
        with self.assertRaisesRegex(occlod.Error, "a.vlod"):
            occlod.VlodFile(self.folder / "a.vlod", planet(3)[1])
        with self.assertRaises(occlod.Error):
            occlod.CellBuild(self.hierarchy, occlod.CellTreeOptions([], root_cell=-1))

        def stop(done):
            raise KeyError("enough")

        with self.assertRaises(KeyError):
            self.build.write(self.folder / "d.vlod", progress=stop)
        self.assertFalse((self.folder / "d.vlod").exists())
