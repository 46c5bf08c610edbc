"""Objects as Python has them: pickled, copied, printed; and cameras that look at them."""
import copy
import pathlib
import pickle
import subprocess
import sys
import tempfile
import unittest

import numpy
import occlod
from support import box_of_charts, looks, planet

UTM = numpy.array((691607.37, 5334760.81, 519.93))


class Pickled(unittest.TestCase):
    def again(self, thing):
        return pickle.loads(pickle.dumps(thing))

    def test_meshes(self):
        mesh, _ = box_of_charts().clean()
        bump = occlod.TextureMap(0, strength=0.5, offset=(0.25, 0.5), rotation=0.5, scale=(2, 4))
        surface = occlod.Surface(alpha_mode=occlod.AlphaMode.mask, alpha_cutoff=0.25, double_sided=True, unlit=True, metallic=0.5, roughness=0.75,
                                 emissive=(0.5, 0.25, 1), metallic_map=bump, normal_map=bump, occlusion_map=bump, emissive_map=bump)
        mesh.materials = [occlod.Material("even", base_color=(1, 0.5, 0.25, 1), texture=0, surface=surface), occlod.Material("odd")]
        mesh.textures = [occlod.Texture("Stra\udcdfe.png", mime_type="image/png", bytes=b"\x89PNG\0", wrap_s=occlod.TextureWrap.clamp, min_filter=9984)]
        mesh.origin, mesh.up, mesh.texture_origin = tuple(UTM), occlod.UpAxis.y, occlod.TextureOrigin.top_left
        for other in (self.again(mesh), copy.copy(mesh), copy.deepcopy(mesh)):
            self.assertEqual(looks(other), looks(mesh))
            self.assertEqual((other.materials, other.textures), (mesh.materials, mesh.textures))
            self.assertEqual((other.origin, other.up, other.texture_origin), (mesh.origin, mesh.up, mesh.texture_origin))
            numpy.testing.assert_array_equal(other.corners, mesh.corners)
            self.assertFalse(numpy.shares_memory(other.positions, mesh.positions))
        normals = occlod.Mesh(numpy.eye(3), [[0, 1, 2]], normals=numpy.eye(3))
        numpy.testing.assert_array_equal(self.again(normals).normals, normals.normals)

    def test_hierarchies_and_hlods(self):
        mesh, hierarchy = planet(3)
        hlod = occlod.build_hlod(mesh, node_triangles=64)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.olod")
            hierarchy.write(path)
            mapped = occlod.read_hierarchy(path)
            for thing in (hierarchy, mapped, hlod):
                other = self.again(thing)
                self.assertIs(type(other), type(thing))
                self.assertTrue(other.restores(mesh))
                self.assertEqual(repr(other), repr(thing))
                self.assertIs(copy.copy(thing), thing, "it never changes")
                self.assertIs(copy.deepcopy(thing), thing)
            numpy.testing.assert_array_equal(self.again(hierarchy).errors, hierarchy.errors)

    def test_another_process_reads_them(self):
        _, hierarchy = planet(3)
        command = "import pickle, sys; print(pickle.load(sys.stdin.buffer))"
        done = subprocess.run([sys.executable, "-c", command], input=pickle.dumps(hierarchy), stdout=subprocess.PIPE, check=True)
        self.assertEqual(done.stdout.decode().strip(), repr(hierarchy))

    def test_cameras_views_and_options(self):
        camera = occlod.Camera(eye=(1, 2, 3), target=(4, 5, 6), up=(0, 0, 1), fov_y_deg=30, width=64, height=48, near=0.5, far=7, orthographic_height=2)
        off_centre = occlod.Camera(principal_point=(0.25, -0.5))
        options = occlod.RefineOptions(budget=7, tolerance_px=0.5, method=occlod.Method.paper, mode=occlod.OccluderMode.conservative, max_changes=3,
                                       time_limit_ms=4, geomorph_frames=5, threads=6)
        for thing in (camera, off_centre, occlod.Camera(), options):
            for other in (self.again(thing), copy.copy(thing), copy.deepcopy(thing)):
                self.assertEqual(other, thing)
                self.assertIsNot(other, thing)
        self.assertEqual(self.again(occlod.View(camera)).camera, camera)


class Printed(unittest.TestCase):
    def test_objects_say_how_large_they_are(self):
        mesh, hierarchy = planet(3)
        self.assertEqual(repr(mesh), "<occlod.Mesh of 258 vertices and 512 triangles>")
        self.assertEqual(repr(box_of_charts().clean()[0]), "<occlod.Mesh of 386 vertices (486 wedges) and 768 triangles>")
        self.assertIn("of 512 triangles", repr(hierarchy))
        self.assertEqual(repr(hierarchy.cut()), "<occlod.Cut of 512 of 512 triangles>")
        self.assertRegex(repr(occlod.build_hlod(mesh, node_triangles=64)), r"^<occlod.Hlod of \d+ nodes on \d levels, 512 triangles in the input>$")
        self.assertEqual(repr(occlod.Camera(eye=(0, 0.5, 3))), "<occlod.Camera at (0, 0.5, 3) that looks at (0, 0, 0), 1024 x 768 pixels>")


class Looking(unittest.TestCase):
    def assert_framed(self, what, camera):
        """Something in the middle, nothing at the border."""
        items = occlod.draw_items(occlod.draw_objects(what), camera).nearness > 0
        self.assertTrue(items[items.shape[0] // 2, items.shape[1] // 2])
        for border in (items[0], items[-1], items[:, 0], items[:, -1]):
            self.assertFalse(border.any())

    def test_at_meshes_wherever_they_are(self):
        near, _ = planet(3)
        far = occlod.Mesh(near.positions + UTM, near.triangles)
        self.assertTrue(any(far.origin))
        hierarchy = occlod.build_hierarchy(far)
        for what in (near, far, hierarchy):
            self.assert_framed(what, occlod.Camera.looking_at(what, width=64, height=48))
        hlod = occlod.build_hlod(far)
        numpy.testing.assert_allclose(occlod.Camera.looking_at(hlod).target, occlod.Camera.looking_at(far).target, atol=1e-3)
        corners = numpy.array(far.positions.min(axis=0) + UTM * 0 + far.origin), numpy.array(far.positions.max(axis=0) + far.origin)
        self.assertEqual(occlod.Camera.looking_at(corners), occlod.Camera.looking_at(far))

    def test_along_a_direction(self):
        mesh, _ = planet(3)
        for direction in ((0, 0, -1), (0, -5, 0), (0, 3, 0), (1, 2, -2)):
            camera = occlod.Camera.looking_at(mesh, direction=direction, width=80, height=60, fov_y_deg=20)
            self.assertEqual((camera.width, camera.height, camera.fov_y_deg), (80, 60, 20))
            numpy.testing.assert_allclose(occlod.View(camera).direction, numpy.array(direction) / numpy.linalg.norm(direction), atol=1e-6)
            self.assert_framed(mesh, camera)
        self.assertEqual(occlod.Camera.looking_at(mesh, direction=(0, -1, 0)).up, (0, 0, -1))
        self.assertEqual(occlod.Camera.looking_at(mesh, occlod.Camera(up=(0, 0, 1)), direction=(0, 0, -1)).up, (0, 1, 0))

    def test_mistakes_are_told(self):
        mesh, _ = planet(2)
        for direction in ((0, 0, 0), (0, float("nan"), 1)):
            with self.assertRaisesRegex(ValueError, "^direction: has no length"):
                occlod.Camera.looking_at(mesh, direction=direction)
        with self.assertRaisesRegex(occlod.Error, "has no vertices"):
            occlod.Camera.looking_at(occlod.Mesh.empty(0, 0))


if __name__ == "__main__":
    unittest.main()
