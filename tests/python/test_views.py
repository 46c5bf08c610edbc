"""Views of programs that have matrices, against NumPy."""
import unittest

import numpy
import occlod
from occlod import ClipDepth

WIDTH, HEIGHT, NEAR, FAR = 320, 200, 0.5, 40.0


def looking(eye, target, up=(0, 0, 1)):
    """World to eye space, in which -z is ahead; multiplies columns from the left."""
    ahead = numpy.subtract(target, eye) / numpy.linalg.norm(numpy.subtract(target, eye))
    right = numpy.cross(ahead, up) / numpy.linalg.norm(numpy.cross(ahead, up))
    matrix = numpy.eye(4)
    matrix[:3, :3] = right, numpy.cross(right, ahead), -ahead
    matrix[:3, 3] = -matrix[:3, :3] @ eye
    return matrix


def depth_row(depth, perspective):
    """The third row of a projection: z / w is as `depth` says at the planes. An infinite far plane has none in reach."""
    at_near, at_far = {ClipDepth.minus_one_to_one: (-1, 1), ClipDepth.zero_to_one: (0, 1), ClipDepth.one_to_zero: (1, 0)}[depth]
    if perspective:  # a z + b = clip z, with w = -z
        a, b = numpy.linalg.solve([[-NEAR, 1], [-FAR, 1]], [at_near * NEAR, at_far * FAR])
    else:
        a, b = numpy.linalg.solve([[-NEAR, 1], [-FAR, 1]], [at_near, at_far])
    return [0, 0, a, b]


def perspective(depth, middle=(0.0, 0.0)):
    """45 degrees high; the line of sight meets the image at `middle`, in clip space."""
    y = 1 / numpy.tan(numpy.radians(45) / 2)
    return numpy.array([[y * HEIGHT / WIDTH, 0, -middle[0], 0], [0, y, -middle[1], 0], depth_row(depth, True), [0, 0, -1, 0]])


def orthographic(depth, middle=(0.0, 0.0)):
    """8 units high."""
    y = 2 / 8
    return numpy.array([[y * HEIGHT / WIDTH, 0, 0, middle[0]], [0, y, 0, middle[1]], depth_row(depth, False), [0, 0, 0, 1]])


def on_image(matrix, points):
    clip = numpy.c_[points, numpy.ones(len(points))] @ matrix.T
    return clip[:, :2] / clip[:, 3:]


class Matrices(unittest.TestCase):
    def setUp(self):
        self.eye, self.target = numpy.array((7.0, -4.0, 3.0)), numpy.array((0.5, 1.0, 0.25))
        self.world_to_eye = looking(self.eye, self.target)
        self.points = numpy.random.default_rng(1).uniform(-2, 2, (500, 3)) + self.target

    def assert_shows_the_same(self, eye_to_clip, depth):
        view = occlod.view_of(self.world_to_eye, eye_to_clip, WIDTH, HEIGHT, depth)
        numpy.testing.assert_allclose(on_image(view.world_to_clip, self.points), on_image(eye_to_clip @ self.world_to_eye, self.points), atol=1e-9)
        self.assertEqual((view.width, view.height), (WIDTH, HEIGHT))
        return view

    def test_perspectives(self):
        for depth in (ClipDepth.minus_one_to_one, ClipDepth.zero_to_one, ClipDepth.one_to_zero):
            for middle in ((0, 0), (0.25, -1.5)):
                view = self.assert_shows_the_same(perspective(depth, middle), depth)
                camera = view.camera
                numpy.testing.assert_allclose(camera.eye, self.eye, atol=1e-12)
                numpy.testing.assert_allclose(camera.principal_point, middle, atol=1e-12)
                numpy.testing.assert_allclose((camera.fov_y_deg, camera.near, camera.far), (45, NEAR, FAR), rtol=1e-12)
                numpy.testing.assert_allclose(view.direction, (self.target - self.eye) / numpy.linalg.norm(self.target - self.eye), atol=1e-12)
                self.assertEqual(occlod.View(camera).camera, camera)

    def test_parallel_rays(self):
        for depth in (ClipDepth.minus_one_to_one, ClipDepth.zero_to_one, ClipDepth.one_to_zero):
            for middle in ((0, 0), (0.25, -1.5)):
                camera = self.assert_shows_the_same(orthographic(depth, middle), depth).camera
                self.assertAlmostEqual(camera.orthographic_height, 8)
                self.assertAlmostEqual(camera.far - camera.near, FAR - NEAR)

    def test_no_far_plane(self):
        for depth, row in ((ClipDepth.minus_one_to_one, (0, 0, -1, -2 * NEAR)), (ClipDepth.zero_to_one, (0, 0, -1, -NEAR)),
                           (ClipDepth.one_to_zero, (0, 0, 0, NEAR))):
            matrix = perspective(depth)
            matrix[2] = row
            camera = self.assert_shows_the_same(matrix, depth).camera
            self.assertAlmostEqual(camera.near, NEAR)
            self.assertEqual(camera.far, 1e12 * camera.near)

    def test_what_is_refined_for_them_is_refined_for_the_camera(self):
        hierarchy = occlod.build_hierarchy(occlod.generate("rough-planet", level=4))
        camera = occlod.Camera(eye=(0, 0, 3), width=WIDTH, height=HEIGHT, near=NEAR, far=FAR)
        view = occlod.view_of(looking((0, 0, 3), (0, 0, 0), up=(0, 1, 0)), perspective(ClipDepth.zero_to_one), WIDTH, HEIGHT, ClipDepth.zero_to_one)
        refined = [occlod.Refiner(hierarchy).refine(one, budget=900).triangles() for one in (camera, view)]
        numpy.testing.assert_array_equal(*refined)

    def test_rows_are_not_taken_for_columns(self):
        matrix = perspective(ClipDepth.minus_one_to_one)
        with self.assertRaisesRegex(occlod.Error, "world_to_eye: is no rigid motion"):
            occlod.view_of(self.world_to_eye.T, matrix.T, WIDTH, HEIGHT)

    def test_mistakes_are_told(self):
        matrix = perspective(ClipDepth.minus_one_to_one)
        with self.assertRaisesRegex(TypeError, r"eye_to_clip: wrong shape; give an array of \(4, 4\)"):
            occlod.view_of(self.world_to_eye, matrix[:3], WIDTH, HEIGHT)
        with self.assertRaisesRegex(occlod.Error, "pixels that are not square"):
            occlod.view_of(self.world_to_eye, matrix, WIDTH, WIDTH)
        with self.assertRaisesRegex(occlod.Error, "near plane"):
            occlod.view_of(self.world_to_eye, perspective(ClipDepth.one_to_zero), WIDTH, HEIGHT, ClipDepth.zero_to_one)


if __name__ == "__main__":
    unittest.main()
