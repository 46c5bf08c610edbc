"""`occlod cells validate` and `occlod cells walk` as people and scripts use them."""
import json
import os
import pathlib
import signal
import subprocess
import unittest

from tool_case import OCCLOD, ToolTest

ATTEMPTS = 50
CAMERA = {"target": [0, 0, 0], "up": [0, 0, 1], "near": 0.01, "far": 10, "width": 96, "height": 72}
SCENE = {
    "objects": [{"mesh": "planet.olod"}],
    "cameras": {"default": {"eye": [2, 0, 0], **CAMERA}},
    "paths": {"along": {"frames": 41, "keys": [{"eye": [2, -0.49, 0], **CAMERA}, {"eye": [2, 0.49, 0], **CAMERA}]},
              "away": {"frames": 3, "keys": [{"eye": [2, 0, 0], **CAMERA}, {"eye": [9, 0, 0], **CAMERA}]},
              "jumps": {"frames": 40, "jump": True, "keys": [{"eye": [1.6, y, 0.3], **CAMERA} for y in (-0.4, 0.4)]},
              "flat": {"frames": 1, "keys": [{"eye": [2, 0, 0], "target": [0, 0, 0], "up": [0, 0, 1], "orthographic_height": 2}]}},
    "cells": {"regions": [{"min": [1.5, -0.5, -0.5], "max": [2.5, 0.5, 0.5]}], "root_cell": 0.25, "smallest_cell": 0.125},
}


class Walk(ToolTest):
    def setUp(self):
        super().setUp()
        self.make_hierarchy()
        self.write_scene(json.dumps(SCENE))
        self.json_of("cells", "build", "scene.json", "-o", "a.vlod", "--image", "96x72,60,0.01")

    def walk(self, path, *options):
        return self.json_of("cells", "walk", "a.vlod", "scene.json", "--path", path, *options)

    def test_tells_of_each_frame(self):
        walked = self.walk("along")
        self.assert_has_keys(walked, "file scene path cells packed peak_bytes frames crossings late missing outside error_px_max triangles_median drawn_triangles_median drawn_triangles_max "
                                     "bytes_read resident_bytes_max step_ms_median step_ms_max draw_ms_median frame")
        self.assert_has_keys(walked["frame"][0], "frame cell shown outside crossed changed late missing error_px triangles drawn_triangles hash loads bytes_read resident_bytes "
                                                 "step_ms cull_ms draw_ms load_ms")
        # Cells are a quarter wide: from -0.49 to 0.49 there are four. At first nothing is loaded.
        self.assertEqual((walked["frames"], walked["crossings"], walked["missing"], walked["outside"]), (41, 3, 0, 0))
        self.assertEqual([frame["late"] for frame in walked["frame"]], [True] + [False] * 40)
        for frame in walked["frame"]:
            self.assertEqual(frame["late"], frame["cell"] != frame["shown"])
            self.assertGreater(frame["drawn_triangles"], 0)
            self.assertLessEqual(frame["drawn_triangles"], frame["triangles"])
            if not frame["late"]:
                self.assertLessEqual(frame["error_px"], 1)

    def test_packed_files_draw_the_same_without_the_mesh(self):
        self.succeed("cells", "pack", "a.vlod", "scene.json", "-o", "packed.vlod")
        walked = {options: self.walk("along", *options) for options in ((), ("--no-prefetch",))}
        hidden = (self.folder / "planet.olod").rename(self.folder / "elsewhere.olod")
        for options, expected in walked.items():
            packed = self.json_of("cells", "walk", "packed.vlod", "scene.json", "--path", "along", *options)
            self.assertEqual((packed["packed"], expected["packed"]), (True, False))
            for a, b in zip(expected["frame"], packed["frame"], strict=True):
                for key in ("cell", "shown", "late", "crossed", "triangles", "drawn_triangles", "hash"):
                    self.assertEqual(a[key], b[key], f"frame {a['frame']}: {key}")
        self.assertGreater(len({frame["hash"] for frame in packed["frame"]}), 3)
        self.assertIn("elsewhere", str(hidden))
        self.assertIn("planet.olod", self.failure_of("cells", "walk", "a.vlod", "scene.json", "--path", "along"))
        self.assertIn("planet.olod", self.failure_of("cells", "walk", "packed.vlod", "scene.json", "--path", "along", "--reference", 3))
        hidden.rename(self.folder / "planet.olod")
        compared = self.json_of("cells", "walk", "packed.vlod", "scene.json", "--path", "along", "--reference", 3)
        self.assertEqual([frame["unexplained_px"] for frame in compared["frame"] if "unexplained_px" in frame], [0, 0, 0])

    def test_frames_are_late_without_prefetching(self):
        self.assertEqual(self.walk("along", "--no-prefetch")["late"], 1 + 3, "the first frame and one for each crossing")

    def test_compares(self):
        walked = self.walk("along", "--reference", 5)
        compared = [frame for frame in walked["frame"] if "unexplained_px" in frame]
        self.assertEqual([frame["frame"] for frame in compared], [8, 16, 24, 32, 40])
        self.assertEqual(walked["frames_compared"], 5)
        for frame in compared:
            self.assertEqual((frame["unexplained_px"], frame["update"]["unexplained_px"]), (0, 0))
            self.assertGreater(frame["update"]["triangles"], 0)

    def test_memory_outside_and_jumps(self):
        self.assertIn("needs", self.failure_of("cells", "walk", "a.vlod", "scene.json", "--path", "along", "--memory", 1))
        some = self.walk("along", "--memory", 100_000)
        self.assertLessEqual(some["resident_bytes_max"], 100_000)
        self.assertGreater(self.walk("away")["outside"], 0)
        self.assertEqual(self.walk("jumps")["late"], 2)
        self.assertIn("orthographic", self.failure_of("cells", "walk", "a.vlod", "scene.json", "--path", "flat"))
        self.assertIn("nowhere", self.failure_of("cells", "walk", "a.vlod", "scene.json", "--path", "nowhere"))

    def change_while_open(self, change, *arguments):
        """Stops the command once it has a.vlod open for good, which is after it has mapped the hierarchy, calls change(), and lets it go on."""
        with subprocess.Popen([OCCLOD, *map(str, arguments), "--json"], cwd=self.folder, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            while process.poll() is None:
                if self.has_open(process.pid, "planet.olod", "maps") and self.has_open(process.pid, "a.vlod", "fd"):
                    os.kill(process.pid, signal.SIGSTOP)
                    os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WEXITED | os.WNOWAIT)
                    change()
                    os.kill(process.pid, signal.SIGCONT)
                    break
            output, errors = process.communicate()
        return process.returncode, output, errors

    def has_open(self, pid, name, how):
        try:
            folder = pathlib.Path(f"/proc/{pid}")
            return name in (folder / "maps").read_text() if how == "maps" else any(os.readlink(link).endswith(name) for link in (folder / "fd").iterdir())
        except FileNotFoundError:  # it has been closed, or the process has ended
            return False

    WALK = ["cells", "walk", "a.vlod", "scene.json", "--path", "along"]

    def test_removed_or_replaced_while_walking(self):
        """What is open lives on, so the same is drawn, and seen, as if nothing had happened."""
        validate = ["cells", "validate", "a.vlod", "scene.json", "--cells", 2, "--eyes", 1, "--image-size", 16]
        path = self.folder / "a.vlod"
        good = path.read_bytes()
        def drawn(result):
            return [(frame["cell"], frame["shown"], frame["late"], frame["drawn_triangles"]) for frame in result["frame"]] if "frame" in result else result["cells"]
        for arguments in (self.WALK, validate):
            path.write_bytes(good)
            expected = drawn(self.json_of(*arguments))
            for change in (path.unlink, lambda: (self.folder / "other").replace(path)):
                for _ in range(ATTEMPTS):
                    path.write_bytes(good)
                    (self.folder / "other").write_bytes(b"something else")
                    code, output, errors = self.change_while_open(change, *arguments)
                    if code == 0:  # else it was changed before it had been opened for good: refused
                        break
                    self.assertEqual((output, errors.count("\n")), ("", 1), errors)
                self.assertEqual((code, errors), (0, ""))
                self.assertEqual(drawn(json.loads(output)), expected)

    def test_cut_short_while_walking(self):
        """All but what the root adds is gone, so all that can be drawn in any cell is the root's: in each frame something is, and every frame is late. Of
        the cells that cannot be read each is told of."""
        told = self.json_of("cells", "info", "a.vlod")
        root = self.json_of("cells", "info", "a.vlod", "--cell", 0)["path"][0]["bytes"]
        left = told["file_bytes"] - told["payload_bytes"] + root
        path = self.folder / "a.vlod"
        good = path.read_bytes()
        for _ in range(ATTEMPTS):
            path.write_bytes(good)
            code, output, errors = self.change_while_open(lambda: os.truncate(path, left), *self.WALK)
            if code != 0:  # cut before it had been looked at: refused
                self.assertEqual((code, output, errors.count("\n")), (1, "", 1), errors)
                self.assertIn("truncated", errors)
                continue
            walked = json.loads(output)
            if walked["late"] == walked["frames"]:  # else it was cut after cells had been loaded
                break
        self.assertEqual((walked["late"], walked["missing"] > 0), (walked["frames"], True))
        self.assertEqual({frame["shown"] for frame in walked["frame"]}, {0})
        self.assertGreater(min(frame["triangles"] for frame in walked["frame"]), 0)
        lines = errors.splitlines()
        self.assertGreater(len(lines), 0)
        for line in lines:
            self.assertIn("a.vlod", line)
        self.assertIn("a.vlod", self.failure_of("cells", "validate", "a.vlod", "scene.json"))

    def test_picture_and_table(self):
        self.assertIn("crossings", self.succeed("cells", "walk", "a.vlod", "scene.json", "--path", "along", "--png", "last.png"))
        self.assertTrue((self.folder / "last.png").read_bytes().startswith(b"\x89PNG"))

    def test_validate(self):
        checked = self.json_of("cells", "validate", "a.vlod", "scene.json", "--cells", 3, "--eyes", 4, "--image-size", 64, "--seed", 5)
        self.assertEqual((checked["unexplained"], checked["cells_checked"], checked["eyes_a_cell"], checked["seed"]), (0, 3, 13, 5))
        self.assertGreater(checked["pixels"], 1000)
        self.assertEqual(len(checked["cells"]), 3)
        again = self.json_of("cells", "validate", "a.vlod", "scene.json", "--cells", 3, "--eyes", 4, "--image-size", 64, "--seed", 5)
        self.assertEqual(checked["cells"], again["cells"])

    def validate(self, threads, eyes=2):
        return ["cells", "validate", "a.vlod", "scene.json", "--cells", 1000, "--eyes", eyes, "--image-size", 32, "--threads", threads]

    def test_check_does_not_depend_on_threads(self):
        checked = [self.json_of(*self.validate(threads)) for threads in (1, 2, 3, 64)]
        self.assertGreater(checked[0]["cells_checked"], 32)
        self.assertGreater(len({cell["pixels"] for cell in checked[0]["cells"]}), 32, "so rows that are swapped would be seen")
        for result in checked:
            result.pop("check_ms")
            self.assertEqual(result, checked[0])
        table = [self.succeed(*self.validate(threads)).split("\n\n")[0] for threads in (1, 3)]
        self.assertEqual(table[0], table[1])
        self.assertEqual([int(line.split()[0]) for line in table[0].splitlines()[1:]], [cell["cell"] for cell in checked[0]["cells"]])

    def test_check_names_the_first_cell_that_fails_for_any_number_of_threads(self):
        """Half of what nodes add is damaged: of the cells that cannot be read one is the first, and all before it have their rows."""
        data = bytearray((self.folder / "a.vlod").read_bytes())
        for i in range(len(data) - len(data) // 8, len(data), 50):
            data[i] ^= 1
        (self.folder / "a.vlod").write_bytes(data)
        ends = [self.run_tool(*self.validate(threads)) for threads in (1, 2, 3, 64)]
        for end in ends:
            self.assertEqual((end.returncode, end.stdout, end.stderr), (1, ends[0].stdout, ends[0].stderr))
        self.assertIn("checksum", ends[0].stderr)
        self.assertGreater(ends[0].stdout.count("\n"), 2)

    def test_check_starts_as_many_threads(self):
        for threads in (1, 3):
            with subprocess.Popen([OCCLOD, *map(str, self.validate(threads, eyes=40))], cwd=self.folder, env=self.environment, stdout=subprocess.DEVNULL) as process:
                most = 0
                while process.poll() is None and most < 3:
                    most = max(most, self.threads_of(process.pid))
                process.kill()
            self.assertEqual(most, threads)

    def threads_of(self, pid):
        try:
            return len(os.listdir(f"/proc/{pid}/task"))
        except FileNotFoundError:
            return 0

    def test_check_refuses_another_scene(self):
        self.write_scene(json.dumps({**SCENE, "objects": [{"mesh": "planet.olod", "position": [0, 0, 1]}]}))
        self.assertIn("has been moved", self.failure_of("cells", "validate", "a.vlod", "scene.json"))
        self.assertIn("has been moved", self.failure_of("cells", "walk", "a.vlod", "scene.json", "--path", "along"))

    def test_check_refuses_damaged_cells(self):
        data = bytearray((self.folder / "a.vlod").read_bytes())
        data[-20] ^= 1
        (self.folder / "a.vlod").write_bytes(data)
        self.assertEqual(self.run_tool("cells", "validate", "a.vlod", "scene.json", "--cells", 1000, "--eyes", 0, "--image-size", 8).returncode, 1)


if __name__ == "__main__":
    unittest.main(verbosity=1)
