"""Coordinates with more digits than float32 has."""
import pathlib
import tempfile
import unittest

import numpy
import occlod

UTM = numpy.array((691607.37, 5334760.81, 519.93))
TENTH_MM = 1e-4


def patch(at, n=20):
    """(n + 1)^2 coordinates of a patch 2 m wide with bumps, and its triangles."""
    y, x = numpy.mgrid[0:n + 1, 0:n + 1]
    points = numpy.stack([0.1 * x, 0.1 * y, 0.05 * numpy.sin(0.7 * x) * numpy.cos(0.5 * y)], -1).reshape(-1, 3) + at
    corner = (numpy.arange(n)[:, None] * (n + 1) + numpy.arange(n)).ravel()
    return points, numpy.concatenate([corner[:, None] + (0, 1, n + 2), corner[:, None] + (0, n + 2, n + 1)])


def coordinates(mesh):
    return mesh.positions + numpy.array(mesh.origin)


class Origin(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="occlod-origin-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.points, triangles = patch(UTM)
        self.mesh = occlod.Mesh(self.points, triangles)

    def assert_kept(self, mesh, points):
        self.assertNotEqual(mesh.origin, (0, 0, 0))
        self.assertLess(numpy.abs(coordinates(mesh) - points).max(), TENTH_MM)

    def test_float64_arrays_keep_their_digits(self):
        self.assert_kept(self.mesh, self.points)
        clean, report = self.mesh.clean()
        self.assert_kept(clean, self.points)
        self.assertEqual(report.zero_area_triangles, 0)

    def test_floats_and_near_arrays_have_none(self):
        _, triangles = patch(UTM)
        self.assertEqual(occlod.Mesh(self.points.astype(numpy.float32), triangles).origin, (0, 0, 0))
        near, _ = patch(0)
        mesh = occlod.Mesh(near, triangles)
        self.assertEqual(mesh.origin, (0, 0, 0))
        self.assertTrue((mesh.positions == near.astype(numpy.float32)).all())

    def test_it_can_be_set(self):
        self.mesh.origin = (1, 2, 3)
        self.assertEqual(self.mesh.origin, (1, 2, 3))

    def test_hierarchies_hlods_and_files_keep_it(self):
        hierarchy = occlod.build_hierarchy(self.mesh.clean()[0])
        self.assertEqual(hierarchy.origin, self.mesh.origin)
        hierarchy.write(self.folder / "a.olod")
        self.assertEqual(occlod.read_hierarchy(self.folder / "a.olod").origin, self.mesh.origin)
        full = hierarchy.cut().mesh()
        self.assertEqual(full.origin, self.mesh.origin)
        for name in ("a.ply", "a.obj", "a.glb"):
            full.write(self.folder / name)
            again = occlod.read_mesh(self.folder / name)
            self.assertEqual(again.origin, self.mesh.origin, name)
            self.assertTrue((again.positions == full.positions).all(), name)
        hlod = occlod.build_hlod(self.mesh.clean()[0])
        self.assertEqual(hlod.origin, self.mesh.origin)
        hlod.write(self.folder / "a.ohlod")
        self.assertEqual(occlod.read_hlod(self.folder / "a.ohlod").origin, self.mesh.origin)

    def test_objects_are_at_their_coordinates(self):
        """A camera in world coordinates sees the mesh, refined, cut, as an HLOD and as it is."""
        mesh = self.mesh.clean()[0]
        camera = occlod.Camera(eye=tuple(UTM + (1.0, 1.0, 3.0)), target=tuple(UTM + (1.0, 1.01, 0.0)), near=0.1, far=10, width=64, height=64)
        hierarchy = occlod.build_hierarchy(mesh)
        refined = occlod.Refiner(hierarchy).refine(camera, budget=200)
        for what in (refined, hierarchy, occlod.Object(hierarchy), hierarchy.cut(triangles=200), mesh):
            self.assertTrue((occlod.draw_items(occlod.draw_objects(what), camera).nearness[16:48, 16:48] > 0).all(), what)
        self.assertEqual(tuple(occlod.Object(hierarchy).transform[:3, 3]), mesh.origin)
        self.assertEqual(tuple(occlod.HlodObject(occlod.build_hlod(mesh)).transform[:3, 3]), mesh.origin)

    def test_scenes_place_coordinates(self):
        self.mesh.clean()[0].write(self.folder / "a.ply")
        move = numpy.eye(4)
        move[:3, 3] = (0.25, 0, 0)
        camera = occlod.Camera(eye=tuple(UTM + (1.0, 1.0, 3.0)), target=tuple(UTM + (1.0, 1.01, 0.0)), near=0.1, far=10)
        scene = occlod.Scene([occlod.SceneObject(occlod.MeshFile([str(self.folder / "a.ply")]), move)], {"default": camera})
        placed = scene.load(use_cache=False)[0]
        world = placed.hierarchy.positions @ placed.transform[:3, :3].T + placed.transform[:3, 3]
        for axis in range(3):
            self.assertLess(abs(world[:, axis].min() - self.points[:, axis].min() - move[axis, 3]), TENTH_MM)


if __name__ == "__main__":
    unittest.main()
