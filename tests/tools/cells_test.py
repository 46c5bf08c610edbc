"""`occlod cells` as people and scripts use it."""
import json
import re
import resource
import subprocess
import unittest

from tool_case import OCCLOD, TRIANGLES, ToolTest

# Eight root cells beside a planet of radius 1.
SPACE = ["--region", "1.5,-0.5,-0.5,2.5,0.5,0.5", "--root-cell", 0.5, "--smallest-cell", 0.125, "--image", "320x240,60,0.01", "--tolerance", 1.5]
# Four root cells in a row away from it: what is farther draws less than half, so some are divided.
DIVIDED = ["--region", "1.5,-4,-4,33.5,4,4", "--root-cell", 8, "--smallest-cell", 1, *SPACE[6:], "--max-triangles", 100]


class Cells(ToolTest):
    def setUp(self):
        super().setUp()
        self.make_hierarchy()

    def build(self, *arguments, output="planet.vlod"):
        return self.json_of("cells", "build", "planet.olod", "-o", output, *arguments)

    def write_cells(self, cells):
        self.write_scene(json.dumps({"objects": [{"mesh": "planet.olod"}], "cameras": {"default": {"eye": [3, 0, 0], "target": [0, 0, 0]}}, "cells": cells}))

    def test_build_reports(self):
        built = self.build(*SPACE)
        self.assert_has_keys(built, "input file root_cells cuts tolerance_px budget occlusion focal_length_px near occluder_motion root_cell smallest_cell max_triangles division "
                                    "regions objects cells nodes depth above_most_triangles above_by drawn_mean drawn_median drawn_max triangles_mean error_px splits "
                                    "hidden_faces file_bytes payload_bytes bytes_per_cell bits_per_id teleport_bytes_max crossing_bytes_mean crossing_bytes_max "
                                    "packed hierarchy_bytes bytes_over_hierarchies cpu_s_per_cell cpu_s build_ms peak_bytes")
        self.assertEqual((built["root_cells"], built["cells"], built["cuts"], built["depth"]), (8, 8, 8, 1))
        self.assertEqual((built["tolerance_px"], built["near"], built["occluder_motion"]), (1.5, 0.01, 0.125 / 4))
        self.assertAlmostEqual(built["focal_length_px"], 120 / 3**-0.5)
        self.assertEqual(built["file_bytes"], (self.folder / "planet.vlod").stat().st_size)
        self.assertEqual((built["above_most_triangles"], built["above_by"]), (0, 0))
        self.assertLessEqual(built["error_px"], 1.5)
        self.assertLess(built["drawn_max"], TRIANGLES)
        self.assertLess(built["drawn_mean"], built["triangles_mean"])

    def test_info_agrees_with_build(self):
        built = self.build(*DIVIDED)
        for options in ([], ["--all"]):
            told = self.json_of("cells", "info", "planet.vlod", *options)
            self.assertEqual({key: told[key] for key in told if key not in ("file", "format")}, {key: built[key] for key in told if key not in ("file", "format")})
        self.assertIn("cells ", self.succeed("cells", "info", "planet.vlod"))

    def test_info_of_a_cell(self):
        self.build(*DIVIDED)
        cell = self.json_of("cells", "info", "planet.vlod", "--cell", "1.6,0.1,-0.3")
        self.assertTrue(cell["is_leaf"])
        self.assertTrue(all(low <= x <= high for low, x, high in zip(cell["min"], (1.6, 0.1, -0.3), cell["max"])), cell)
        self.assertEqual(self.json_of("cells", "info", "planet.vlod", "--cell", cell["cell"]), cell)
        self.assertEqual(sum(node["splits"] for node in cell["path"]), cell["splits"])
        self.assertEqual(sum(node["bytes"] for node in cell["path"]), cell["path_bytes"])
        self.assertEqual((cell["path"][0]["node"], cell["path"][-1]["node"]), (0, cell["cell"]))
        for neighbour in cell["neighbours"]:
            self.assertIn(cell["cell"], self.json_of("cells", "info", "planet.vlod", "--cell", neighbour)["neighbours"])
        self.assertFalse(self.json_of("cells", "info", "planet.vlod", "--cell", 0)["is_leaf"])
        self.assertIn("no cell holds this point", self.failure_of("cells", "info", "planet.vlod", "--cell", "9,9,9"))
        self.assertIn("numbered from 0", self.failure_of("cells", "info", "planet.vlod", "--cell", 100000))

    def test_options_are_used(self):
        usual = self.build(*SPACE)
        self.assertGreater(self.build(*DIVIDED)["cells"], usual["cells"])
        fine = self.build(*SPACE[:-2], "--tolerance", 0.5)
        self.assertGreater(fine["drawn_mean"], usual["drawn_mean"])
        self.assertGreater(self.build(*[word if word != "320x240,60,0.01" else "1280x960,60,0.01" for word in SPACE])["drawn_mean"], usual["drawn_mean"])
        self.assertEqual(self.build(*[word if word != 0.5 else 1 for word in SPACE])["cells"], 1)
        self.assertEqual(self.build(*SPACE, "--max-triangles", 0)["cells"], 8)
        self.assertEqual(self.build(*SPACE, "--region", "3,0,0,3,0,0")["cells"], 9, "the eye may be at one point, too")
        self.assertEqual((usual["occlusion"], usual["budget"]), ("hull", 0))
        less = self.build(*SPACE, "--budget", 600)
        self.assertEqual(less["budget"], 600)
        self.assertLessEqual(less["triangles_mean"], 600)
        self.assertLess(less["triangles_mean"], usual["triangles_mean"])
        self.assertGreater(less["error_px"], usual["error_px"])
        everything, sampled = self.build(*SPACE, "--occlusion", "none"), self.build(*SPACE, "--occlusion", "sampled")
        self.assertEqual((everything["occlusion"], sampled["occlusion"]), ("none", "sampled"))
        self.assertGreater(everything["drawn_mean"], usual["drawn_mean"])
        self.assertLess(sampled["drawn_mean"], everything["drawn_mean"])
        self.assertEqual(everything["hidden_faces"], 0)

    def test_bytes_do_not_depend_on_threads_or_parts(self):
        self.build(*DIVIDED, "--threads", 1)
        self.build(*DIVIDED, "--threads", 3, output="threads.vlod")
        self.assertTrue(self.same_bytes("planet.vlod", "threads.vlod"))
        for shard in (3, 1, 2):
            part = self.json_of("cells", "build", "planet.olod", *DIVIDED, "--work", "parts", "--shard", f"{shard}/3")
            self.assertEqual((part["parts"], part["parts_found"]), (1, 0))
        merged = self.json_of("cells", "merge", "parts", "-o", "merged.vlod")
        self.assertEqual(merged["parts"], 3)
        self.assertTrue(self.same_bytes("planet.vlod", "merged.vlod"))

    def test_resume_builds_what_is_missing_or_damaged(self):
        space = [word if word != 0.5 else 0.25 for word in SPACE]  # 64 root cells: four parts
        whole = self.build(*space)
        self.assertEqual(whole["cells"], 64)
        self.assertEqual(self.build(*space, "--work", "parts", output="a.vlod")["parts_found"], 0)
        self.assertTrue(self.same_bytes("planet.vlod", "a.vlod"))
        parts = sorted((self.folder / "parts").iterdir())
        self.assertEqual(len(parts), 4)
        parts[0].unlink()
        damaged = bytearray(parts[2].read_bytes())
        damaged[-1] ^= 1
        parts[2].write_bytes(damaged)
        self.assertIn("checksum", self.failure_of("cells", "merge", "parts", "-o", "b.vlod"))
        again = self.build(*space, "--work", "parts", output="b.vlod")
        self.assertEqual((again["parts"], again["parts_found"], again["cuts"]), (4, 2, 32))
        self.assertTrue(self.same_bytes("planet.vlod", "b.vlod"))
        other = self.build(*space[:-1], 1.25, "--work", "parts", output="b.vlod")
        self.assertEqual(other["parts_found"], 0, "parts of other options do not count")
        self.assertIn("is of another scene or of other options", self.failure_of("cells", "merge", "parts", "-o", "b.vlod"))
        parts[1].unlink()
        for part in (self.folder / "parts").iterdir():
            if part.name[:16] != parts[1].name[:16]:
                part.unlink()
        self.assertIn("lacks the root cells 16 to 31; build them", self.failure_of("cells", "merge", "parts", "-o", "c.vlod"))
        self.assertFalse((self.folder / "c.vlod").exists())

    def test_pack(self):
        built = self.build(*DIVIDED)
        packed = self.json_of("cells", "pack", "planet.vlod", "planet.olod", "-o", "packed.vlod")
        self.assert_has_keys(packed, "input file cells packed geometry_splits geometry_bytes geometry_raw_bytes geometry_frames unpacked_bytes file_bytes hierarchy_bytes "
                                     "bytes_over_hierarchies pack_ms")
        self.assertEqual((packed["packed"], packed["unpacked_bytes"]), (True, built["file_bytes"]))
        self.assertEqual(packed["file_bytes"], (self.folder / "packed.vlod").stat().st_size)
        for key in ("cells", "nodes", "drawn_mean", "splits", "hidden_faces", "hierarchy_bytes"):
            self.assertEqual(packed[key], built[key], key)
        self.assertEqual((packed["candidates"], built["packed"]), (0, False))
        self.assertLess(packed["bits_per_id"], built["bits_per_id"])
        told = self.json_of("cells", "info", "packed.vlod", "--all")
        self.assertEqual((told["format"], told["geometry_bytes"]), (2, packed["geometry_bytes"]))
        self.assertLess(packed["geometry_bytes"], packed["geometry_raw_bytes"])
        self.succeed("cells", "pack", "packed.vlod", "planet.olod", "-o", "again.vlod")
        self.assertTrue(self.same_bytes("packed.vlod", "again.vlod"))
        checked = self.json_of("cells", "validate", "packed.vlod", "planet.olod", "--cells", 2, "--eyes", 2, "--image-size", 32)
        self.assertEqual(checked["unexplained"], 0)

    def test_pack_says_what_is_wrong(self):
        self.build(*SPACE)
        self.succeed("generate", "rough-planet", "level=2", "-o", "other.ply")
        self.assertRegex(self.failure_of("cells", "pack", "planet.vlod", "other.ply", "-o", "packed.vlod"), r"object 0 \(.*other.ply\): has changed since")
        self.assertIn("would overwrite", self.run_tool("cells", "pack", "planet.vlod", "planet.olod", "-o", "planet.vlod").stderr)
        self.assertIn("is not an .vlod file", self.failure_of("cells", "pack", "planet.olod", "planet.olod", "-o", "packed.vlod"))
        self.assertFalse((self.folder / "packed.vlod").exists())
        self.succeed("cells", "pack", "planet.vlod", "planet.olod", "-o", "packed.vlod")
        good = (self.folder / "packed.vlod").read_bytes()
        (self.folder / "packed.vlod").write_bytes(good[:-1] + bytes([good[-1] ^ 1]))
        self.succeed("cells", "info", "packed.vlod")
        self.assertRegex(self.failure_of("cells", "info", "packed.vlod", "--all"), r"packed.vlod: frame \d+: is damaged: its checksum is wrong")

    def test_scenes_say_where_the_eye_may_be(self):
        self.write_cells({"regions": [{"min": [1.5, -0.5, -0.5], "max": [2.5, 0.5, 0.5]}], "root_cell": 0.5, "smallest_cell": 0.125, "max_triangles": 77})
        built = self.json_of("cells", "build", "scene.json", "-o", "scene.vlod", *SPACE[6:])
        self.assertEqual((built["cells"], built["root_cell"], built["smallest_cell"], built["max_triangles"]), (8, 0.5, 0.125, 77))
        over = self.json_of("cells", "build", "scene.json", "-o", "scene.vlod", "--region", "2,0,0,2.5,0.5,0.5", "--root-cell", 0.25, "--max-triangles", 10**6)
        self.assertEqual((over["cells"], over["smallest_cell"], over["max_triangles"]), (8, 0.125, 10**6))

    def test_wrong_use(self):
        for arguments, told in ((["-o", "a.vlod", "--shard", "1/2", "--work", "w"], "leave --output out"), (["--shard", "1/2"], "--shard: needs --work"),
                                ([], "--output: is required without --shard"),
                                (["-o", "planet.olod"], "would overwrite planet.olod, which is the input")):
            done = self.run_tool("cells", "build", "planet.olod", *SPACE, *arguments)
            self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), done.stderr)
            self.assertIn(told, done.stderr)
        self.assertEqual(self.run_tool("cells").returncode, 2)
        self.assertIn("--region", self.failure_of("cells", "build", "planet.olod", "-o", "a.vlod"))
        self.assertIn("more than", self.failure_of("cells", "build", "planet.olod", "-o", "a.vlod", *SPACE[:2], "--root-cell", 1e-6))
        self.assertIn("cannot be opened", self.failure_of("cells", "info", "missing.vlod"))
        self.assertIn("is not an .vlod file", self.failure_of("cells", "info", "planet.olod"))
        self.assertIn("has no .vpart files", self.failure_of("cells", "merge", ".", "-o", "a.vlod"))
        self.assertIn("cannot be read", self.failure_of("cells", "merge", "missing", "-o", "a.vlod"))
        self.assertIn("planet.olod", self.failure_of("cells", "build", "planet.olod", *SPACE, "-o", "a.vlod", "--work", "planet.olod"))

    def test_damage_is_found(self):
        self.build(*DIVIDED)
        good = (self.folder / "planet.vlod").read_bytes()
        (self.folder / "planet.vlod").write_bytes(good[:-1] + bytes([good[-1] ^ 1]))
        self.succeed("cells", "info", "planet.vlod")
        self.assertRegex(self.failure_of("cells", "info", "planet.vlod", "--all"), r"cell \d+: is damaged: its checksum is wrong")
        (self.folder / "planet.vlod").write_bytes(good[:-1])
        self.assertIn("truncated", self.failure_of("cells", "info", "planet.vlod"))

    def test_a_budget_below_the_base_mesh_says_what_is_enough(self):
        """No cut has fewer triangles than the base mesh, and the base mesh is one: the number that is named works, and one less does not."""
        refused = self.failure_of("cells", "build", "planet.olod", "-o", "planet.vlod", *SPACE, "--budget", 1)
        enough = int(re.search(r"give (\d+) or more", refused)[1])
        self.assertFalse((self.folder / "planet.vlod").exists())
        self.assertEqual(self.build(*SPACE, "--budget", enough)["triangles_mean"], enough)
        self.assertIn(f"give {enough} or more", self.failure_of("cells", "build", "planet.olod", "-o", "planet.vlod", *SPACE, "--budget", enough - 1))

    def test_a_full_disk_leaves_the_old_file(self):
        """The limit of file sizes stands for a full disk: it fails in the same calls. What was built before stays and can be merged later."""
        old = b"what was there before"
        self.build(*SPACE, "--work", "good", output="good.vlod")
        (self.folder / "planet.vlod").write_bytes(old)
        build = ["build", "planet.olod", *map(str, SPACE), "-o", "planet.vlod"]
        for arguments in (build, [*build, "--work", "parts"], ["merge", "good", "-o", "planet.vlod"]):
            done = subprocess.run([OCCLOD, "cells", *arguments], cwd=self.folder, env=self.environment, capture_output=True, text=True,
                                  preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000)))
            self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (1, "", 1), done.stderr)
            self.assertIn("space on the disk", done.stderr)
            self.assertEqual((self.folder / "planet.vlod").read_bytes(), old)
            self.assertEqual(sorted(path.name for path in self.folder.glob("*.vlod")) + [path.name for path in self.folder.glob("**/.*")], ["good.vlod", "planet.vlod"])
            self.assertEqual(list(self.folder.glob("parts/*")), [])
        self.succeed("cells", "merge", "good", "-o", "planet.vlod")
        self.assertTrue(self.same_bytes("planet.vlod", "good.vlod"))

    def test_packing_onto_a_full_disk_leaves_the_old_file(self):
        self.build(*SPACE)
        old = b"what was there before"
        (self.folder / "packed.vlod").write_bytes(old)
        done = subprocess.run([OCCLOD, "cells", "pack", "planet.vlod", "planet.olod", "-o", "packed.vlod"], cwd=self.folder, env=self.environment, capture_output=True, text=True,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000)))
        self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (1, "", 1), done.stderr)
        self.assertEqual((self.folder / "packed.vlod").read_bytes(), old)
        self.assertEqual([path.name for path in self.folder.glob(".*")], [])


if __name__ == "__main__":
    unittest.main(verbosity=1)
