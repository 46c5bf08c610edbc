"""The Blender extension, installed from its zip into Blender's own Python module: what its two operators keep, and that the
camera, the size of its image and the object's place count. scripts/check_blender.sh sets all of it up."""
import os
import types
import unittest

import numpy
from packages import bpy, bpy_extras, mathutils

EXTENSION = os.environ.get("OCCLOD_BLENDER_EXTENSION")  # the zip
MODULE = "bl_ext.user_default.occlod"


def setUpModule():
    if bpy is None or not EXTENSION:
        raise unittest.SkipTest("SKIPPED: bpy or the extension is not here; run scripts/check_blender.sh")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.extensions.package_install_files(filepath=EXTENSION, repo="user_default", enable_on_install=True)


def tearDownModule():
    bpy.ops.preferences.addon_disable(module=MODULE)  # bpy ends with a segmentation fault while a class is registered


def values(collection, name, width=1, dtype=numpy.float32):
    found = numpy.empty(len(collection) * width, dtype)
    collection.foreach_get(name, found)
    return found if width == 1 else found.reshape(-1, width)


def corners(data):
    """The vertex of each."""
    return values(data.loops, "vertex_index", dtype=numpy.int32)


def positions(data):
    return values(data.vertices, "co", 3)


def select(made):
    bpy.context.view_layer.objects.active = made
    made.select_set(True)


def make(name, data):
    made = bpy.data.objects.new(name, data)
    bpy.context.collection.objects.link(made)
    select(made)
    return made


def paint(made):
    """Texture coordinates and colours that are known from the position, and material 1 above z = 0."""
    data, places = made.data, positions(made.data)
    layer = data.uv_layers.new(name="chart")
    layer.uv.foreach_set("vector", (places[corners(data), :2] / 2 + 0.5).ravel())
    colors = data.color_attributes.new("paint", "FLOAT_COLOR", "POINT")
    colors.data.foreach_set("color_srgb", numpy.hstack([places / 2 + 0.5, numpy.ones((len(places), 1), "f4")]).ravel())
    for material in ("below", "above", "nowhere"):
        data.materials.append(bpy.data.materials.new(material))
    centers = values(data.polygons, "center", 3)
    data.polygons.foreach_set("material_index", (centers[:, 2] > 0).astype(numpy.int32))
    return made


def ball(subdivisions=6):
    """20 * 4**(subdivisions - 1) triangles at a distance of about 1 from the origin."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=subdivisions, calc_uvs=False)
    return bpy.context.object


def hills(*more):
    """20,000 triangles of waves, from -1 to 1, and vertices of one face more."""
    steps = 100
    x, y = (values.ravel() for values in numpy.meshgrid(*[numpy.linspace(-1, 1, steps + 1)] * 2))
    vertices = numpy.stack([x, y, 0.05 * numpy.sin(20 * x) * numpy.sin(20 * y)], axis=1)
    first = (numpy.arange(steps)[:, None] * (steps + 1) + numpy.arange(steps)).ravel()
    faces = numpy.stack([first, first + 1, first + steps + 2, first + steps + 1], axis=1).tolist()
    if more:
        faces.append([len(vertices) + corner for corner in range(len(more))])
    data = bpy.data.meshes.new("hills")
    data.from_pydata([*vertices.tolist(), *more], [], faces)
    return make("hills", data)


def camera(eye, target, size=(400, 300), **more):
    """The scene's, with an image of so many pixels."""
    data = bpy.data.cameras.new("eye")
    for name, value in more.items():
        setattr(data, name, value)
    made = bpy.data.objects.new("eye", data)
    bpy.context.collection.objects.link(made)
    made.location = eye
    made.rotation_euler = (mathutils.Vector(target) - mathutils.Vector(eye)).to_track_quat("-Z", "Y").to_euler()
    scene = bpy.context.scene
    scene.camera = made
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 2 * size[0], 2 * size[1], 50
    return made


def seen(made, image):
    """How many triangles face the camera inside its image, by Blender's own projection."""
    bpy.context.view_layer.update()
    count, eye = 0, image.matrix_world.translation
    to_world, normals = made.matrix_world, made.matrix_world.inverted().transposed().to_3x3()
    for face in made.data.polygons:
        center = to_world @ face.center
        x, y, z = bpy_extras.object_utils.world_to_camera_view(bpy.context.scene, image, center)
        count += 0 < x < 1 and 0 < y < 1 and z > 0 and (normals @ face.normal).dot(eye - center) > 0
    return count


class Extension(unittest.TestCase):
    def setUp(self):
        bpy.data.batch_remove([*bpy.data.objects, *bpy.data.meshes, *bpy.data.materials, *bpy.data.cameras])
        bpy.context.scene.render.pixel_aspect_x = 1

    def refuses(self, line, call, **keywords):
        """With that line, and leaves the mesh as it is."""
        active = bpy.context.active_object
        before = active and active.data
        with self.assertRaises(RuntimeError) as raised:
            call(**keywords)
        self.assertEqual(str(raised.exception).strip(), line)
        self.assertIs(active and active.data, before)


class Simplify(Extension):
    def test_keeps_what_the_mesh_has(self):
        made = paint(ball())
        made.location, made.scale = (1, 2, 3), (2, 1, 1)
        bpy.context.view_layer.update()
        place = made.matrix_world.copy()
        self.assertEqual(bpy.ops.object.occlod_simplify(ratio=0.1), {"FINISHED"})
        data = made.data
        self.assertEqual((len(data.polygons), made.matrix_world), (2048, place))
        self.assertFalse(data.validate(), "nothing is to be mended")
        self.assertEqual([slot.name for slot in made.material_slots], ["below", "above", "nowhere"])
        height, above = values(data.polygons, "center", 3)[:, 2], values(data.polygons, "material_index", dtype=numpy.int32)
        far = abs(height) > 0.1  # farther than a triangle is long from where the materials meet
        numpy.testing.assert_array_equal(above[far], height[far] > 0)
        self.assertEqual([layer.name for layer in data.uv_layers], ["chart"])
        places = positions(data)
        numpy.testing.assert_allclose(values(data.uv_layers[0].uv, "vector", 2), places[corners(data), :2] / 2 + 0.5, atol=0.02)
        colors = data.color_attributes["paint"]
        self.assertEqual((colors.data_type, colors.domain), ("FLOAT_COLOR", "POINT"))
        numpy.testing.assert_allclose(values(colors.data, "color_srgb", 4)[:, :3], places / 2 + 0.5, atol=0.02)
        bpy.ops.object.occlod_simplify(ratio=0.5)
        layers = made.data.uv_layers.active.name, made.data.color_attributes.active_color.name
        self.assertEqual((len(made.data.polygons), *layers), (1024, "chart", "paint"))

    def test_of_everything_leaves_all_as_it_is(self):
        made = ball(3)
        count = len(made.data.loops)
        known = numpy.random.default_rng(1).integers(0, 256, (count, 4))
        made.data.uv_layers.new(name="chart").uv.foreach_set("vector", (known[:, :2] / 256).ravel())
        made.data.color_attributes.new("paint", "BYTE_COLOR", "CORNER").data.foreach_set("color_srgb", (known / 255).ravel())
        rows = []
        for _ in range(2):
            data, colors = made.data, made.data.color_attributes["paint"]
            each = positions(data)[corners(data)], values(data.uv_layers["chart"].uv, "vector", 2), values(colors.data, "color_srgb", 4)
            rows.append(numpy.hstack(each))
            self.assertEqual((len(rows[-1]), colors.data_type, colors.domain), (count, "BYTE_COLOR", "CORNER"))
            bpy.ops.object.occlod_simplify(ratio=1)
        numpy.testing.assert_array_equal(*(each[numpy.lexsort(each.T)] for each in rows))

    def test_shading(self):
        for shade, domain in (("shade_flat", "FACE"), ("shade_smooth", "POINT")):
            made = ball(4)
            getattr(made.data, shade)()
            bpy.ops.object.occlod_simplify(ratio=0.5)
            self.assertEqual(made.data.normals_domain, domain)
        bpy.ops.mesh.primitive_cylinder_add(vertices=64)
        made = bpy.context.object
        made.data.polygons.foreach_set("use_smooth", [len(face.vertices) == 4 for face in made.data.polygons])
        bpy.ops.object.occlod_simplify(ratio=1)
        normals = values(made.data.corner_normals, "vector", 3)
        side = values(made.data.polygons, "normal", 3)[:, 2].repeat(3) < 0.5
        side &= values(made.data.polygons, "normal", 3)[:, 2].repeat(3) > -0.5
        places = positions(made.data)[corners(made.data)] * (1, 1, 0)  # radius 1, so the normal of the round side
        numpy.testing.assert_allclose(normals[side], places[side], atol=0.01)
        numpy.testing.assert_allclose(abs(normals[~side]), [(0, 0, 1)] * int((~side).sum()), atol=0.01)

    def test_distances_are_those_of_the_scene(self):
        counts = []
        for scale, error in ((1, 0.01), (4, 0.04), (4, 0.01)):
            made = ball(5)
            made.scale = (scale, scale, 1)
            bpy.ops.object.occlod_simplify(goal="error", error=error)
            counts.append(len(made.data.polygons))
        self.assertEqual(counts[0], counts[1], "four times as large, four times as far")
        self.assertGreater(counts[2], 2 * counts[0])

    def test_can_be_undone(self):
        made = ball(4)
        bpy.ops.ed.undo_push(message="a ball")
        bpy.ops.object.occlod_simplify("EXEC_DEFAULT", True, goal="triangles", triangles=100)  # True: as from the window
        self.assertEqual(len(made.data.polygons), 100)
        self.assertTrue(bpy.ops.ed.undo.poll())
        bpy.ops.ed.undo()
        self.assertEqual(len(bpy.context.object.data.polygons), 1280)

    def test_other_users_keep_the_mesh(self):
        first = ball(4)
        second = make("second", first.data)
        bpy.ops.object.occlod_simplify()
        self.assertEqual((len(first.data.polygons), len(second.data.polygons)), (1280, 128))

    def test_names_what_it_leaves_out(self):
        from bl_ext.user_default.occlod import meshes  # pylint: disable=import-error
        made = paint(ball(3))
        self.assertEqual(meshes.left_out(made), [])
        made.data.uv_layers.new(name="second")
        made.vertex_groups.new(name="arm")
        made.shape_key_add(name="smile")
        made.data.vertices.add(1)
        made.data.edges.add(1)
        made.data.edges[-1].vertices = (0, len(made.data.vertices) - 1)
        made.data.update(calc_edges_loose=True)
        self.assertEqual(meshes.left_out(made), ['attribute "second"', 'vertex group "arm"', "shape keys", "loose edges (1)"])

    def test_says_what_is_wrong(self):
        ball(3)
        simplify = bpy.ops.object.occlod_simplify
        self.refuses("Error: simplify: ratio: is 0.0; give a number above 0 and at most 1", simplify, ratio=0)
        self.refuses("Error: simplify: triangles: is 0; give a whole number above 0", simplify, goal="triangles", triangles=0)
        self.refuses("Error: simplify: error: is 0.0; give a length above 0", simplify, goal="error", error=0)
        broken = bpy.data.meshes.new("broken")
        broken.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, numpy.nan, 0)], [], [(2, 0, 1), (2, 3, 0)])
        make("broken", broken)
        self.refuses("Error: broken: vertex 3: is NaN or infinite; remove it with its faces", simplify, ratio=0.5)
        make("empty", bpy.data.meshes.new("nothing"))
        self.refuses("Error: nothing: has no faces; choose a mesh with faces", simplify)

    def test_wants_a_mesh_in_object_mode(self):
        ball(3)
        bpy.ops.object.mode_set(mode="EDIT")
        for made in (None, make("lamp", bpy.data.lights.new("lamp", "POINT"))):
            for operator in ("simplify", "refine"):
                call = getattr(bpy.ops.object, f"occlod_{operator}")
                self.assertFalse(call.poll(), made)
                why = f"Operator bpy.ops.object.occlod_{operator}.poll() choose a mesh object that is not linked, in Object Mode"
                self.refuses(why, call)


class Refine(Extension):
    def test_where_the_camera_sees_the_object(self):
        """Near the camera lies one end of a long object, moved, turned and scaled unequally."""
        found = {}
        for how in ("refine", "simplify"):
            made = paint(ball())
            made.location, made.rotation_euler, made.scale = (30, -20, 10), (0.3, 0.5, 0.7), (20, 2, 2)
            bpy.context.view_layer.update()
            end = made.matrix_world @ mathutils.Vector((1, 0, 0))
            middle = made.matrix_world.translation
            image = camera(end + (end - middle) * 0.1, middle)
            if how == "refine":
                bpy.ops.object.occlod_refine(budget=1000)
            else:
                bpy.ops.object.occlod_simplify(goal="triangles", triangles=1000)
            self.assertLessEqual(len(made.data.polygons), 1000)
            self.assertGreater(len(made.data.polygons), 950)
            self.assertEqual([layer.name for layer in made.data.uv_layers], ["chart"])
            self.assertEqual(len(set(values(made.data.polygons, "material_index", dtype=numpy.int32))), 2)
            found[how] = seen(made, image)
        print(f"{found} of 1,000 triangles face the camera in its image")
        self.assertGreater(found["refine"], 1.5 * found["simplify"])

    def test_what_the_mesh_hides_stays_coarse(self):
        """Hills whose left half lies behind a wall."""
        made = hills((-3, -3, 1), (0, -3, 1), (0, 3, 1), (-3, 3, 1))
        camera((0, 0, 3), (0, 0, 0))
        bpy.ops.object.occlod_refine(budget=2000)
        centers = values(made.data.polygons, "center", 3)
        left, right = ((centers[:, 2] < 0.5) & (sign * centers[:, 0] > 0.05) for sign in (-1, 1))
        self.assertGreater(right.sum(), 10 * left.sum())

    def test_the_image_counts(self):
        """What a camera that is shifted, parallel, narrow, or has an upright image does not see stays coarse."""
        for more in ({"type": "ORTHO", "ortho_scale": 0.7}, {"lens": 200}, {"shift_x": 0.7, "lens": 100}, {"size": (100, 400)}):
            made = hills()
            image = camera((0, 0, 3), (0, 0, 0), **more)
            bpy.ops.object.occlod_refine(budget=1000)
            self.assertGreater(seen(made, image), 0.6 * len(made.data.polygons), more)

    def test_says_what_is_wrong(self):
        ball(3)
        refine = bpy.ops.object.occlod_refine
        bpy.context.scene.camera = None
        self.refuses("Error: Scene: has no active camera; add one", refine)
        image = camera((0, 0, 5), (0, 0, 0))
        self.refuses("Error: budget: of 3 triangles is smaller than the base meshes; give at least 64", refine, budget=3)
        bpy.context.scene.render.pixel_aspect_x = 2
        self.refuses("Error: Scene: renders pixels that are not square; set both aspects to 1", refine)
        image.data.type = "PANO"
        self.refuses("Error: eye: is panoramic; choose a perspective or orthographic camera", refine)


class Panel(Extension):
    def test_has_both_operators(self):
        shown = []
        layout = types.SimpleNamespace(operator=shown.append)
        bpy.types.VIEW3D_PT_occlod.draw(types.SimpleNamespace(layout=layout), bpy.context)
        self.assertEqual(shown, ["object.occlod_simplify", "object.occlod_refine"])


if __name__ == "__main__":
    unittest.main()
