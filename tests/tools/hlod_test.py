"""`occlod hlod` as people and scripts use it."""
import random
import struct
import unittest

from tool_case import OCCLOD, TRIANGLES, ToolTest


class Hlod(ToolTest):
    def setUp(self):
        super().setUp()
        self.make_planet()

    def build(self, *arguments, inputs=("planet.ply",), output="planet.ohlod"):
        return self.json_of("hlod", "build", *inputs, "-o", output, "--node-triangles", 64, *arguments)

    def test_build_reports(self):
        built = self.build()
        self.assert_has_keys(built, "inputs file triangles nodes levels roots patches stored_triangles grouping borders node_triangles bytes "
                                    "bytes_per_triangle file_bytes file_bytes_per_triangle read_ms build_ms write_ms triangles_per_s peak_bytes report")
        self.assertEqual((built["triangles"], built["roots"], built["grouping"], built["borders"], built["node_triangles"]),
                         (TRIANGLES, 1, "shifted", "locked", 64))
        self.assertEqual(built["inputs"], ["planet.ply"])
        self.assertGreater(built["stored_triangles"], TRIANGLES)

    def test_clusters_are_built(self):
        built = self.json_of("hlod", "build", "planet.ply", "-o", "planet.glb", "--clusters", 64)
        self.assert_has_keys(built, "inputs file triangles levels groups clusters stored_triangles vertices cluster_triangles file_bytes read_ms "
                                    "build_ms write_ms triangles_per_s peak_bytes report")
        self.assertEqual((built["triangles"], built["cluster_triangles"]), (TRIANGLES, 64))
        self.assertTrue(TRIANGLES < built["stored_triangles"] < 2.1 * TRIANGLES)
        self.assertGreaterEqual(built["clusters"], built["stored_triangles"] / 64)
        self.assertEqual(built["file_bytes"], (self.folder / "planet.glb").stat().st_size)
        self.assertEqual(self.json_of("hlod", "build", "planet.glb", "-o", "b.ohlod")["triangles"], TRIANGLES)
        (self.folder / "parts.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\ng left\nf 1 2 3\ng right\nf 1 3 4\n")
        parts = self.json_of("hlod", "build", "parts.obj", "-o", "parts.glb", "--clusters", 64)
        self.assertEqual((parts["vertices"], parts["report"]["left_out"]), (4, self.json_of("build", "parts.obj", "-o", "parts.olod")["report"]["left_out"]))
        self.assertTrue(parts["report"]["left_out"])
        for wrong, word in ((["--node-triangles", 64], "--node-triangles"), (["--compress", "zstd"], "--clusters"), (["-o", "a.ohlod"], ".glb")):
            done = self.run_tool("hlod", "build", "planet.ply", "--clusters", 64, *(["-o", "b.glb"] if wrong[0] != "-o" else []), *wrong)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
            self.assertIn(word, done.stderr)

    def test_info_agrees_with_build(self):
        built = self.build()
        for options in ([], ["--all"]):
            told = self.json_of("hlod", "info", "planet.ohlod", *options)
            for key in ("triangles", "nodes", "levels", "roots", "patches", "stored_triangles", "bytes", "report"):
                self.assertEqual(told[key], built[key], key)
            self.assertEqual([level["level"] for level in told["level"]], list(range(built["levels"])))
            self.assertEqual(sum(level["nodes"] for level in told["level"]), built["nodes"])
            self.assertEqual(sum(level["triangles"] for level in told["level"]), built["stored_triangles"])
            self.assertEqual(told["level"][0]["error_max"], 0)
            self.assertEqual(told["file_bytes"], (self.folder / "planet.ohlod").stat().st_size)
            errors = [level["error_max"] for level in told["level"]]
            self.assertEqual(errors, sorted(errors))

    def test_options_are_used(self):
        usual = self.build()
        self.assertGreater(usual["nodes"], self.json_of("hlod", "build", "planet.ply", "-o", "a.ohlod", "--node-triangles", 256)["nodes"])
        nested = self.build("--grouping", "nested", "--borders", "free", output="nested.ohlod")
        self.assertEqual((nested["grouping"], nested["borders"]), ("nested", "free"))
        self.assertTrue(all(level["parents"] <= 1 for level in self.json_of("hlod", "info", "nested.ohlod")["level"]))
        locked = self.build("--grouping", "nested", output="locked.ohlod")
        self.assertEqual((locked["grouping"], locked["borders"]), ("nested", "locked"))
        for name in ("planet", "nested", "locked"):
            self.assertTrue(self.json_of("hlod", "validate", f"{name}.ohlod", "--input", "planet.ply")["valid"])
        done = self.run_tool("hlod", "build", "planet.ply", "-o", "a.ohlod", "--borders", "free")
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1))
        self.assertIn("--grouping nested", done.stderr)

    def test_files_are_compressed_without_loss(self):
        packed, stored = self.build(), self.build("--compress", "none", output="stored.ohlod")
        self.assertEqual(packed["bytes"], stored["bytes"])
        for built, name in ((packed, "planet.ohlod"), (stored, "stored.ohlod")):
            size = (self.folder / name).stat().st_size
            self.assertEqual((built["file_bytes"], built["file_bytes_per_triangle"]), (size, size / TRIANGLES))
            told = self.json_of("hlod", "info", name, "--all")
            self.assertEqual((told["compressed"], told["format"]), (name == "planet.ohlod", 6 if name == "planet.ohlod" else 4))
            self.assertTrue(self.json_of("hlod", "validate", name, "--input", "planet.ply")["valid"])
        self.assertLess(packed["file_bytes"], 0.8 * stored["file_bytes"])

    def test_positions_are_quantised_on_request(self):
        exact, rounded = self.build(), self.build("--quantise", 10, output="rounded.ohlod")
        self.assertNotIn("lattice_step", exact)
        self.assertLess(rounded["file_bytes"], 0.8 * exact["file_bytes"])
        told = self.json_of("hlod", "info", "rounded.ohlod")
        box = told["box"]
        side = max(high - low for low, high in zip(box["min"], box["max"]))
        self.assertEqual(told["lattice_step"], rounded["lattice_step"])
        self.assertTrue(1 / 2048 < told["lattice_step"] / side < 1 / 510, told["lattice_step"])
        for more in ([], ["--leaves-only"]):
            self.assertTrue(self.json_of("hlod", "validate", "rounded.ohlod", "--input", "planet.ply", *more)["valid"])
        self.assertEqual(self.build("--quantise", 0, output="zero.ohlod")["file_bytes"], exact["file_bytes"])
        done = self.run_tool("hlod", "build", "planet.ply", "-o", "a.ohlod", "--quantise", 5)
        self.assertEqual(done.returncode, 2)
        self.assertIn("5 is not 0 or in [8, 23]", done.stderr)

    def test_triangles_that_quantising_drops_are_told(self):
        self.run_tool("generate", "rough-planet", "level=7", "-o", "fine.ply")
        for more in ([], ["--memory", "64M"]):
            built = self.build("--quantise", 8, *more, inputs=("fine.ply",), output="coarse.ohlod")
            read, dropped = built["report"]["triangles_read"], built["report"]["repeated_index_triangles"]
            self.assertEqual(read - dropped, built["triangles"])

    def test_splits_are_kept_on_request(self):
        usual, splits = self.build(), self.build("--within", "splits", output="splits.ohlod")
        self.assertEqual((usual["within"], splits["within"]), ("geomorph", "splits"))
        self.assertNotIn("within_bytes", usual)
        self.assertEqual(splits["bytes"], usual["bytes"] + splits["within_bytes"])
        self.assertGreater(splits["splits"], 0)
        told = self.json_of("hlod", "info", "--all", "splits.ohlod")
        for key in ("within", "within_bytes", "splits", "bytes"):
            self.assertEqual(told[key], splits[key], key)
        self.assertRegex(self.succeed("hlod", "info", "splits.ohlod"), r"(?m)^within_bytes +[1-9]")
        self.assertTrue(self.json_of("hlod", "validate", "splits.ohlod", "--input", "planet.ply", "--fronts", 200)["valid"])
        self.assertTrue(self.json_of("hlod", "info", "planet.ohlod")["within"] == "geomorph")
        self.build("--within", "geomorph", output="geomorph.ohlod")
        self.assertTrue(self.same_bytes("planet.ohlod", "geomorph.ohlod"))

    def test_damaged_splits_are_found(self):
        self.build("--within", "splits")
        content = bytearray((self.folder / "planet.ohlod").read_bytes())
        content[-100] ^= 1  # a checksum of splits: they come last
        (self.folder / "planet.ohlod").write_bytes(content)
        for command in (["info", "--all"], ["validate"]):
            self.assertIn("checksum is wrong", self.failure_of("hlod", *command, "planet.ohlod"))

    def test_threads_do_not_change_the_file(self):
        for threads in (1, 2, 5):
            self.build("--threads", threads, output=f"{threads}.ohlod")
        self.assertTrue(self.same_bytes("1.ohlod", "2.ohlod"))
        self.assertTrue(self.same_bytes("1.ohlod", "5.ohlod"))

    def test_a_memory_limit_is_kept_and_does_not_change_the_file(self):
        """Loops wait for room. On a busy machine more fills up between two looks."""
        self.write_scene('{"objects": [{"generator": "rough-planet", "options": {"level": 9}}],'
                         ' "cameras": {"default": {"eye": [0, 0, 4], "target": [0, 0, 0]}}}')
        self.assertGreater(self.build(inputs=["scene.json"], output="free.ohlod")["peak_bytes"], 200 << 20)
        for limit in (96, 1024):
            told = self.build("--memory", f"{limit}M", inputs=["scene.json"], output=f"{limit}.ohlod")
            self.assertGreater(told["scratch_bytes"], 100 << 20)
            if limit == 96:
                self.assertLess(told["peak_bytes"], 1.2 * (limit << 20))
            self.assertEqual(told["report"]["triangles_read"], 8 * 4**9)
        self.assertTrue(self.same_bytes("96.ohlod", "1024.ohlod"))
        self.assertIn("valid", self.succeed("hlod", "validate", "96.ohlod", "--input", "scene.json", "--leaves-only"))
        self.assertEqual(sorted(p.name for p in self.folder.iterdir() if p.suffix not in (".json", ".ply")), ["1024.ohlod", "96.ohlod", "free.ohlod"])

    def test_builds_in_memory_and_streamed_are_equal(self):
        """The report too, which nothing in the file of a piece shows: an open border, an edge of three triangles, a
        repeated triangle, a flat one, one whose corners are at one place, quads, equal positions, and vertices that no
        triangle uses, or only a triangle that goes. Vertices are not in the order in which triangles use them."""
        vertices = [(9, 9, 9)] + [(x, y, 0.001 * x * y) for y in range(7, -1, -1) for x in range(8)] + [(3, 3, 5), (0, 0, 0), (0, 0, 0), (20, 20, 20), (20, 20, 20)]
        quads = [[2 + x + 8 * y + d for d in (0, 8, 9, 1)] for y in range(7) for x in range(7)]
        bad = [[2, 3, 66], [66, 2, 3], [2, 3, 4], [67, 68, 66], [69, 70, 66]]
        text = "".join("v {} {} {}\n".format(*v) for v in vertices) + "".join("f " + " ".join(map(str, face)) + "\n" for face in quads + bad)
        (self.folder / "bad.obj").write_text(text)
        self.write_scene('{"objects": [{"mesh": "bad.obj"}, {"mesh": "bad.obj", "position": [7, 0, 0]}, {"mesh": "planet.ply", "position": [30, 0, 0]},'
                         ' {"generator": "city", "options": {"blocks": 1}}], "cameras": {"default": {"eye": [0, 0, 4], "target": [0, 0, 0]}}}')
        for mesh in ("bad.obj", "scene.json"):
            for more in ([], ["--quantise", 8]):
                reports = [self.build(*more, *memory, inputs=[mesh], output=output)["report"]
                           for memory, output in (([], "whole.ohlod"), (["--memory", "64M"], "streamed.ohlod"))]
                self.assertEqual(reports[0], reports[1])
                self.assertTrue(self.same_bytes("whole.ohlod", "streamed.ohlod"), (mesh, more))
        report = self.build(inputs=["bad.obj"], output="whole.ohlod")["report"]
        self.assertEqual((report["vertices_read"], report["polygons_read"], report["polygons_triangulated"], report["triangles_read"]), (70, 54, 49, 103))
        # The first vertex, and one of those that only the last triangle uses.
        self.assertEqual((report["unreferenced_vertices"], report["repeated_index_triangles"]), (2, 2))
        for key in ("zero_area_triangles", "repeated_triangles", "nonmanifold_edges", "boundary_edges"):
            self.assertGreater(report[key], 0, key)

    def test_a_file_larger_than_the_limit_is_streamed(self):
        """Read as a whole, it takes 130 MiB."""
        self.json_of("generate", "rough-planet", "level=9", "-o", "large.obj")
        told = self.build("--memory", "96M", inputs=["large.obj"], output="large.ohlod")
        self.assertLess(told["peak_bytes"], 1.1 * (96 << 20))

    def test_a_journal_that_does_not_fit_is_told(self):
        """Before the input is read, where the options differ."""
        self.build()
        (self.folder / "planet.ohlod.journal").write_text("my diary")
        command = ["hlod", "build", "planet.ply", "-o", "planet.ohlod", "--resume"]
        self.assertIn("planet.ohlod.journal: is not a journal of an HLOD build; move it away", self.failure_of(*command))
        self.assertEqual((self.folder / "planet.ohlod.journal").read_text(), "my diary")
        self.build()  # without --resume it is left alone
        self.assertEqual((self.folder / "planet.ohlod.journal").read_text(), "my diary")

    def test_a_file_and_its_mesh_make_the_same(self):
        """A file that is streamed, whatever its format, and one that is read as a whole."""
        for name in ("planet.ply", "planet.obj", "planet.off"):
            self.make_planet(name)
            self.build("--memory", "64M", inputs=[name], output=name + ".ohlod")
            self.assertTrue(self.same_bytes("planet.ply.ohlod", name + ".ohlod"), name)

    def test_normals_of_any_length_are_the_same_streamed(self):
        """Each normal becomes a unit vector once: streamed, in memory, and as a scene of one object at its place, to the bit."""
        generator = random.Random(5)
        lengths = (1.0, 1.7, 1e-3, 1e-44, 3e38, 0.0, float("nan"))
        for round_ in range(24):
            points = [tuple(generator.choice((0.0, -0.0, generator.uniform(-1, 1))) for _ in range(3)) for _ in range(4 + 4 * round_)]
            points += points[:3]  # at one position
            normals = [tuple(generator.choice(lengths[: 2 + round_ % 6]) * generator.uniform(-1, 1) for _ in range(3)) for _ in points]
            faces = [tuple(generator.sample(range(len(points)), 3)) for _ in range(1 + 2 * round_)]
            faces += faces[: round_ % 3]
            header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n" + "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz")) +
                      f"element face {len(faces)}\nproperty list uchar uint vertex_indices\nend_header\n")
            (self.folder / "n.ply").write_bytes(header.encode() + b"".join(struct.pack("<6f", *p, *n) for p, n in zip(points, normals)) +
                                                b"".join(struct.pack("<B3I", 3, *face) for face in faces))
            self.write_scene('{"objects": [{"mesh": "n.ply"}], "cameras": {"default": {"eye": [0, 0, 4], "target": [0, 0, 0]}}}')
            if self.run_tool("info", "n.ply").returncode != 0:
                continue  # no triangle has an area
            for name, more in (("streamed", ["--memory", "64M"]), ("memory", [])):
                for source in ("n.ply", "scene.json"):
                    self.build(*more, inputs=[source], output=f"{name}.ohlod")
                    for given in ("n.ply", "scene.json"):
                        self.assertTrue(self.json_of("hlod", "validate", f"{name}.ohlod", "--input", given)["valid"], (round_, name, source, given))

    def test_bad_files_are_refused_as_without_a_limit(self):
        self.make_planet("planet.obj")
        for name in ("planet.ply", "planet.obj"):
            whole = (self.folder / name).read_bytes()
            for content in (whole[:len(whole) // 2], whole[:len(whole) // 3], whole[:40], whole[:-1] + b"x 7", b""):
                (self.folder / name).write_bytes(content)
                build = ("hlod", "build", name, "-o", "bad.ohlod")
                told = self.failure_of(*build, "--memory", "64M")
                self.assertEqual(told.replace(f"{self.folder}/", ""), self.failure_of(*build))
                self.assertIn(name, told)
                self.assertEqual([p.name for p in self.folder.glob(".*")] + [p.name for p in self.folder.glob("bad*")], [])

    def test_mistakes_with_memory(self):
        build = ("hlod", "build", "planet.ply", "-o", "a.ohlod")
        self.assertIn("missing", self.failure_of(*build, "--memory", "1G", "--scratch", "missing"))
        for mistake, told in ((("--memory", "63M"), "of at least 64M"), (("--memory", "much"), "is not a number of bytes"),
                              (("--scratch", "."), "requires --memory"), (("--memory", "1G", "--within", "splits"), "--within geomorph only")):
            done = self.run_tool(*build, *mistake)
            self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), done.stderr)
            self.assertIn(told, done.stderr)
        self.assertFalse((self.folder / "a.ohlod").exists())

    def test_validate_tells_another_mesh_apart(self):
        self.build()
        self.assertTrue(self.json_of("hlod", "validate", "planet.ohlod", "--input", "planet.ply", "--fronts", 1000)["valid"])
        self.make_planet("other.ply", seed=2)
        done = self.run_tool("hlod", "validate", "planet.ohlod", "--input", "other.ply")
        self.assertEqual((done.returncode, done.stdout), (1, "planet.ohlod: level 0 is not other.ply\n"))
        self.assertEqual(done.stderr, "occlod: error: planet.ohlod: 1 violations; build it again\n")

    def test_scenes_and_several_meshes(self):
        """Two planets apart are two planets, whether as a scene, beside a second mesh or mirrored."""
        self.write_scene('{"objects": [{"mesh": "planet.ply"}, {"mesh": "planet.ply", "position": [5, 0, 0], "scale": 2}],'
                         ' "cameras": {"default": {"eye": [0, 0, 4], "target": [0, 0, 0]}}}')
        built = self.build(inputs=["scene.json"])
        self.assertEqual((built["triangles"], built["report"]["components"]), (2 * TRIANGLES, 2))
        self.assertEqual(built["report"]["boundary_edges"], 0)
        told = self.json_of("hlod", "info", "planet.ohlod")
        self.assertGreater(told["box"]["max"][0], 6.5)
        self.assertTrue(self.json_of("hlod", "validate", "planet.ohlod", "--input", "scene.json")["valid"])
        self.make_planet("other.ply", seed=2)
        both = self.build(inputs=["planet.ply", "other.ply"])
        self.assertEqual(both["triangles"], 2 * TRIANGLES)
        self.assertTrue(self.json_of("hlod", "validate", "planet.ohlod", "--input", "planet.ply", "other.ply")["valid"])
        self.assertIn("valid", self.succeed("hlod", "validate", "planet.ohlod", "--input", "planet.ply", "--input", "other.ply"))

    def test_text_output(self):
        self.build()
        text = self.succeed("hlod", "info", "planet.ohlod")
        self.assertRegex(text, r"(?m)^grouping +shifted$")
        self.assertRegex(text, r"(?m)^level +nodes +triangles +parents +children")
        self.assertRegex(text, rf"(?m)^ +0 +\d+ +{TRIANGLES} ")
        self.assertRegex(self.succeed("hlod", "validate", "planet.ohlod"), r"^planet.ohlod: valid")

    def test_mistakes(self):
        self.build()
        self.assertIn("missing.ply: no such file", self.failure_of("hlod", "build", "missing.ply", "-o", "a.ohlod"))
        self.assertIn("is not an .ohlod file; make one with 'occlod hlod build'", self.failure_of("hlod", "info", "planet.ply"))
        self.assertIn("use 'occlod hlod info'", self.failure_of("info", "planet.ohlod"))
        self.assertIn("use 'occlod cells info'", self.failure_of("info", "street.vlod"))
        whole = (self.folder / "planet.ohlod").read_bytes()
        (self.folder / "cut.ohlod").write_bytes(whole[: len(whole) // 2])
        for command in ("info", "validate"):
            self.assertIn("truncated", self.failure_of("hlod", command, "cut.ohlod"))
        flipped = bytearray(whole)
        flipped[len(whole) // 2] ^= 4
        (self.folder / "flipped.ohlod").write_bytes(flipped)
        self.assertIn("checksum", self.failure_of("hlod", "validate", "flipped.ohlod"))
        self.assertIn("checksum", self.failure_of("hlod", "info", "--all", "flipped.ohlod"))
        self.assertFalse((self.folder / "a.ohlod").exists())


if __name__ == "__main__":
    unittest.main(verbosity=1)
