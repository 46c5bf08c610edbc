"""HLODs whose meshes come and go, what is selected of them, and what other programs make of it."""
import concurrent.futures
import pathlib
import tempfile
import unittest

import numpy
import occlod
from packages import trimesh
from support import VIEW, box_of_charts, looks

CLOSE = occlod.Camera(eye=(0.4, 0.3, 3), width=512, height=384)


def box_hlod():
    """A cube with colours, texture coordinates and two materials, in many nodes."""
    mesh, _ = box_of_charts().clean()
    return mesh, occlod.build_hlod(mesh, node_triangles=64)


def settled(hlod, camera=CLOSE, **options):
    """What is selected when all that is needed has come."""
    selector = occlod.Selector(hlod)
    for _ in range(10_000):
        selection = selector.select(camera, **options)
        if selection.missing == 0:
            return selection
    raise AssertionError("something never comes")


class Selected(unittest.TestCase):
    def test_is_the_input_at_tolerance_0(self):
        mesh, hlod = box_hlod()
        selection = occlod.Selector(hlod).select(CLOSE, tolerance_px=0, occlusion=False)
        self.assertEqual(looks(selection.mesh()), looks(mesh))
        self.assertEqual(selection.triangles, mesh.triangle_count)
        made = selection.mesh()
        self.assertEqual((made.materials, made.textures, made.texture_origin), (mesh.materials, mesh.textures, mesh.texture_origin))

    def test_hides_what_nothing_shows(self):
        mesh = occlod.generate("rough-planet", level=5)
        hlod = occlod.build_hlod(mesh, node_triangles=100)
        selector = occlod.Selector(hlod)
        seen, everything = selector.select(VIEW, tolerance_px=0), occlod.Selector(hlod).select(VIEW, tolerance_px=0, occlusion=False)
        self.assertGreater(seen.hidden, 0)
        self.assertLess(seen.triangles, everything.triangles)
        depths = [occlod.draw_items(occlod.draw_objects(s.mesh()), VIEW).nearness for s in (seen, everything)]
        numpy.testing.assert_array_equal(*depths)

    def test_arrays_say_what_the_mesh_is(self):
        _, hlod = box_hlod()
        selection = occlod.Selector(hlod).select(CLOSE, tolerance_px=3)
        triangles = sum(count for _, _, first, n in selection.draws for _, count in selection.ranges[first : first + n]) // 3
        self.assertEqual(triangles, selection.triangles)
        self.assertEqual(triangles, selection.mesh().triangle_count)
        self.assertEqual(len(selection.morphs), len(selection.ranges))
        draws = selection.draws
        del selection, hlod
        self.assertTrue((draws[:, 0] == 0).all())

    def test_keeps_a_budget_at_two_places(self):
        hlod = occlod.build_hlod(occlod.generate("rough-planet", level=5), node_triangles=100)
        away = numpy.eye(4)
        away[0, 3] = 3
        selector = occlod.Selector([hlod, occlod.HlodObject(hlod, away)])
        camera = occlod.Camera(eye=(1.5, 0, 6))
        for _ in range(5):
            selection = selector.select(camera, tolerance_px=0, budget=3000)
            self.assertLessEqual(selection.triangles, 3000)
            self.assertGreater(selection.tolerance_px, 0)
            self.assertEqual(selection.mesh(0).triangle_count + selection.mesh(1).triangle_count, selection.triangles)
        away[0, 3] = 1000
        selector.set_transform(1, away)
        self.assertEqual(selector.select(camera).mesh(1).triangle_count, 0)
        with self.assertRaises(IndexError):
            selection.mesh(2)
        with self.assertRaisesRegex(occlod.Error, "tolerance_px"):
            selector.select(camera, tolerance_px=-1)


class Paged(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.mesh, self.whole = box_hlod()
        self.path = pathlib.Path(self.folder.name, "box.ohlod")
        self.whole.write(self.path)

    def test_nodes_have_all_attributes(self):
        for blocking in (False, True):
            hlod = occlod.open_hlod(self.path, blocking=blocking)
            self.assertTrue(hlod.is_paged)
            selection = settled(hlod, tolerance_px=0, occlusion=False)
            self.assertEqual(looks(selection.mesh()), looks(self.mesh))
            self.assertEqual(len(hlod.missing()), 0)
            for node in range(hlod.node_count):
                if not hlod.is_resident(node):
                    continue
                paged, whole = hlod.mesh(node), self.whole.mesh(node)
                for name in ("positions", "triangles", "colors", "texture_coordinates", "vertex_materials", "merged_into"):
                    numpy.testing.assert_array_equal(getattr(paged, name), getattr(whole, name), name)
                self.assertIsNone(paged.normals)
                self.assertEqual(looks(paged.mesh()), looks(whole.mesh()))
            self.assertEqual((hlod.materials, hlod.textures), (self.mesh.materials, self.mesh.textures))

    def test_normals_too(self):
        mesh = occlod.generate("rough-planet", level=4)
        with_normals = occlod.Mesh(mesh.positions, mesh.triangles, normals=mesh.positions / numpy.linalg.norm(mesh.positions, axis=1)[:, None])
        whole = occlod.build_hlod(with_normals, node_triangles=200)
        whole.write(self.path)
        hlod = occlod.open_hlod(self.path)
        node = int(hlod.roots[0])
        numpy.testing.assert_array_equal(hlod.mesh(node).normals, whole.mesh(node).normals)
        self.assertEqual(hlod.mesh(node).mesh().normals.shape, hlod.mesh(node).mesh().positions.shape)

    def test_meshes_stay_when_their_nodes_leave(self):
        root = int(self.whole.roots[0])
        least = int(str(self.error(occlod.open_hlod, self.path, memory=1)).split("at least ")[1].split()[0])
        room = 2 * least + 8000
        hlod = occlod.open_hlod(self.path, memory=room, blocking=True)
        kept = {}
        for eye in ((0, 0, 3), (0, 0, -3), (3, 0, 0), (-3, 0, 0)):
            selection = settled(hlod, occlod.Camera(eye=eye), tolerance_px=1e-3, occlusion=False) if not kept else \
                occlod.Selector(hlod).select(occlod.Camera(eye=eye), tolerance_px=1e-3)
            for _, node, _, _ in selection.draws.tolist():
                kept[node] = hlod.mesh(node).positions
            self.assertLessEqual(hlod.resident_bytes, room)
        for node, positions in kept.items():
            numpy.testing.assert_array_equal(positions, self.whole.mesh(node).positions)
        self.assertTrue(hlod.is_resident(root))

    def error(self, function, *arguments, **more):
        with self.assertRaises(occlod.Error) as raised:
            function(*arguments, **more)
        return raised.exception

    def test_what_needs_all_meshes_says_so(self):
        hlod = occlod.open_hlod(self.path, blocking=True)
        finest = hlod.levels[0][0]
        self.assertFalse(hlod.is_resident(finest))
        self.assertIn("is not in memory", str(self.error(hlod.mesh, finest)))
        settled(hlod, tolerance_px=0, occlusion=False)
        for function, *arguments in ((hlod.write, pathlib.Path(self.folder.name, "again.ohlod")), (hlod.validate,), (hlod.require_all,)):
            self.assertIn("open the file without a cache", str(self.error(function, *arguments)))

    def test_threads_may_share_one(self):
        hlod = occlod.open_hlod(self.path)
        eyes = [(3, 0, 0.5), (-3, 0, 0.5), (0, 0.5, 3), (0, 0.5, -3)] * 2
        with concurrent.futures.ThreadPoolExecutor(4) as threads:
            shown = list(threads.map(lambda eye: settled(hlod, occlod.Camera(eye=eye), tolerance_px=0.5).triangles, eyes))
        self.assertEqual(shown, [occlod.Selector(self.whole).select(occlod.Camera(eye=eye), tolerance_px=0.5).triangles for eye in eyes])

    def test_what_never_comes_is_told(self):
        data = bytearray(self.path.read_bytes())
        node = self.whole.levels[0][0]
        hlod = occlod.open_hlod(self.path)
        self.assertEqual(hlod.take_failures(), [])
        del hlod
        plain = pathlib.Path(self.folder.name, "plain.ohlod")
        self.whole.write(plain, compression=occlod.Compression.none)
        data = bytearray(plain.read_bytes())
        at = data.index(self.whole.mesh(node).positions.tobytes())
        data[at] ^= 0xff
        plain.write_bytes(data)
        hlod = occlod.open_hlod(plain, blocking=True)
        selection = occlod.Selector(hlod).select(CLOSE, tolerance_px=0, occlusion=False)
        self.assertLess(selection.triangles, self.mesh.triangle_count)
        failures = hlod.take_failures()
        self.assertEqual(len(failures), 1)
        self.assertIn("plain.ohlod", failures[0])


class Elsewhere(unittest.TestCase):
    @unittest.skipIf(trimesh is None, "trimesh is not installed")
    def test_trimesh_draws_what_is_selected(self):
        mesh, hlod = box_hlod()
        selection = occlod.Selector(hlod).select(CLOSE, tolerance_px=0, occlusion=False)
        with self.assertWarns(UserWarning):  # there is no checker.png
            shown = occlod.to_trimesh(selection.mesh())
        self.assertEqual(len(shown.faces), mesh.triangle_count)
        self.assertEqual(shown.visual.uv.shape, (len(shown.vertices), 2))
        self.assertEqual(len(shown.visual.vertex_attributes["color"]), len(shown.vertices))

    def test_three_reads_it_as_a_glb(self):
        _, hlod = box_hlod()
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "selected.glb")
            made = occlod.Selector(hlod).select(CLOSE, tolerance_px=0).mesh()
            made.textures = []
            made.materials = [occlod.Material("even"), occlod.Material("odd")]
            made.write(path)
            again = occlod.read_mesh(path)
        self.assertEqual(again.triangle_count, made.triangle_count)
        self.assertIsNotNone(again.texture_coordinates)


if __name__ == "__main__":
    unittest.main()
