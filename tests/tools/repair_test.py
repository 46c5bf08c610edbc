"""`occlod repair` with the built command, and what `build` and `info` say about meshes that it would change."""
import unittest

from tool_case import ToolTest

SQUARE = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
SOUND = SQUARE + "3 0 1 2\n3 0 2 3\n"
TURNED = SQUARE + "3 0 1 2\n3 0 3 2\n"  # both run from 0 to 2 or both back: one inconsistent edge


class Repair(ToolTest):
    def write(self, name, text):
        (self.folder / name).write_text(text)

    def test_report(self):
        """One of two triangles is turned; nothing else is to be done to a square."""
        self.write("a.off", TURNED)
        result = self.json_of("repair", "a.off", "-o", "b.ply")
        self.assert_has_keys(result, "input file orientable changes before after after_welding report repair_ms")
        self.assertEqual((result["input"], result["file"], result["orientable"]), ("a.off", "b.ply", True))
        self.assertEqual({key: count for key, count in result["changes"].items() if count}, {"triangles_turned": 1, "borders_left": 1})
        self.assertEqual((result["before"]["inconsistent_edges"], result["after"]["inconsistent_edges"]), (1, 0))
        self.assertEqual((result["after"]["vertices"], result["after"]["triangles"]), (4, 2))
        built = self.json_of("build", "b.ply", "-o", "b.olod")
        self.assertEqual(built["report"]["inconsistent_edges"], 0)
        self.assertTrue(self.json_of("validate", "b.olod", "--input", "b.ply")["valid"])

    def test_text(self):
        self.write("a.off", TURNED)
        lines = self.succeed("repair", "a.off", "-o", "b.off").splitlines()
        self.assertIn(["triangles_turned", "1"], [line.split() for line in lines])
        self.assertIn(["inconsistent_edges", "1", "0", "0"], [line.split() for line in lines])

    def test_moebius_band_says_so(self):
        """Three squares in a ring, the last one joined upside down."""
        self.write("a.off", "OFF\n6 3 0\n1 0 0\n0 1 0\n-1 0 0\n1 0 1\n0 1 1\n-1 0 1\n4 0 1 4 3\n4 1 2 5 4\n4 2 3 0 5\n")
        result = self.json_of("repair", "a.off", "-o", "b.off")
        self.assertEqual((result["orientable"], result["changes"]["unorientable_edges"]), (False, 1))
        # Copies at one place are one vertex for whoever welds: the band is a band again.
        self.assertEqual((result["after"]["inconsistent_edges"], result["after_welding"]["inconsistent_edges"]), (0, 1))
        self.assertIn("cannot be oriented", self.succeed("repair", "a.off", "-o", "b.off"))

    def test_options_are_used(self):
        """A gap of 0.001 between two triangles; a square of four triangles of which one is missing."""
        self.write("gap.off", "OFF\n6 2 0\n0 0 0\n1 0 0\n0 1 0\n1.001 0 0\n1 1 0\n0 1.001 0\n3 0 1 2\n3 3 4 5\n")
        self.assertEqual(self.json_of("repair", "gap.off", "-o", "b.off")["after"]["vertices"], 6)
        self.assertEqual(self.json_of("repair", "gap.off", "-o", "b.off", "--weld", 0.01)["after"]["vertices"], 4)
        self.write("hole.off", "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n")
        self.assertEqual(self.json_of("repair", "hole.off", "-o", "b.off")["after"]["boundary_edges"], 3)
        filled = self.json_of("repair", "hole.off", "-o", "b.off", "--fill-holes", 3)
        self.assertEqual((filled["changes"]["holes_filled"], filled["after"]["boundary_edges"]), (1, 0))

    def test_is_reproducible(self):
        self.make_planet()
        for name in ("a.ply", "b.ply"):
            self.succeed("repair", "planet.ply", "-o", name)
        self.assertTrue(self.same_bytes("a.ply", "b.ply"))

    def test_mistakes(self):
        self.assertIn("none.ply", self.failure_of("repair", "none.ply", "-o", "b.off"))
        self.write("line.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n")
        self.assertIn("line.off: nothing is left", self.failure_of("repair", "line.off", "-o", "b.off", "--json"))
        self.write("a.off", SOUND)
        self.assertIn("b.xyz", self.failure_of("repair", "a.off", "-o", "b.xyz"))
        self.assertFalse((self.folder / "b.off").exists())
        for options in (["--weld", -1], ["--weld", "nan"], ["--weld", "x"], ["--fill-holes", -1], ["--fill"]):
            done = self.run_tool("repair", "a.off", "-o", "b.off", *options)
            self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), options)

    def test_help_names_the_licence(self):
        self.assertIn("GPL", self.succeed("repair", "--help"))


class Advice(ToolTest):
    def test_says_when_a_repair_would_help(self):
        (self.folder / "sound.off").write_text(SOUND)
        (self.folder / "turned.off").write_text(TURNED)
        for name, command in (("sound", []), ("turned", ["1 inconsistent edges"])):
            built = self.json_of("build", f"{name}.off", "-o", f"{name}.olod")
            for file in (f"{name}.off", f"{name}.olod"):
                told = self.json_of("info", file)
                self.assertEqual(told.get("advice"), built.get("advice"))
                self.assertEqual(told["report"], built["report"])
            self.assertEqual("advice" in built, bool(command))
            for fault in command:
                self.assertIn(fault, built["advice"])
        self.assertIn("occlod repair", self.succeed("info", "turned.off"))


if __name__ == "__main__":
    unittest.main(verbosity=1)
