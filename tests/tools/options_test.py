"""What options take: every bad value of every numeric option of every command is refused as wrong use, in one line that names the option, the value
and what is allowed, before any file is looked at: there are none here."""
import itertools
import re
import unittest

from tool_case import ToolTest

ELEMENTS = 2**32 - 1
SEEDS = 2**64 - 1
MESH_SEEDS = 2**53 - 1
LARGEST = 10**12

# Command without the option, option, smallest and largest value. None: any finite number.
BUILD, CUT, COMPARE = ["build", "a.ply", "-o", "a.olod"], ["cut", "a.olod", "-o", "a.ply"], ["compare", "a.ply", "b.ply"]
SIMPLIFY = ["simplify", "a.ply", "-o", "b.ply"]
REPAIR, VALIDATE, RENDER = ["repair", "a.ply", "-o", "b.ply"], ["validate", "a.olod"], ["render", "a.olod"]
CLUSTERS = ["hlod", "build", "a.ply", "-o", "a.glb"]
HLOD_BUILD, HLOD_VALIDATE = ["hlod", "build", "a.ply", "-o", "a.ohlod"], ["hlod", "validate", "a.ohlod"]
TILES = ["tiles", "a.ply", "-o", "a"]
HLOD_RENDER = ["hlod", "render", "a.ohlod"]
CELLS_VALIDATE, CELLS_WALK = ["cells", "validate", "a.vlod", "a.json"], ["cells", "walk", "a.vlod", "a.json", "--path", "p"]
CELLS_BUILD, CELLS_INFO, CELLS_MERGE = ["cells", "build", "a.json", "-o", "a.vlod"], ["cells", "info", "a.vlod"], ["cells", "merge", "parts", "-o", "a.vlod"]
CELLS_PACK = ["cells", "pack", "a.vlod", "a.json", "-o", "b.vlod"]
FRAMES = ["render", "a.json", "--path", "p", "--frame-to-frame"]
WHOLE = [
    (BUILD, "--base-triangles", 0, ELEMENTS),
    (BUILD, "--threads", 0, 1024),
    (CUT, "--triangles", 1, ELEMENTS),
    (VALIDATE, "--cuts", 0, 10**6),
    (HLOD_BUILD, "--node-triangles", 16, 4096),
    (HLOD_BUILD, "--threads", 0, 1024),
    (CLUSTERS, "--clusters", 32, 256),
    (HLOD_BUILD, "--quantise", 0, 23),
    (HLOD_VALIDATE, "--fronts", 0, 10**6),
    (TILES, "--tiles-per-file", 1, 10**6),
    (TILES, "--node-triangles", 16, 4096),
    (TILES, "--quantise", 0, 16),
    (TILES, "--threads", 0, 1024),
    *((HLOD_RENDER, option, low, 10**6) for option, low in (("--frames", 1), ("--reference", 0))),
    (CELLS_BUILD, "--budget", 1, LARGEST),
    (CELLS_BUILD, "--max-triangles", 0, LARGEST),
    (CELLS_BUILD, "--threads", 0, 1024),
    (CELLS_VALIDATE, "--cells", 1, 10**6),
    (CELLS_VALIDATE, "--eyes", 0, 10**6),
    (CELLS_VALIDATE, "--image-size", 1, 8192),
    (CELLS_VALIDATE, "--seed", 0, SEEDS),
    (CELLS_VALIDATE, "--threads", 0, 1024),
    (CELLS_WALK, "--reference", 0, 10**6),
    (RENDER, "--budget", 1, LARGEST),
    (RENDER, "--threads", 0, 1024),
    (RENDER, "--repeat", 1, 10**6),
    (FRAMES, "--max-changes", 0, LARGEST),
    (FRAMES, "--geomorph-frames", 0, 10**6),
]
REAL = [
    (BUILD, "--boundary-weight", 0, 10**6),
    (BUILD, "--attribute-weight", 0, 10**6),
    (BUILD, "--crease", 0, 180),
    (CELLS_BUILD, "--tolerance", 1e-6, None),
    (CELLS_BUILD, "--root-cell", 1e-6, LARGEST),
    (CELLS_BUILD, "--smallest-cell", 1e-6, LARGEST),
    (HLOD_RENDER, "--tolerance", 0, None),
    (RENDER, "--tolerance", 0, None),
    (FRAMES, "--time-limit", 0, None),
]
WITH_CGAL = ([(COMPARE, "--samples", 1, 10**9), (COMPARE, "--seed", 0, SEEDS), (REPAIR, "--fill-holes", 0, ELEMENTS)], [(REPAIR, "--weld", 0, None)])


# Of each kind of mesh: option, smallest and largest value.
GENERATORS = {
    "rough-planet": [("level", 0, 11), ("octaves", 0, 30), ("seed", 0, MESH_SEEDS), ("amplitude", 0, 0.99), ("frequency", 0, 10**6)],
    "city": [("blocks", 1, 256), ("facade_cells", 1, 256), ("seed", 0, MESH_SEEDS)],
    "pipes": [("pipes", 1, 10**6), ("bends", 1, 10**5), ("sides", 3, 4096), ("seed", 0, MESH_SEEDS)],
    "plant": [("storeys", 1, 64), ("bays", 1, 256), ("pipes", 1, 10**4), ("bends", 1, 10**5), ("sides", 3, 4096), ("seed", 0, MESH_SEEDS)],
    "spheres-behind-wall": [("spheres", 1, 10**6), ("level", 0, 8), ("wall_cells", 1, 4096), ("seed", 0, MESH_SEEDS)],
}


class Options(ToolTest):
    def assert_refused(self, command, option, value, *allowed):
        """`--option=` with nothing behind it would take the next word."""
        done = self.run_tool(*command, option, value)
        told = f"{command} {option} {value!r}: exit {done.returncode}, {done.stderr}"
        self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), told)
        self.assertTrue(done.stderr.startswith(f'occlod: error: {option}: "{value}" '), told)
        self.assertIn("--help", done.stderr)
        for part in allowed:
            self.assertIn(str(part), done.stderr, told)
        self.assertEqual([digits for digits in re.findall(r"\d+", done.stderr.replace(str(value), "")) if len(digits) > 20], [], told)

    def has_cgal(self):
        return self.run_tool("compare", "--help").returncode == 0 and "GPL" in self.run_tool("compare", "--help").stdout

    def rows(self, index):
        return (WHOLE, REAL)[index] + (WITH_CGAL[index] if self.has_cgal() else [])

    def test_whole_numbers(self):
        for command, option, low, high in self.rows(0):
            bounds = [low] if high == SEEDS else [low, high]
            for value in ("", "x", "-1", "1.5", "1e3", "nan", "inf", "0x10", "+1", " 1", "1 ", high + 1, 10**30, *([low - 1] if low > 0 else [])):
                self.assert_refused(command, option, value, *bounds)

    def test_real_numbers(self):
        for command, option, low, high in self.rows(1):
            bounds = [low] if high is None else [low, high]
            for value in ("", "x", "nan", "-nan", "inf", "-inf", "1e999", "-1", "-1e-300", "1,5", *([high + 1e-3, 1e300] if high is not None else [])):
                self.assert_refused(command, option, value, *bounds)

    def test_other_values(self):
        for value in ("", "3", "0x3", "3x0", "-3x3", "3x3x3", "16385x3", "3x16385", "99999999999x3", "axb", "3 x 3"):
            for command in (RENDER, HLOD_RENDER):
                self.assert_refused(command, "--size", value, "1x1", "16384x16384")
        for option, values in (("--image", ("", "640x480", "640x480,60", "0x480,60,0.1", "640x480,180,0.1", "640x480,0,0.1", "640x480,60,0", "640x480,60,nan", "640x480,60,0.1,2")),
                               ("--region", ("", "1,2,3", "0,0,0,1,1", "0,0,0,1,1,x", "0,0,0,1,inf,1", "0,0,2,1,1,1", "0,0,0,1,1,1,1")),
                               ("--shard", ("", "1", "0/3", "4/3", "1/0", "-1/3", "1/3x", "1/1000001"))):
            for value in values:
                self.assert_refused(CELLS_BUILD, option, value)
        for value in ("", "x", "-1", "1.5", "1,2", "1,2,x", "1,2,nan", "1,2,3,4", 2**32):
            self.assert_refused(CELLS_INFO, "--cell", value, ELEMENTS, "X,Y,Z")
        for value in ("", "x", "-1", "0", "0M", "1.5", "1e3", "nan", "0x10", "+1", " 1", "1 ", "M", "1T", "1KB", 2**64, f"{2**34}G", 10**30):
            for command, least in ((HLOD_RENDER, "1"), (CELLS_WALK, "1"), (HLOD_BUILD, "64M"), (TILES, "64M")):
                self.assert_refused(command, "--memory", value, "number of bytes", least)
        for value in ("", "x", "-1", "-0", "nan", "inf", "1e999", "1km", "1 %", "%", "1mm%"):
            self.assert_refused(CUT, "--error", value, "a length of at least 0")
            self.assert_refused(SIMPLIFY, "--error", value, "a length above 0")
        for value in ("0", "0%", "0mm"):
            self.assert_refused(SIMPLIFY, "--error", value, "a length above 0")
        for value in ("geomorph ", "yes", ""):
            self.assert_refused(HLOD_RENDER, "--within", value, "none, geomorph, splits")
        for value in ("", "x", "Async", "async ", "blocking:1", "simulated:1"):
            self.assert_refused([*HLOD_RENDER, "--memory", "1M"], "--load", value, "blocking", "async")

    def test_what_generators_take(self):
        for kind, options in GENERATORS.items():
            command = ["generate", kind, "-o", "a.ply"]
            text = self.succeed("generate", "--help")
            for option, low, high in options:
                is_real = option in ("amplitude", "frequency")
                for value in ("", "x", "-1", "nan", "inf", "1e999", *([] if is_real else ["0x10", "1.5", "1e3", "+1"]), high + (1e-3 if is_real else 1), *([low - 1] if low > 0 else [])):
                    done = self.run_tool(*command, f"{option}={value}")
                    self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), done.stderr)
                    self.assertTrue(done.stderr.startswith(f'occlod: error: {option}: "{value}" '), done.stderr)
                    for bound in (low, high):
                        self.assertIn(str(bound), done.stderr)
                self.assertIn(f"{option}=", text)
            for wrong in ("", "what=1", "what", "--level"):
                done = self.run_tool(*command, wrong)
                self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), done.stderr)
                if not wrong.startswith("-"):
                    self.assertIn(f'"{wrong.split("=")[0]}" of {kind} is not one of ', done.stderr)
                    for option, _, _ in options:
                        self.assertIn(option, done.stderr)
            done = self.run_tool(*command, "seed=1", "seed=2")
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn("seed is given more than once", done.stderr)

    def test_options_of_the_program(self):
        """Before and after the command, and refused where nothing reads them."""
        self.make_planet()
        text = self.succeed("--json", "info", "planet.ply")
        self.assertEqual(text, self.succeed("info", "planet.ply", "--json"))
        self.succeed("--threads", 1, "build", "planet.ply", "-o", "a.olod")
        self.succeed("build", "planet.ply", "-o", "b.olod", "--threads", 0, "--progress", "never")
        self.assertTrue(self.same_bytes("a.olod", "b.olod"))
        for command, option in ((["info", "planet.ply"], ["--threads", 2]), (["info", "planet.ply"], ["--no-cache"]), (["cut", "a.olod", "-o", "a.ply", "--error", 1], ["--no-cache"]),
                                (["cells", "info", "a.vlod"], ["--threads", 0]), (["hlod", "info", "a.ohlod"], ["--no-cache"]), (["validate", "a.olod"], ["--progress", "always"])):
            words = " ".join(command[:2] if command[0] in ("cells", "hlod") else command[:1])
            for arguments in ([*command, *option], [*option, *command]):
                done = self.run_tool(*arguments)
                self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), done.stderr)
                self.assertIn(f"{option[0]} is not used by occlod {words}", done.stderr)
        self.assertIn("--threads", self.succeed("build", "--help"))

    def test_names_that_are_empty(self):
        for command, option in ((BUILD[:2], "--output"), (CUT[:2] + ["--triangles", 5], "--output"), (["generate", "city"], "--output"), (VALIDATE, "--input"),
                                (HLOD_BUILD[:3], "--output"), (HLOD_VALIDATE, "--input"),
                                (CELLS_BUILD[:3], "--output"), (CELLS_BUILD, "--work"), (CELLS_WALK[:4], "--path"), (CELLS_WALK, "--png"), (CELLS_MERGE[:3], "--output"), (CELLS_PACK[:4], "--output"),
                                *((HLOD_RENDER, option) for option in ("--scene", "--camera", "--path", "--device", "--png")),
                                *((RENDER, option) for option in ("--camera", "--path", "--png", "--birdseye", "--mesh", "--calibration", "--save-calibration"))):
            self.assert_refused(command, option, "")
        for command in (["info", ""], ["build", "", "-o", "a.olod"], ["validate", ""], ["render", ""], ["hlod", "info", ""], ["hlod", "validate", ""], ["hlod", "render", ""], ["hlod", "build", "", "-o", "a.ohlod"],
                        ["cells", "build", "", "-o", "a.vlod"], ["cells", "info", ""], ["cells", "merge", "", "-o", "a.vlod"], ["cells", "pack", "", "a.json", "-o", "b.vlod"],
                        ["cut", "", "-o", "a.ply", "--triangles", 5]):
            self.assertEqual(self.run_tool(*command).returncode, 2, command)

    def test_options_are_not_taken_for_names_of_files(self):
        for command, option in ((BUILD[:2], "-o"), (RENDER, "--png"), (RENDER, "--mesh"), (VALIDATE, "--input")):
            done = self.run_tool(*command, option, "--json")
            self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), done.stderr)
            self.assertIn('"--json" looks like an option; write ./--json', done.stderr)
        self.make_planet()
        self.succeed("build", "planet.ply", "-o", "./--json.olod")
        self.assertTrue((self.folder / "--json.olod").exists())

    def test_ends_of_ranges_are_taken(self):
        """What is allowed gets as far as the file that is not there."""
        for command, option, low, high in itertools.chain(self.rows(0), self.rows(1)):
            for value in (low, high if high is not None else 1e300):
                arguments = [*command, option, value]
                done = self.run_tool(*arguments)
                self.assertEqual(done.returncode, 1, f"{arguments}: {done.stderr}")

    def test_ends_of_memory_are_taken(self):
        for memory, load in ((1, "async"), (2**64 - 1, "blocking"), ("17179869183G", "async")):
            done = self.run_tool(*HLOD_RENDER, "--memory", memory, "--load", load)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)

    def test_every_numeric_option_is_here(self):
        """Help shows what a number is with N."""
        rows = {(row[0][0], row[0][1] if row[0][0] in ("cells", "hlod") else "", row[1]) for row in self.rows(0) + self.rows(1)}
        commands = ["build", "cut", "generate", "info", "validate", "render", "tiles", *(["compare", "repair"] if self.has_cgal() else [])]
        hlod, cells = ["build", "info", "validate", "render"], ["build", "info", "merge", "pack", "validate", "walk"]
        for command, kind in [(command, "") for command in commands] + [("hlod", kind) for kind in hlod] + [("cells", kind) for kind in cells]:
            text = self.succeed(*([command, kind] if kind else [command]), "--help")
            self.assertNotRegex(text, "INT|FLOAT|309")
            for option in re.findall(r"^ +(--[a-z-]+) N\b", text, re.MULTILINE):
                self.assertIn((command, kind, option), rows)


if __name__ == "__main__":
    unittest.main(verbosity=1)
