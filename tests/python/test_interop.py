"""Meshes to other packages and back: what is kept, and that what is not is named."""
import io
import pathlib
import tempfile
import unittest
import warnings

import numpy
import occlod
from packages import open3d, pyvista, trimesh
from support import box_of_charts, corners, looks, tetrahedron

try:
    import PIL.Image
except ImportError:
    PIL = None

RED, BLUE = (255, 0, 0, 255), (0, 0, 255, 255)


class InteropTest(unittest.TestCase):
    def silently(self, call, *arguments, **keywords):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return call(*arguments, **keywords)


def png(color):
    """The bytes of an image of one colour."""
    file = io.BytesIO()
    PIL.Image.new("RGB", (4, 4), color).save(file, "PNG")
    return file.getvalue()


def textured_box():
    """box_of_charts() with an image inside, a look for each of two materials and no colours."""
    box, _ = box_of_charts().clean()
    surface = occlod.Surface(alpha_mode=occlod.AlphaMode.mask, alpha_cutoff=0.25, double_sided=True, metallic=0.5, roughness=0.75,
                             emissive=(0.5, 0.25, 1), normal_map=occlod.TextureMap(1))
    return occlod.Mesh(
        box.positions, box.triangles, texture_coordinates=box.texture_coordinates, extra_wedges=box.extra_wedges, corners=box.corners,
        triangle_materials=box.triangle_materials,
        materials=[occlod.Material("even", base_color=(1, 0, 0.2, 1), texture=0, surface=surface), occlod.Material("odd", surface=occlod.Surface(metallic=1))],
        textures=[occlod.Texture(mime_type="image/png", bytes=png((9, 8, 7))), occlod.Texture(mime_type="image/png", bytes=png((128, 128, 255)))])


def looks_of(mesh):
    """looks() without colours."""
    return looks(occlod.Mesh(mesh.positions, mesh.triangles, colors=numpy.zeros((mesh.wedge_count, 4), numpy.uint8), texture_coordinates=mesh.texture_coordinates,
                             extra_wedges=mesh.extra_wedges, corners=mesh.corners, triangle_materials=mesh.triangle_materials, materials=mesh.materials,
                             textures=mesh.textures))


@unittest.skipIf(trimesh is None, "SKIPPED: trimesh is not installed")
class Trimesh(InteropTest):
    def test_shapes_and_vertex_colors(self):
        mesh = self.silently(occlod.from_trimesh, trimesh.creation.icosphere(subdivisions=2))
        self.assertEqual((mesh.triangle_count, mesh.materials), (320, ()))
        back = self.silently(occlod.to_trimesh, mesh)
        self.assertTrue(back.is_watertight)
        numpy.testing.assert_array_equal(back.vertices.astype("f4"), mesh.positions)
        numpy.testing.assert_array_equal(back.faces, mesh.triangles)
        colored = occlod.Mesh(mesh.positions, mesh.triangles, colors=numpy.full((mesh.vertex_count, 4), 9, numpy.uint8))
        numpy.testing.assert_array_equal(self.silently(occlod.from_trimesh, occlod.to_trimesh(colored)).colors, colored.colors)

    def test_face_colors_become_wedges(self):
        box = trimesh.creation.box()
        box.visual.face_colors = numpy.where(box.face_normals[:, 2:] > 0.5, RED, BLUE).astype(numpy.uint8)
        mesh, report = self.silently(occlod.from_trimesh, box).clean()
        self.assertEqual((mesh.vertex_count, report.seam_vertices), (8, 4), "the upper corners have both colours")
        for triangle, wedges in zip(mesh.triangles, mesh.wedge_triangles):
            upper = (mesh.positions[triangle, 2] > 0).all()
            numpy.testing.assert_array_equal(mesh.colors[wedges], [RED if upper else BLUE] * 3)

    def test_texture_coordinates_and_colors(self):
        mesh, _ = box_of_charts(texture_origin=occlod.TextureOrigin.top_left).clean()
        with self.assertWarnsRegex(UserWarning, '^to_trimesh: leaves out image "checker.png"$'):
            there = occlod.to_trimesh(mesh)
        self.assertEqual((len(there.vertices), there.visual.kind), (mesh.wedge_count, "texture"))
        again, _ = self.silently(occlod.from_trimesh, there).clean()
        self.assertEqual((again.vertex_count, again.wedge_count), (mesh.vertex_count, mesh.wedge_count))
        again.texture_coordinates[:] = again.texture_coordinates * (1, -1) + (0, 1)  # there v grows upwards
        self.assertEqual(looks(again), looks(mesh))
        self.assertEqual([material.name for material in again.materials], ["even", "odd"])

    @unittest.skipIf(PIL is None, "SKIPPED: Pillow is not installed")
    def test_materials_and_images(self):
        mesh = textured_box()
        again, _ = self.silently(occlod.from_trimesh, self.silently(occlod.to_trimesh, mesh)).clean()
        self.assertEqual(looks_of(again), looks_of(mesh))
        self.assertEqual(again.materials, mesh.materials)
        pixels = [[PIL.Image.open(io.BytesIO(t.bytes)).getpixel((0, 0)) for t in m.textures] for m in (mesh, again)]
        self.assertEqual(pixels[0], pixels[1])
        surface = occlod.Surface(unlit=True, normal_map=occlod.TextureMap(0, strength=0.5))
        mesh.materials = [occlod.Material("even", surface=surface), occlod.Material("odd")]
        mesh.textures = [occlod.Texture(mime_type="image/png", bytes=png((9, 8, 7)), wrap_s=occlod.TextureWrap.clamp)]
        told = 'wrapping of image 0, unlit of material "even", places and strengths of maps of material "even"'
        with self.assertWarnsRegex(UserWarning, f"^to_trimesh: leaves out {told}$"):
            occlod.to_trimesh(mesh)

    @unittest.skipIf(PIL is None, "SKIPPED: Pillow is not installed")
    def test_files_read_there_are_as_read_here(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "box.glb")
            textured_box().write(path)
            here, scene = occlod.read_mesh(path), trimesh.load(path, force="scene")
        there, _ = self.silently(occlod.from_trimesh, scene).clean()
        self.assertEqual(there.texture_origin, occlod.TextureOrigin.bottom_left)
        there.texture_coordinates[:] = there.texture_coordinates * (1, -1) + (0, 1)
        self.assertEqual(corners(there.positions, there.triangles), corners(here.positions, here.triangles))
        by_name = [{material.name: material for material in mesh.materials} for mesh in (here, there)]
        for name in ("even", "odd"):
            one, other = (materials[name] for materials in by_name)
            self.assertEqual((one.base_color, one.surface.roughness, one.surface.alpha_mode), (other.base_color, other.surface.roughness, other.surface.alpha_mode))
            places = []
            for mesh in (here, there):
                names = numpy.array([material.name for material in mesh.materials])
                chosen = names[mesh.triangle_materials] == name
                uv = mesh.texture_coordinates[mesh.wedge_triangles[chosen]]
                places.append(sorted(map(tuple, numpy.hstack([mesh.positions[mesh.triangles[chosen]].reshape(-1, 3), uv.reshape(-1, 2)]).round(5).tolist())))
            self.assertEqual(places[0], places[1])

    def test_simple_materials(self):
        uv = numpy.zeros((8, 2))
        material = trimesh.visual.material.SimpleMaterial(diffuse=(188, 255, 0), glossiness=7.0)
        box = trimesh.Trimesh(*trimesh_of_box(), process=False, visual=trimesh.visual.TextureVisuals(uv=uv, material=material))
        with self.assertWarnsRegex(UserWarning, '^from_trimesh: leaves out glossiness of material ".*"$'):
            (made,) = occlod.from_trimesh(box).materials
        numpy.testing.assert_allclose(made.base_color, (0.5029, 1, 0, 1), atol=1e-4)  # ((188 / 255 + 0.055) / 1.055) ** 2.4
        plain = trimesh.Trimesh(*trimesh_of_box(), process=False, visual=trimesh.visual.TextureVisuals(uv=uv))
        self.assertEqual(self.silently(occlod.from_trimesh, plain).materials, ())

    def test_what_is_left_out_is_named(self):
        box = trimesh.creation.box()
        box.vertex_attributes["heat"] = numpy.zeros(8)
        box.face_attributes["part"] = numpy.zeros(12)
        with self.assertWarnsRegex(UserWarning, '^from_trimesh: leaves out face attribute "part", vertex attribute "heat"$') as caught:
            occlod.from_trimesh(box)
        self.assertEqual(caught.filename, __file__)
        for thing, name in ((trimesh.PointCloud(numpy.eye(3)), "a trimesh PointCloud"), ([], "a list")):
            with self.assertRaisesRegex(TypeError, f"^from_trimesh: {name} is no mesh of trimesh"):
                occlod.from_trimesh(thing)

    def test_scenes_are_joined(self):
        box = trimesh.creation.box()
        box.visual.face_colors = RED
        scene = trimesh.Scene()
        scene.add_geometry(box, geom_name="box")
        mirror = trimesh.transformations.translation_matrix((5, 0, 0)) @ numpy.diag((-2.0, 2, 2, 1))
        scene.graph.update(frame_to="mirrored", matrix=mirror, geometry="box")
        scene.add_geometry(trimesh.creation.icosphere(subdivisions=1), geom_name="ball", transform=trimesh.transformations.translation_matrix((0, 9, 0)))
        scene.add_geometry(trimesh.load_path(numpy.array([[0, 0, 0], [1, 1, 1.0]])), geom_name="path")
        with self.assertWarnsRegex(UserWarning, '^from_trimesh: leaves out Path3D "path"$'):
            mesh, report = occlod.from_trimesh(scene).clean()
        self.assertEqual((mesh.triangle_count, report.components, report.boundary_edges), (12 + 12 + 80, 3, 0))
        here = trimesh.Trimesh(mesh.positions, mesh.triangles, process=False)
        self.assertAlmostEqual(here.volume, 1 + 8 + scene.geometry["ball"].volume, places=4)  # a mirrored box is not inside out
        numpy.testing.assert_allclose(here.bounds, [[-1, -1, -1], [6, 10, 1]], atol=1e-5)
        white = (mesh.colors[mesh.wedge_triangles] == 255).all(axis=(1, 2))
        numpy.testing.assert_array_equal(white, mesh.positions[mesh.triangles][:, :, 1].min(axis=1) > 5)
        with self.assertRaisesRegex(occlod.Error, "^scene: has no meshes"):
            occlod.from_trimesh(trimesh.Scene())


def trimesh_of_box():
    box = trimesh.creation.box()
    return box.vertices, box.faces


@unittest.skipIf(pyvista is None, "SKIPPED: PyVista is not installed")
class PyVista(InteropTest):
    def test_shapes_and_normals(self):
        mesh = self.silently(occlod.from_pyvista, pyvista.Sphere())
        surface = self.silently(occlod.to_pyvista, mesh)
        self.assertTrue(surface.is_manifold)
        self.assertTrue(numpy.shares_memory(numpy.asarray(surface.points), mesh.positions))
        again = self.silently(occlod.from_pyvista, surface)
        numpy.testing.assert_array_equal(again.triangles, mesh.triangles)
        numpy.testing.assert_array_equal(again.normals, mesh.normals)

    def test_colors(self):
        plane = pyvista.Plane(i_resolution=2, j_resolution=2)
        for name, colors, expected in (("RGB", RED[:3], RED), ("RGBA", BLUE, BLUE), ("tint", RED[:3], RED)):
            plane.point_data.clear()
            plane.point_data[name] = numpy.full((plane.n_points, len(colors)), colors, numpy.uint8)
            mesh = self.silently(occlod.from_pyvista, plane)
            numpy.testing.assert_array_equal(mesh.colors, numpy.full((9, 4), expected))
            numpy.testing.assert_array_equal(occlod.from_pyvista(occlod.to_pyvista(mesh)).colors, mesh.colors)

    def test_texture_coordinates(self):
        mesh, _ = box_of_charts(texture_origin=occlod.TextureOrigin.top_left).clean()
        with self.assertWarnsRegex(UserWarning, '^to_pyvista: leaves out materials "even", "odd"$'):
            there = occlod.to_pyvista(mesh)
        again, _ = self.silently(occlod.from_pyvista, there).clean()
        again.texture_coordinates[:] = again.texture_coordinates * (1, -1) + (0, 1)
        numpy.testing.assert_allclose(again.texture_coordinates[again.wedge_triangles], mesh.texture_coordinates[mesh.wedge_triangles], atol=1e-6)

    def test_any_dataset_with_a_surface(self):
        grid = pyvista.ImageData(dimensions=(3, 3, 3)).cast_to_unstructured_grid()
        mesh, report = self.silently(occlod.from_pyvista, grid).clean()
        self.assertEqual((mesh.triangle_count, report.boundary_edges), (6 * 4 * 2, 0))

    def test_what_is_left_out_is_named(self):
        ball = pyvista.Sphere()
        ball.point_data["heat"], ball.cell_data["part"] = numpy.zeros(ball.n_points), numpy.zeros(ball.n_cells)
        with self.assertWarnsRegex(UserWarning, '^from_pyvista: leaves out point data "heat", cell data "part"$'):
            occlod.from_pyvista(ball)
        with self.assertRaisesRegex(occlod.Error, r"^PolyData: has lines \(1\) and no faces; give a dataset with a surface$"):
            occlod.from_pyvista(pyvista.Line())
        with self.assertRaisesRegex(TypeError, "^from_pyvista: a list is no dataset of PyVista"):
            occlod.from_pyvista([])


@unittest.skipIf(open3d is None, "SKIPPED: Open3D is not installed")
class Open3D(InteropTest):
    def test_shapes_normals_and_colors(self):
        positions, triangles = tetrahedron()
        mesh = occlod.Mesh(positions, triangles, normals=positions - positions.mean(axis=0), colors=numpy.array([RED, BLUE, RED, BLUE], numpy.uint8)).clean()[0]
        for tensor, kind in ((False, open3d.geometry.TriangleMesh), (True, open3d.t.geometry.TriangleMesh)):
            there = self.silently(occlod.to_open3d, mesh, tensor=tensor)
            self.assertIs(type(there), kind)
            again = self.silently(occlod.from_open3d, there)
            for name in ("positions", "triangles", "normals", "colors"):
                numpy.testing.assert_array_equal(getattr(again, name), getattr(mesh, name), name)

    def test_texture_coordinates_and_materials(self):
        mesh, _ = box_of_charts(texture_origin=occlod.TextureOrigin.top_left).clean()
        expected = mesh.texture_coordinates[mesh.wedge_triangles] * (1, -1) + (0, 1)
        for tensor in (False, True):
            with self.assertWarnsRegex(UserWarning, '^to_open3d: leaves out materials "even", "odd"$'):
                there = occlod.to_open3d(mesh, tensor=tensor)
            again, _ = self.silently(occlod.from_open3d, there).clean()
            self.assertEqual((again.vertex_count, again.wedge_count), (mesh.vertex_count, mesh.wedge_count))
            numpy.testing.assert_allclose(again.texture_coordinates[again.wedge_triangles], expected, atol=1e-6)
            numpy.testing.assert_array_equal(again.triangle_materials, mesh.triangle_materials)

    def test_files_read_there_are_as_read_here(self):
        """Open3D and we mean the same v."""
        plain = box_of_charts()
        plain = occlod.Mesh(plain.positions, plain.triangles, texture_coordinates=plain.texture_coordinates).clean()[0]
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "box.obj")
            plain.write(path)
            there, _ = self.silently(occlod.from_open3d, open3d.io.read_triangle_mesh(str(path))).clean()
        self.assertEqual(there.texture_origin, plain.texture_origin)
        there.texture_coordinates[:] = there.texture_coordinates.round(5)
        plain.texture_coordinates[:] = plain.texture_coordinates.round(5)
        self.assertEqual([look[:3] for look in looks_of(there)], [look[:3] for look in looks_of(plain)])

    def test_coordinates_keep_their_digits(self):
        far = numpy.array((691_000.1, 5_335_000.2, 500.3))
        positions, triangles = tetrahedron()
        mesh = occlod.Mesh(positions.astype("f8") + far, triangles)
        self.assertTrue(any(mesh.origin))
        numpy.testing.assert_allclose(numpy.asarray(occlod.to_open3d(mesh).vertices) - far, positions, atol=1e-6)
        numpy.testing.assert_allclose(occlod.to_open3d(mesh, tensor=True).vertex.positions.numpy() - far, positions, atol=1e-6)

    def test_what_is_left_out_is_named(self):
        positions, triangles = tetrahedron()
        mesh = occlod.Mesh(positions, triangles, colors=numpy.full((4, 4), 9, numpy.uint8))
        with self.assertWarnsRegex(UserWarning, "^to_open3d: leaves out alpha of colors$"):
            occlod.to_open3d(mesh)
        there = occlod.to_open3d(occlod.Mesh(positions, triangles), tensor=True)
        there.vertex["heat"] = open3d.core.Tensor(numpy.zeros((4, 1), numpy.float32))
        there.material.material_name = "defaultLit"
        with self.assertWarnsRegex(UserWarning, '^from_open3d: leaves out vertex attribute "heat", the material$'):
            occlod.from_open3d(there)
        older = occlod.to_open3d(occlod.Mesh(positions, triangles))
        older.textures = [open3d.geometry.Image(numpy.zeros((4, 4, 3), numpy.uint8))]
        older.triangle_uvs = open3d.utility.Vector2dVector(numpy.zeros((12, 2)))
        with self.assertWarnsRegex(UserWarning, r"^from_open3d: leaves out textures \(1\)$"):
            occlod.from_open3d(older)
        with self.assertRaisesRegex(TypeError, "^from_open3d: an open3d PointCloud is no mesh of Open3D"):
            occlod.from_open3d(open3d.geometry.PointCloud())


if __name__ == "__main__":
    unittest.main()
