"""`occlod simplify` with the built command."""
import unittest

from tool_case import TRIANGLES, ToolTest


class Simplify(ToolTest):
    def setUp(self):
        super().setUp()
        self.make_planet()

    def test_ratio_and_triangles(self):
        for option, value, most in (("--ratio", "10%", TRIANGLES // 10), ("--ratio", 0.25, TRIANGLES // 4), ("--triangles", 300, 300)):
            result = self.json_of("simplify", "planet.ply", "-o", "small.ply", option, value)
            self.assert_has_keys(result, "input file full_triangles triangles vertices read_ms simplify_ms write_ms peak_bytes report")
            self.assertEqual(result["full_triangles"], TRIANGLES)
            self.assertLessEqual(result["triangles"], most)
            self.assertGreater(result["triangles"], most - 3)
            self.assertEqual(self.json_of("info", "small.ply")["triangles"], result["triangles"])

    def test_something_is_left(self):
        self.succeed("simplify", "planet.ply", "-o", "small.ply", "--ratio", "0.0001")
        self.assertEqual(self.json_of("info", "small.ply")["triangles"], 4)
        told = self.failure_of("simplify", "planet.ply", "-o", "none.ply", "--triangles", 1)
        self.assertIn(f"mesh: has nothing left with at most 1 of its {TRIANGLES} triangles; allow more", told)
        self.assertFalse((self.folder / "none.ply").exists())

    def test_a_hierarchy_cut_to_as_many_is_farther(self):
        """Because its vertices stay on those of the input."""
        self.succeed("build", "planet.ply", "-o", "planet.olod")
        self.succeed("cut", "planet.olod", "--triangles", 400, "-o", "cut.ply")
        self.succeed("simplify", "planet.ply", "--triangles", 400, "-o", "small.ply")
        cut, small = (self.json_of("compare", "planet.ply", name)["rms"] for name in ("cut.ply", "small.ply"))
        self.assertLess(small, 0.85 * cut)

    def test_error_holds_as_another_program_measures_it(self):
        diagonal = self.json_of("compare", "planet.ply", "planet.ply")["diagonal"]
        for error, allowed in (("0.02", 0.02), ("1%", diagonal / 100)):
            result = self.json_of("simplify", "planet.ply", "-o", "small.ply", "--error", error)
            self.assertLess(result["triangles"], TRIANGLES)
            self.assertLessEqual(result["distance"], allowed)
            largest = self.json_of("compare", "planet.ply", "small.ply", "--samples", 100_000)["max"]
            self.assertLessEqual(largest, 1.0001 * allowed)
            self.assertGreater(largest, 0.5 * allowed)

    def test_units_are_those_of_gltf(self):
        self.succeed("simplify", "planet.ply", "-o", "planet.glb", "--ratio", 1)
        counts = {self.json_of("simplify", "planet.glb", "-o", "small.glb", "--error", error)["triangles"] for error in ("20mm", "2cm", "0.02m", 0.02)}
        self.assertEqual(len(counts), 1)
        self.assertIn("planet.ply: has no unit of length", self.failure_of("simplify", "planet.ply", "-o", "small.ply", "--error", "20mm"))

    def test_several_meshes_go_into_a_folder_and_one_that_fails_stops_none(self):
        self.make_planet("other.ply", seed=2)
        (self.folder / "bad.ply").write_text("ply\n")
        done = self.run_tool("simplify", "planet.ply", "bad.ply", "other.ply", "-o", "small", "--ratio", "10%")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"(?s)^occlod: error: bad\.ply: .*1 of 3 meshes failed")
        for name in ("planet.ply", "other.ply"):
            self.succeed("simplify", name, "-o", "alone.ply", "--ratio", "10%")
            self.assertTrue(self.same_bytes("alone.ply", f"small/{name}"))
        self.assertFalse((self.folder / "small" / "bad.ply").exists())
        result = self.json_of("simplify", "planet.ply", "other.ply", "-o", "small", "--triangles", 100)
        self.assertEqual([mesh["triangles"] for mesh in result["meshes"]], [100, 100])

    def test_wrong_use(self):
        for options, words in ((["--ratio", "110%"], "not a share above 0"), (["--ratio", 0], "not a share above 0"),
                               (["--error", "-1"], "not a length above 0"), (["--error", "1km"], "not a length above 0"),
                               (["--error", "nan"], "not a length above 0"), ([], "--triangles, --ratio or --error"),
                               (["--ratio", 0.5, "--triangles", 5], "excludes"), (["--triangles", 0], "--triangles")):
            done = self.run_tool("simplify", "planet.ply", "-o", "small.ply", *options)
            self.assertEqual(done.returncode, 2, options)
            self.assertIn(words, done.stderr, options)
        self.make_planet("other.ply", seed=2)
        self.assertIn("planet.ply: is no folder", self.failure_of("simplify", "planet.ply", "other.ply", "-o", "planet.ply", "--ratio", 0.5))


if __name__ == "__main__":
    unittest.main()
