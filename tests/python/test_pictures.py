"""Pictures, scenes, HLODs."""
import pathlib
import tempfile
import unittest

import numpy
import occlod
from support import VIEW, corners, planet


class Pictures(unittest.TestCase):
    def test_items_say_who_is_in_front(self):
        # Two squares that fill the image, the second nearer.
        square = numpy.array([[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]], numpy.float32)
        faces = numpy.array([[0, 1, 2], [0, 2, 3]], numpy.uint32)
        near = occlod.DrawObject(square, faces, transform=[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 1], [0, 0, 0, 1]])
        view = occlod.Camera(eye=(0, 0, 3), width=64, height=48)
        items = occlod.draw_items([occlod.DrawObject(square, faces), near], view)
        self.assertEqual(items.items.shape, (48, 64))
        self.assertEqual(set(items.items.ravel().tolist()), {2, 3})
        numpy.testing.assert_allclose(items.nearness, 0.5)  # 2 before the eye
        self.assertAlmostEqual(occlod.View(view).distance_at(0.5), 2)
        self.assertEqual(items.visible_triangles(), 2)

    def test_nothing_is_background(self):
        items = occlod.draw_items([], VIEW)
        self.assertTrue((items.items == occlod.NO_ID).all())
        self.assertEqual(items.visible_triangles(), 0)

    def test_arrays_are_used_in_place(self):
        mesh, _ = planet(3)
        draw = occlod.DrawObject(mesh.positions, mesh.triangles)
        before = occlod.draw_items([draw], VIEW).nearness.copy()
        mesh.positions[:] *= 0.5
        self.assertFalse(numpy.array_equal(occlod.draw_items([draw], VIEW).nearness, before))

    def test_cameras_look_at_what_is_given(self):
        _, hierarchy = planet(3)
        camera = occlod.Camera.looking_at(hierarchy, occlod.Camera(width=64, height=48))
        self.assertEqual((camera.width, camera.height), (64, 48))
        numpy.testing.assert_allclose(camera.target, numpy.mean(hierarchy.box, axis=0), atol=1e-6)
        self.assertEqual(occlod.Camera.looking_at(hierarchy.box, camera), camera)
        for wrong in (3, "planet", None, [0, 0, 0]):
            with self.assertRaisesRegex(TypeError, r"looking_at\(\)"):
                occlod.Camera.looking_at(wrong)

    def test_off_centre_pictures_are_parts_of_larger_ones(self):
        mesh, _ = planet(4)
        draw = occlod.DrawObject(mesh.positions, mesh.triangles)
        whole = occlod.Camera(eye=(0, 0, 3), fov_y_deg=90, width=128, height=96)
        # Of the upper right quarter: the line of sight meets its lower left corner. tan(26.565 degrees) is half of tan(45 degrees).
        part = occlod.Camera(eye=(0, 0, 3), fov_y_deg=2 * 26.56505117707799, width=64, height=48, principal_point=(-1, -1))
        self.assertEqual(part.principal_point, (-1, -1))
        quarter = occlod.draw_items([draw], whole).items[:48, 64:]
        self.assertLess((occlod.draw_items([draw], part).items != quarter).mean(), 0.005)
        part.principal_point = (0.5, 0)
        self.assertGreater((occlod.draw_items([draw], part).items != quarter).mean(), 0.1)

    def test_shaded_and_written(self):
        mesh, hierarchy = planet(4)
        image = occlod.picture(mesh, VIEW, wire=False)
        self.assertEqual((image.shape, image.dtype), ((768, 1024, 4), numpy.uint8))
        numpy.testing.assert_array_equal(image, occlod.full_picture(hierarchy, VIEW))
        self.assertFalse(numpy.array_equal(image, occlod.picture(hierarchy.cut(triangles=100), VIEW, wire=False)))
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.png")
            occlod.write_png(path, image)
            self.assertEqual(path.read_bytes()[:4], b"\x89PNG")

    def test_distance_of_pictures(self):
        _, hierarchy = planet(5)
        full = occlod.draw_objects(hierarchy)
        reference = occlod.draw_items(full, VIEW)
        reference_image = occlod.shade(reference, full, VIEW, wire=False)
        same = occlod.compare_pictures(VIEW, reference, reference_image, reference, reference_image)
        self.assertEqual((same.depth_rms_px, same.silhouette_mismatch, same.psnr_y), (0, 0, numpy.inf))
        distances = []
        for budget in (300, 3000):
            part = occlod.Refiner(hierarchy).refine(VIEW, budget).draw_objects()
            items = occlod.draw_items(part, VIEW)
            distances.append(occlod.compare_pictures(VIEW, items, occlod.shade(items, part, VIEW, wire=False), reference, reference_image))
        self.assertGreater(distances[0].depth_rms_px, distances[1].depth_rms_px)
        self.assertLess(distances[0].psnr_y, distances[1].psnr_y)
        self.assertEqual(occlod.count_unexplained_pixels(VIEW, reference, reference, 1.0), 0)
        self.assertGreater(occlod.measure_popping(VIEW, items, reference).largest_px, 0)

    def test_wrong_pairs_are_told(self):
        mesh, hierarchy = planet(3)
        small = occlod.Camera(width=64, height=48)
        objects = occlod.draw_objects(mesh)
        items = occlod.draw_items(objects, small)
        with self.assertRaisesRegex(occlod.Error, "64x48"):
            occlod.shade(items, objects, VIEW)
        with self.assertRaisesRegex(occlod.Error, "other objects"):
            occlod.shade(items, occlod.draw_objects(hierarchy.cut(triangles=64)), small)
        with self.assertRaises(TypeError):
            occlod.write_png("never.png", numpy.zeros((4, 4, 3), numpy.uint8))

    def test_birdseye(self):
        mesh, _ = planet(3)
        objects = occlod.draw_objects(mesh)
        self.assertEqual(occlod.birdseye(objects, occlod.draw_items(objects, VIEW), VIEW).shape[2], 4)


class Scenes(unittest.TestCase):
    def scene(self, folder):
        mesh, _ = planet(3)
        mesh.write(pathlib.Path(folder, "planet.ply"))
        away = numpy.eye(4)
        away[0, 3] = 2.0
        objects = [occlod.SceneObject(occlod.MeshFile(["planet.ply"])), occlod.SceneObject(occlod.MeshFile(["planet.ply"]), away, two_sided=True, attributes=False)]
        path = occlod.CameraPath([VIEW, occlod.Camera(eye=(3, 0, 3))], 3)
        return occlod.Scene(objects, {"default": VIEW}, {"aside": path}, about="two planets")

    def test_round_trip_and_load(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "two.json")
            self.scene(folder).write(path)
            again = occlod.Scene.read(path)
            self.assertEqual((again.name, again.about, len(again.objects)), ("two", "two planets", 2))
            self.assertEqual(again.cameras["default"], VIEW)
            self.assertEqual(again.paths["aside"][1].eye, (1.5, 0, 3))  # half way
            self.assertEqual(len(again.paths["aside"]), 3)
            with self.assertRaises(IndexError):
                again.paths["aside"][3]
            told = []
            objects = again.load(use_cache=False, progress=lambda what, done: told.append(done))
            self.assertTrue(told)
            self.assertEqual([o.two_sided for o in objects], [False, True])
            self.assertEqual([o.attributes for o in objects], [True, False])
            self.assertEqual(objects[1].transform[0, 3], 2.0)
            self.assertEqual(len(occlod.Refiner(objects).refine(VIEW)), 2)
            flat, report = again.flatten()
            self.assertEqual(flat.triangle_count, 2 * objects[0].hierarchy.input_triangle_count)

    def test_mistakes_are_told(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "bad.json")
            path.write_text('{"objects": [], "cameras": {}}')
            with self.assertRaisesRegex(occlod.Error, "bad.json"):
                occlod.Scene.read(path)
            scene = self.scene(folder)
            scene.objects = [occlod.SceneObject(occlod.MeshFile(["missing.ply"]))]
            with self.assertRaisesRegex(occlod.Error, "missing.ply"):
                scene.load(folder)


class Hlods(unittest.TestCase):
    def test_build_store_and_look(self):
        mesh, _ = planet(5)
        told = []
        hlod = occlod.build_hlod(mesh, node_triangles=500, progress=told.append)
        self.assertEqual((told, told[-1]), (sorted(told), 1.0))
        self.assertEqual(hlod.validate(random_fronts=4), [])
        self.assertTrue(hlod.restores(mesh))
        self.assertEqual(hlod.grouping, occlod.Grouping.shifted)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.ohlod")
            hlod.write(path, report=mesh.report())
            again, report = occlod.read_hlod_and_report(path)
            self.assertEqual(report.components, 1)
            again.require_all()
        first, count = again.levels[0]
        parts = [again.mesh(n) for n in range(first, first + count)]
        found = sorted(sum((corners(part.positions, part.triangles) for part in parts), []))
        self.assertEqual(found, corners(mesh.positions, mesh.triangles))
        for root in again.roots:
            node = again.node(root)
            self.assertEqual(node.triangles, len(again.mesh(root).triangles))
            self.assertEqual(node.level, again.level_count - 1)
            self.assertGreater(node.error, 0)
            self.assertGreaterEqual(node.sphere_error_px((0, 0, 3), 900), node.screen_error_px((0, 0, 3), 900))
            for child in again.children(root):
                self.assertIn(root, again.patches(child)[:, 0])
        with self.assertRaises(IndexError):
            again.node(again.node_count)
        with self.assertRaises(IndexError):
            again.mesh(-1)

    def test_bad_options_are_told(self):
        mesh, _ = planet(2)
        with self.assertRaisesRegex(occlod.Error, "locked"):
            occlod.build_hlod(mesh, borders=occlod.Borders.free)
        with self.assertRaisesRegex(ValueError, "journal"):
            occlod.build_hlod(mesh, journal="")

    def test_textures_count(self):
        """On a flat sheet only the texture can be off."""
        steps = numpy.linspace(0, 1, 65)
        x, y = (axis.ravel() for axis in numpy.meshgrid(steps, steps))
        places = numpy.stack([x, y, 0 * x], axis=1)
        corner = numpy.array([i + 65 * j for j in range(64) for i in range(64)])
        triangles = numpy.concatenate([numpy.stack([corner, corner + 1, corner + 66], axis=1), numpy.stack([corner, corner + 66, corner + 65], axis=1)])
        waves = numpy.stack([x + 0.05 * numpy.sin(20 * y), y + 0.05 * numpy.sin(20 * x)], axis=1)
        sheet, _ = occlod.Mesh(places, triangles, texture_coordinates=waves).clean()
        hlod = occlod.build_hlod(sheet, node_triangles=500)
        self.assertGreater(max(hlod.node(root).error for root in hlod.roots), 1e-3)

    def test_killed_builds_go_on(self):
        mesh, _ = planet(6)
        with tempfile.TemporaryDirectory() as folder:
            journal, written = pathlib.Path(folder, "planet.journal"), pathlib.Path(folder, "planet.ohlod")
            options = {"node_triangles": 16, "threads": 1}

            def bytes_of(**more):
                occlod.build_hlod(mesh, **options, **more).write(written)
                return written.read_bytes()

            def stop(done):
                if done > 0.8:
                    raise KeyboardInterrupt

            expected = bytes_of()
            with self.assertRaises(KeyboardInterrupt):
                bytes_of(journal=journal, progress=stop)
            kept = journal.read_bytes()
            # Whole, cut off in the middle of something, with wrong bytes in it, as text, and gone.
            for text in (kept, kept[: len(kept) * 3 // 4], kept[: len(kept) * 3 // 4] + bytes(1000), None):
                if text is None:
                    journal.unlink()
                else:
                    journal.write_bytes(text)
                self.assertEqual(bytes_of(journal=str(journal)), expected)
                self.assertTrue(journal.read_bytes().startswith(kept), "what was there is kept, and the rest is added")
            with self.assertRaisesRegex(occlod.Error, "planet.journal"):
                occlod.build_hlod(mesh, journal=journal, node_triangles=32)
            written.write_text("a file of something else")
            with self.assertRaisesRegex(occlod.Error, "planet.ohlod"):
                bytes_of(journal=written)
            self.assertEqual(written.read_text(), "a file of something else")


class Traversal(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.hlod = occlod.build_hlod(occlod.generate("rough-planet", level=6), node_triangles=500)
        cls.view = occlod.Camera(eye=(0, 0, 3), width=256, height=192)

    def test_frame_is_what_the_device_drew(self):
        device = occlod.Device.software(items=True)
        options = occlod.TraverseOptions(strategy=occlod.Strategy.vfc, tolerance_px=0.5)
        frame = occlod.Traverser(self.hlod).draw_frame(self.view, device, options)
        self.assertEqual(frame.stats.queries, 0)
        parts = []
        for _, node, first, count in frame.draws:
            mesh = self.hlod.mesh(node)
            corners_of_node = mesh.triangles.reshape(-1)
            for start, length in frame.ranges[first : first + count]:
                parts.append(mesh.positions[corners_of_node[start : start + length]])
        positions = numpy.concatenate(parts)
        self.assertEqual(len(positions), 3 * frame.stats.drawn_triangles)
        again = occlod.draw_items([occlod.DrawObject(positions, numpy.arange(len(positions)).reshape(-1, 3))], self.view)
        numpy.testing.assert_array_equal(again.items, device.picture().items)

    def test_strategies_show_the_same(self):
        depths = {}
        for strategy in (occlod.Strategy.vfc, occlod.Strategy.nohc):
            device = occlod.Device.software()
            frame = occlod.Traverser(self.hlod).draw_frame(self.view, device, occlod.TraverseOptions(strategy=strategy))
            depths[strategy] = device.picture().nearness.copy()
            self.assertLessEqual(frame.stats.largest_sse_px, 1.0)
        for depth in depths.values():  # without bias nothing visible is lost, and all draw the same nodes where it is
            numpy.testing.assert_array_equal(depth, depths[occlod.Strategy.vfc])

    def test_every_strategy_draws(self):
        for strategy in occlod.Strategy:
            device = occlod.Device.software()
            frame = occlod.Traverser(self.hlod).draw_frame(self.view, device, occlod.TraverseOptions(strategy=strategy))
            self.assertGreater(frame.stats.drawn_triangles, 0, strategy)
            self.assertGreater(device.picture().nearness.max(), 0, strategy)

    def test_objects_move_and_outlive(self):
        device = occlod.Device.software()
        with self.assertRaisesRegex(occlod.Error, "draw a frame first"):
            device.picture()
        traverser = occlod.Traverser(occlod.HlodObject(occlod.build_hlod(occlod.generate("rough-planet", level=3))))
        before = traverser.draw_frame(self.view, device).draws
        away = numpy.eye(4)
        away[0, 3] = 100
        traverser.set_transform(0, away)
        self.assertEqual(len(traverser.draw_frame(self.view, device).draws), 0)
        with self.assertRaises(occlod.Error):
            traverser.set_transform(1, away)
        del traverser
        self.assertEqual(device.picture().visible_triangles(), 0)
        self.assertGreater(len(before), 0)
        with self.assertRaisesRegex(occlod.Error, "tolerance"):
            occlod.Traverser(self.hlod).draw_frame(self.view, device, occlod.TraverseOptions(tolerance_px=-1))
        with self.assertRaises(occlod.Error):
            occlod.Traverser([])


if __name__ == "__main__":
    unittest.main()
