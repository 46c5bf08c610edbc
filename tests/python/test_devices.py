"""Devices that draw HLODs: OpenGL where it is built; refinement within nodes; scenes as HLODs."""
import pathlib
import tempfile
import unittest

import numpy
import occlod


def walk(traverser, device, options, frames=3):
    result = []
    for frame in range(frames):
        camera = occlod.Camera(eye=(0.2 * frame, 0, 3), width=256, height=192)
        result.append(traverser.draw_frame(camera, device, options))
    return result


class OpenGL(unittest.TestCase):
    def test_draws_what_software_draws(self):
        try:
            device = occlod.Device.gl()
        except occlod.Error as error:
            if "gl-query" not in occlod.visibility_names():
                self.assertIn("without OpenGL", str(error))
            self.skipTest(f"SKIPPED: {error}")
        hlod = occlod.build_hlod(occlod.generate("rough-planet", level=4), node_triangles=300)
        options = occlod.TraverseOptions(strategy=occlod.Strategy.vfc)
        software = occlod.Device.software()
        frames = [walk(occlod.Traverser(hlod), d, options, 1)[0] for d in (device, software)]
        self.assertEqual(frames[0].front_hash, frames[1].front_hash)
        depths = [d.picture().nearness for d in (device, software)]
        self.assertLess(((depths[0] > 0) != (depths[1] > 0)).mean(), 0.01)
        both = (depths[0] > 0) & (depths[1] > 0)
        self.assertLess(numpy.median(abs(depths[0][both] - depths[1][both])), 1e-4)


class Within(unittest.TestCase):
    def test_nodes_are_refined_within(self):
        mesh = occlod.generate("rough-planet", level=6)
        hlod = occlod.build_hlod(mesh, node_triangles=500, within=occlod.Within.splits)
        view = occlod.Camera(eye=(0, 0, 3), width=256, height=192)
        drawn = {}
        for within in (False, True):
            options = occlod.TraverseOptions(strategy=occlod.Strategy.vfc, tolerance_px=0.7, within=within)
            device = occlod.Device.software()
            frame = drawn[within] = occlod.Traverser(hlod).draw_frame(view, device, options)
            triangles = 0
            for draw, (_, node, first, count) in enumerate(frame.draws):
                cut = frame.cut(draw)
                self.assertEqual(len(cut) > 0, count == 0)
                if count == 0:
                    self.assertLess(cut.max(), len(hlod.within_positions(node)))
                triangles += len(cut) + frame.ranges[first : first + count, 1].sum() // 3
            self.assertEqual(triangles, frame.stats.drawn_triangles)
        self.assertEqual(drawn[False].stats.cut_nodes, 0)
        self.assertGreater(drawn[True].stats.cut_nodes, 0)
        self.assertLess(drawn[True].stats.drawn_triangles, drawn[False].stats.drawn_triangles)
        cuts = [frame.copy() for frame in (drawn[True].cut(i) for i in range(len(drawn[True].draws)))]
        del device
        occlod.Traverser(hlod).draw_frame(view, occlod.Device.software(), options)
        for i, cut in enumerate(cuts):  # its own, not the traverser's
            numpy.testing.assert_array_equal(drawn[True].cut(i), cut)
        with self.assertRaises(IndexError):
            drawn[True].cut(len(cuts))

    def test_cuts_lie_between_a_node_and_what_it_was_made_from(self):
        hlod = occlod.build_hlod(occlod.generate("rough-planet", level=5), node_triangles=300, within=occlod.Within.splits)
        (root,) = hlod.roots
        self.assertTrue(hlod.has_within(root))
        coarse, fine = hlod.node(root).error, hlod.node(root).child_error
        counts = [len(hlod.within_cut(root, error)) for error in (2 * coarse, (coarse + fine) / 2, 0)]
        self.assertEqual(counts, sorted(counts))
        self.assertLess(counts[0], counts[1])
        self.assertLess(counts[1], counts[2])
        numpy.testing.assert_array_equal(hlod.within_positions(root)[: hlod.node(root).vertices], hlod.mesh(root).positions)
        with self.assertRaises(ValueError):
            hlod.within_cut(root, -1)
        plain = occlod.build_hlod(occlod.generate("rough-planet", level=3))
        with self.assertRaisesRegex(occlod.Error, "splits"):
            plain.within_cut(0, 0)


class ScenesAsHlods(unittest.TestCase):
    def test_are_built_and_read(self):
        with tempfile.TemporaryDirectory() as folder:
            at = pathlib.Path(folder)
            occlod.generate("rough-planet", level=4).write(at / "a.ply")
            occlod.build_hlod(occlod.generate("rough-planet", level=3)).write(at / "b.ohlod")
            away = numpy.eye(4)
            away[0, 3] = 5
            scene = occlod.Scene([occlod.SceneObject(occlod.MeshFile(["a.ply"])), occlod.SceneObject(occlod.MeshFile(["b.ohlod"]), away)],
                                 {"default": occlod.Camera()})
            steps = []
            loaded = scene.load_hlods(at, node_triangles=300, use_cache=False, progress=lambda what, done: steps.append(what))
            self.assertEqual([o.hlod.input_triangle_count for o in loaded],
                             [8 * 4**4, 8 * 4**3])
            numpy.testing.assert_array_equal(loaded[1].transform, away)
            self.assertIn("b.ohlod", loaded[1].source_name)
            self.assertIn("building the scene", steps)
            frame = occlod.Traverser(loaded).draw_frame(occlod.Camera(eye=(2, 0, 9)), occlod.Device.software())
            self.assertEqual(set(frame.draws[:, 0].tolist()), {0, 1})
            (at / "b.ohlod").write_bytes(b"")
            with self.assertRaisesRegex(occlod.Error, "b.ohlod"):
                scene.load_hlods(at, use_cache=False)


if __name__ == "__main__":
    unittest.main()
