"""Cuts of hierarchies and distances between meshes, with the built command."""
import json
import unittest

from tool_case import TRIANGLES, ToolTest


class Cut(ToolTest):
    def setUp(self):
        super().setUp()
        self.built = self.make_hierarchy()

    def test_triangles(self):
        """Two triangles a split and T / 2 + 2 vertices on a closed surface of genus 0."""
        result = self.json_of("cut", "planet.olod", "--triangles", 501, "-o", "cut.ply")
        self.assert_has_keys(result, "input file vertices triangles full_triangles splits guaranteed_error rms_error")
        self.assertEqual((result["triangles"], result["vertices"], result["full_triangles"]), (500, 252, TRIANGLES))
        self.assertEqual(result["splits"], (500 - self.built["base_triangles"]) / 2)
        self.assertTrue(0 < result["guaranteed_error"] <= self.built["error_bound"])
        self.assertEqual(self.json_of("build", "cut.ply", "-o", "cut.olod")["triangles"], 500)

    def test_error(self):
        allowed = self.built["error_bound"] / 10
        result = self.json_of("cut", "planet.olod", "--error", allowed, "-o", "cut.ply")
        self.assertTrue(0 < result["guaranteed_error"] <= allowed)
        self.assertLess(result["triangles"], TRIANGLES)
        base = self.json_of("cut", "planet.olod", "--error", self.built["error_bound"], "-o", "cut.ply")
        self.assertEqual(base["triangles"], self.built["base_triangles"])

    def test_error_of_the_diagonal(self):
        """As `simplify` takes it: the same number, in %. A hierarchy does not say what its unit is."""
        box = self.json_of("info", "planet.olod")["box"]
        diagonal = sum((b - a) ** 2 for a, b in zip(box["min"], box["max"])) ** 0.5
        cut, same = (self.json_of("cut", "planet.olod", "--error", error, "-o", "cut.ply") for error in ("1%", diagonal / 100))
        self.assertEqual(cut, same)
        self.assertTrue(self.built["base_triangles"] < cut["triangles"] < TRIANGLES)
        self.assertIn("planet.olod: has no unit of length, as only glTF has; give --error as a number",
                      self.failure_of("cut", "planet.olod", "--error", "1mm", "-o", "cut.ply"))

    def test_everything_is_the_input(self):
        result = self.json_of("cut", "planet.olod", "--triangles", TRIANGLES, "-o", "cut.ply")
        self.assertEqual((result["guaranteed_error"], result["rms_error"]), (0, 0))
        self.assertTrue(self.json_of("validate", "planet.olod", "--input", "cut.ply")["valid"])

    def test_mistakes(self):
        self.assertIn("none.olod", self.failure_of("cut", "none.olod", "--triangles", 500, "-o", "cut.ply"))
        self.assertIn("planet.ply", self.failure_of("cut", "planet.ply", "--triangles", 500, "-o", "cut.ply"))
        self.assertIn(str(self.built["base_triangles"]), self.failure_of("cut", "planet.olod", "--triangles", 3, "-o", "cut.ply"))
        self.assertFalse((self.folder / "cut.ply").exists())
        for size in ([], ["--triangles", 500, "--error", 1], ["--triangles", 0], ["--triangles", -5], ["--error", -1], ["--error", "nan"],
                     ["--error", "inf"]):
            done = self.run_tool("cut", "planet.olod", *size, "-o", "cut.ply")
            self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), size)


class Compare(ToolTest):
    WAY = "rms rms_percent max max_percent max_at"

    def compare(self, *arguments):
        return self.json_of("compare", *arguments, "--samples", 5000)

    def write_square(self, name, z, size=1):
        self.folder.joinpath(name).write_text(f"OFF\n4 1 0\n0 0 {z}\n{size} 0 {z}\n{size} {size} {z}\n0 {size} {z}\n4 0 1 2 3\n")

    def test_report(self):
        """Squares 0.5 apart: every distance is 0.5, and A's diagonal is the root of 2."""
        self.write_square("a.off", 0)
        self.write_square("b.off", 0.5)
        result = self.compare("a.off", "b.off", "--seed", 3)
        self.assert_has_keys(result, "a b samples seed diagonal a_to_b b_to_a " + self.WAY)
        self.assertEqual((result["a"], result["b"], result["samples"], result["seed"]), ("a.off", "b.off", 5000, 3))
        self.assertAlmostEqual(result["diagonal"], 2**0.5)
        for way in (result, result["a_to_b"], result["b_to_a"]):
            self.assert_has_keys(way, self.WAY)
            for key in ("rms", "max"):
                self.assertAlmostEqual(way[key], 0.5)
                self.assertAlmostEqual(way[key + "_percent"], 50 / 2**0.5)
        self.assertAlmostEqual(result["b_to_a"]["max_at"][2], 0.5)

    def test_ways_differ(self):
        """The corner (2, 2) of the larger square is the root of 2 from the smaller one; that lies in the larger."""
        self.write_square("small.off", 0)
        self.write_square("large.off", 0, 2)
        result = self.compare("small.off", "large.off")
        self.assertLess(result["a_to_b"]["max"], 1e-12)
        self.assertAlmostEqual(result["b_to_a"]["max"], 2**0.5)
        self.assertEqual(result["b_to_a"]["max_at"], [2, 2, 0])
        for key in self.WAY.split():
            self.assertEqual(result[key], result["b_to_a"][key], key)

    def test_promise_of_a_cut_holds(self):
        built = self.make_hierarchy()
        self.assertLess(self.compare("planet.ply", "planet.olod")["max"], 1e-12)
        for size in (["--triangles", 500], ["--error", built["error_bound"] / 10]):
            cut = self.json_of("cut", "planet.olod", *size, "-o", "cut.ply")
            measured = self.compare("planet.olod", "cut.ply")
            self.assertTrue(0 < measured["rms"] < measured["max"] <= cut["guaranteed_error"], (size, measured))

    def test_is_reproducible(self):
        self.make_planet("a.ply", 1)
        self.make_planet("b.ply", 2)
        runs = [self.succeed("compare", "a.ply", "b.ply", "--samples", 1000, "--seed", seed, "--json") for seed in (1, 1, 2)]
        self.assertEqual(runs[0], runs[1])
        self.assertNotEqual(json.loads(runs[0])["rms"], json.loads(runs[2])["rms"])

    def test_text_and_help(self):
        self.write_square("a.off", 0)
        lines = self.succeed("compare", "a.off", "a.off").splitlines()
        self.assertEqual([line[:6] for line in lines[1:]], ["a to b", "b to a", "larger"])
        self.assertIn("GPL", self.succeed("compare", "--help"))

    def write_colored_square(self, name, red):
        header = "ply\nformat ascii 1.0\nelement vertex 4\n" + "".join(f"property float {axis}\n" for axis in "xyz")
        header += "".join(f"property uchar {channel}\n" for channel in ("red", "green", "blue"))
        corners = "".join(f"{x} {y} 0 {red} 0 0\n" for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)))
        self.folder.joinpath(name).write_text(
            f"{header}element face 1\nproperty list uchar int vertex_indices\nend_header\n{corners}4 0 1 2 3\n")

    def test_colors(self):
        """One of three channels differs by 51 / 255 = 0.2 everywhere."""
        self.write_colored_square("dark.ply", 51)
        self.write_colored_square("bright.ply", 102)
        result = self.compare("dark.ply", "bright.ply")
        for key in ("rms", "max"):
            self.assertAlmostEqual(result["colors"][key], 0.2 / 3**0.5)
        self.assertFalse({"texture_slip", "normals_deg"} & result.keys())
        self.assertIn("\ncolors ", self.succeed("compare", "dark.ply", "bright.ply"))

    def write_textured_square(self, name, shift):
        places = ((0, 0), (1, 0), (1, 1), (0, 1))
        self.folder.joinpath(name).write_text("".join(
            [f"v {x} {y} 0\n" for x, y in places] + [f"vt {x + shift} {y}\n" for x, y in places] + ["f 1/1 2/2 3/3 4/4\n"]))

    def test_texture_slip(self):
        """The texture is 0.05 further left: 0.05 of the unit, and 5 / sqrt(2) % of the diagonal, everywhere."""
        self.write_textured_square("a.obj", 0)
        self.write_textured_square("b.obj", 0.05)
        result = self.compare("a.obj", "b.obj")
        slip = result["texture_slip"]
        self.assert_has_keys(slip, self.WAY + " lost search_radius")
        for key in ("rms", "max"):
            self.assertAlmostEqual(slip[key], 0.05, 6)
            self.assertAlmostEqual(slip[key + "_percent"], 5 / 2**0.5, 4)
        self.assertEqual(slip["lost"], 0)
        self.assertLess(self.compare("a.obj", "a.obj")["texture_slip"]["max"], 1e-9)
        self.assertIn("\ntexture ", self.succeed("compare", "a.obj", "b.obj"))

    def test_texture_that_is_not_there_is_lost(self):
        self.write_textured_square("a.obj", 0)
        self.write_textured_square("b.obj", 5)
        slip = self.compare("a.obj", "b.obj")["texture_slip"]
        self.assertEqual(slip["lost"], 5000)
        self.assertAlmostEqual(slip["rms"], slip["search_radius"])
        self.assertAlmostEqual(slip["search_radius"], 0.1 * 2**0.5)
        self.assertIn("200000 of 200000", self.succeed("compare", "a.obj", "b.obj"))

    def test_mistakes(self):
        self.write_square("a.off", 0)
        (self.folder / "text.olod").write_text("not a hierarchy")
        self.assertIn("none.ply", self.failure_of("compare", "a.off", "none.ply"))
        self.assertIn("none.ply", self.failure_of("compare", "none.ply", "a.off", "--json"))
        self.assertIn("text.olod", self.failure_of("compare", "a.off", "text.olod"))
        for arguments in ([], ["a.off"], ["a.off", "a.off", "a.off"], ["a.off", "a.off", "--samples", 0], ["a.off", "a.off", "--samples", "x"]):
            done = self.run_tool("compare", *arguments)
            self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), arguments)


class WithoutCgal(ToolTest):
    def test_commands_say_why_they_are_not_there(self):
        for command in ("compare", "repair"):
            for arguments in ([], ["a.off", "b.off"], ["a.off", "-o", "b.off", "--json"]):
                line = self.failure_of(command, *arguments)
                self.assertIn(command, line)
                self.assertIn("OCCLOD_WITH_CGAL", line)


if __name__ == "__main__":
    unittest.main(verbosity=1)
