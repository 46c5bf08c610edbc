"""What notebooks show: pictures and counts of objects, and bars of progress."""
import base64
import io
import pathlib
import re
import tempfile
import unittest

import numpy
import occlod
from packages import tqdm
from support import VIEW, box_of_charts, planet
from test_documents import read_png

UTM = numpy.array((691607.37, 5334760.81, 519.93))


class Shown(unittest.TestCase):
    def assert_shown(self, thing, *counts):
        """A thing in the middle of its picture and nothing at its corners, and its counts."""
        png = thing._repr_png_()
        pixels = read_png(png)
        self.assertEqual(pixels.shape, (300, 400, 4))
        rows = abs(pixels[:, 200, :3] - pixels[:, 0, :3]).max(axis=1)  # beside the background, a vertical gradient
        self.assertGreater((rows[100:200] > 8).mean(), 0.8)
        self.assertEqual((rows[:3].max(), rows[-3:].max()), (0, 0))
        html = thing._repr_html_()
        (data,) = re.findall(r'<img src="data:image/png;base64,([^"]+)"', html)
        self.assertEqual(base64.b64decode(data)[:4], png[:4])
        for count in counts:
            self.assertIn(count, html)

    def test_meshes(self):
        self.assert_shown(planet(4)[0], "occlod.Mesh: 1,026 vertices, 2,048 triangles")
        self.assert_shown(box_of_charts().clean()[0], "486 wedges")
        near = planet(4)[0]
        self.assert_shown(occlod.Mesh(near.positions + UTM, near.triangles), "2,048 triangles")

    def test_hierarchies(self):
        self.assert_shown(planet(4)[1], "occlod.Hierarchy: 1,026 vertices, 2,048 triangles", " splits")

    def test_hlods_paged_or_not(self):
        hlod = occlod.build_hlod(planet(4)[0], node_triangles=200)
        counts = f"occlod.Hlod: 2,048 triangles, {hlod.node_count} nodes, {hlod.level_count} levels"
        self.assert_shown(hlod, counts)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.ohlod")
            hlod.write(path)
            self.assert_shown(occlod.open_hlod(path), counts)

    def test_what_cannot_be_drawn_has_counts_only(self):
        nothing = occlod.Mesh.empty(0, 0)
        self.assertIsNone(nothing._repr_png_())
        self.assertEqual(nothing._repr_html_(), "<div><div>occlod.Mesh: 0 vertices, 0 triangles</div></div>")
        broken = planet(2)[0]
        broken.triangles[0] = 100_000
        self.assertIsNone(broken._repr_png_())

    def test_images(self):
        image = occlod.picture(planet(2)[0], occlod.Camera(eye=(0, 0, 3), width=40, height=30))
        numpy.testing.assert_array_equal(read_png(occlod.show(image)._repr_png_()), image)


class Progress(unittest.TestCase):
    """What is told grows and ends at 1."""

    def assert_ends(self, build):
        shares = []
        build(shares.append)
        self.assertEqual(shares, sorted(shares))
        self.assertEqual(shares[-1], 1.0)
        if tqdm is None:
            return
        with tqdm.tqdm(total=1, file=io.StringIO()) as bar:
            build(lambda done: bar.update(done - bar.n))
            self.assertAlmostEqual(bar.n, 1)

    def test_builds(self):
        mesh, hierarchy = planet(4)
        tiny, _ = planet(0)
        self.assert_ends(lambda progress: occlod.build_hierarchy(mesh, progress=progress))
        self.assert_ends(lambda progress: occlod.build_hierarchy(tiny, progress=progress))
        self.assert_ends(lambda progress: occlod.build_hierarchy(mesh, error_bound=occlod.ErrorBound.measured, progress=progress))
        for more in ({}, {"node_triangles": 64}, {"within": occlod.Within.splits}, {"grouping": occlod.Grouping.nested}):
            self.assert_ends(lambda progress, more=more: occlod.build_hlod(mesh, progress=progress, **more))
        self.assert_ends(lambda progress: occlod.build_hlod(tiny, progress=progress))
        cell = occlod.CellOptions(eyes=occlod.eye_model(VIEW))
        options = occlod.CellTreeOptions([occlod.CellBox((-0.4, -0.4, 2), (0.4, 0.4, 2.2))], cell=cell, root_cell=0.4, smallest_cell=0.4)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.vlod")
            self.assert_ends(lambda progress: occlod.CellBuild(hierarchy, options).write(path, progress=progress))

    def test_files_and_simplify(self):
        mesh, _ = planet(4)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "a.ply")
            mesh.write(path)
            self.assert_ends(lambda progress: occlod.read_mesh(path, progress))
            for goal in ({"triangles": 100}, {"ratio": 1.0}, {"error": 0.05}):
                for what in (mesh, path):
                    self.assert_ends(lambda progress, goal=goal, what=what: occlod.simplify(what, progress=progress, **goal))
            self.assert_ends(lambda progress: occlod.write_tiles(path, path.with_name("tiles"), replace=True, progress=progress))


if __name__ == "__main__":
    unittest.main()
