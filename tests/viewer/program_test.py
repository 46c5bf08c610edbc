#!/usr/bin/env python3
"""The program occlod-view as people and scripts start it."""
import csv
import json
import math
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import on_virtual_display

VIEW = os.environ["OCCLOD_VIEW"]
PLANET = {"objects": [{"generator": "rough-planet", "options": {"level": 6}}],
          "cameras": {"default": {"eye": [0, 1.3, 0.3], "target": [0, 1, -0.8]}}}


def view(*arguments, environment=None):
    return subprocess.run([VIEW, *arguments], env=environment, capture_output=True, text=True, check=False, timeout=300)


class CommandLine(unittest.TestCase):
    def test_help_and_version_need_no_display(self):
        for option, words in [("--help", "occlod render"), ("--version", "."), ("--actions", "color_by")]:
            result = view(option, environment={})
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn(words, result.stdout)

    def test_no_display_names_the_way_without(self):
        environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
        result = view("--settings", "/nonexistent/view.json", environment=environment)
        self.assertEqual(result.returncode, 1)
        self.assertIn("occlod render", result.stderr)
        self.assertEqual(result.stderr.count("\n"), 1)

    def test_wrong_use(self):
        sizes = ["big", "10x10", "640", "640x", "640x480x2", "640x480 ", "+640x480", "-640x480", "nanx480", "640xinf", "1e3x800", "9000x900",
                 "99999999999999999999x480", ""]
        for arguments in [("--nonsense",), ("--script", ""), ("--settings", ""), ("--calibration", ""), ("",), *(("--size", size) for size in sizes),
                          *(("--memory", size) for size in ("", "0", "-1", "1.5", "1T", "18446744073709551616")), ("--load", "async"), ("--memory", "1M", "--load", "fast")]:
            result = view(*arguments, environment={})
            self.assertEqual(result.returncode, 2, arguments)
            self.assertIn("--help", result.stderr)
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)

    def test_settings_file_that_is_opened_too(self):
        with tempfile.TemporaryDirectory() as folder:
            scene, link = pathlib.Path(folder, "scene.json"), pathlib.Path(folder, "link.json")
            scene.write_text(json.dumps(PLANET))
            link.symlink_to(scene)
            for arguments in [(str(scene),), ("--script", str(scene)), ("--calibration", str(scene))]:
                result = view(*arguments, "--settings", str(link), environment={})
                self.assertEqual((result.returncode, result.stderr.count("\n")), (2, 1), result.stderr)
                self.assertIn("link.json would be overwritten", result.stderr)
            self.assertEqual(json.loads(scene.read_text()), PLANET)

    def test_standard_streams_that_are_closed_or_full(self):
        """Messages are lost, and the exit code is as ever. What was asked for and cannot be printed is a failure."""
        for redirection in ("2>&-", "2>/dev/full", "2>&- >&-", "2>/dev/full >/dev/full"):
            for code, arguments in [(2, "--nonsense"), (1, "--script nowhere.json"), (1, "--settings /nonexistent/view.json")]:
                done = subprocess.run(f'"$VIEW" {arguments} {redirection}', shell=True, env={"VIEW": VIEW}, check=False, timeout=300)
                self.assertEqual(done.returncode, code, (arguments, redirection))
        for option in ("--help", "--version", "--actions"):
            for redirection in (">&-", ">/dev/full"):
                done = subprocess.run(f'"$VIEW" {option} {redirection}', shell=True, env={"VIEW": VIEW}, capture_output=True, text=True, check=False)
                self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
                self.assertIn("standard output", done.stderr)

    def test_missing_script(self):
        result = view("--script", "nowhere.json")
        self.assertEqual(result.returncode, 1)
        self.assertIn("nowhere.json", result.stderr)


class Script(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)
        (self.path / "planet.json").write_text(json.dumps(PLANET))
        display = on_virtual_display.VirtualDisplay()
        self.environment = dict(display.__enter__(), XDG_CONFIG_HOME=str(self.path / "config"),
                                XDG_CACHE_HOME=str(self.path / "cache"))
        self.addCleanup(display.__exit__)

    def run_script(self, actions, *arguments):
        (self.path / "script.json").write_text(json.dumps({"actions": actions}))
        return view("--script", str(self.path / "script.json"), *arguments, environment=self.environment)

    def test_everything_ends_well(self):
        picture, numbers = self.path / "picture.png", self.path / "numbers.csv"
        result = self.run_script([
            {"do": "open", "file": str(self.path / "planet.json")},
            {"do": "set", "setting": "budget", "value": 1500},
            {"do": "screenshot", "file": str(picture), "panels": True},
            {"do": "export_csv", "file": str(numbers)},
            {"do": "expect", "figure": "triangles", "at_least": 1400, "at_most": 1500},
            {"do": "report"}], "--debug-gl")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertLessEqual(json.loads(result.stdout)["triangles"], 1500)
        self.assertEqual(picture.read_bytes()[:4], b"\x89PNG")
        self.assertIn("1500", numbers.read_text())
        self.assertFalse((self.path / "config").exists(), "a script remembers nothing")

    def played_path(self, *settings, options=(), orthographic=False):
        """A path of 8 frames in path.json, played by the viewer: its rows of numbers by frame."""
        keys = [{"eye": [0, 0.5, 3], "target": [0, 0, 0], "width": 160, "height": 120},
                {"eye": [1.5, 0.5, 2.5], "target": [0, 0, 0], "width": 160, "height": 120}]
        for key in keys if orthographic else ():
            distance = math.sqrt(sum((a - b) ** 2 for a, b in zip(key["eye"], key["target"])))
            key["orthographic_height"] = 2 * distance * math.tan(math.radians(45) / 2)
        (self.path / "path.json").write_text(json.dumps(dict(PLANET, paths={"by": {"frames": 8, "keys": keys}})))
        numbers = self.path / "numbers.csv"
        result = self.run_script([
            {"do": "open", "file": str(self.path / "path.json")},
            {"do": "set", "setting": "budget", "value": 1500},
            *({"do": "set", "setting": name, "value": value} for name, value in settings),
            {"do": "play", "name": "by"},
            {"do": "wait", "for": "path"},
            {"do": "export_csv", "file": str(numbers)}], *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(numbers, newline="") as file:
            return {int(row["path_frame"]): row for row in csv.DictReader(file) if row["path_frame"] != "-1"}

    @unittest.skipUnless("OCCLOD" in os.environ, "the command line is not built")
    def test_path_is_that_of_the_command_line(self):
        """Frame to frame, each frame is the same triangles in both programs, whatever the viewer has shown before."""
        shown = self.played_path(("max_changes", 40))
        done = subprocess.run([os.environ["OCCLOD"], "render", str(self.path / "path.json"), "--path", "by", "--frame-to-frame",
                               "--budget", "1500", "--max-changes", "40", "--json"], env=self.environment,
                              capture_output=True, text=True, check=True, timeout=300)
        frames = json.loads(done.stdout)["frames"]
        self.assertEqual([shown[frame["frame"]]["hash"] for frame in frames], [frame["hash"] for frame in frames])
        self.assertEqual([int(shown[frame["frame"]]["pending"]) for frame in frames], [frame["pending"] for frame in frames])
        # The first frame after refinement from scratch may find nothing worth an exchange.
        self.assertGreaterEqual(len({frame["hash"] for frame in frames}), 7)

    @unittest.skipUnless("OCCLOD" in os.environ, "the command line is not built")
    def test_orthographic_is_that_of_the_command_line(self):
        """A path of orthographic keys is what --orthographic makes of the same keys in perspective."""
        def render(scene, *options):
            done = subprocess.run([os.environ["OCCLOD"], "render", str(scene), "--budget", "1500", "--occlusion", "software", "--json", *options],
                                  env=self.environment, capture_output=True, text=True, check=True, timeout=300)
            return json.loads(done.stdout)
        perspective = [self.played_path()[frame]["hash"] for frame in range(8)]
        frames = render(self.path / "path.json", "--path", "by", "--frame-to-frame", "--orthographic")["frames"]
        shown = self.played_path(orthographic=True)
        self.assertEqual([shown[frame["frame"]]["hash"] for frame in frames], [frame["hash"] for frame in frames])
        self.assertFalse(set(perspective) & {frame["hash"] for frame in frames})

        # And what the viewer has switched over and saved is what it has shown.
        saved, picture, numbers = self.path / "saved.json", self.path / "picture.png", self.path / "numbers.csv"
        result = self.run_script([
            {"do": "open", "file": str(self.path / "planet.json")},
            {"do": "set", "setting": "budget", "value": 1500},
            {"do": "set", "setting": "frame_to_frame", "value": False},
            {"do": "orthographic"},
            {"do": "screenshot", "file": str(picture)},
            {"do": "save_scene", "file": str(saved)},
            {"do": "export_csv", "file": str(numbers)}], "--debug-gl")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(picture.read_bytes()[:4], b"\x89PNG")
        with open(numbers, newline="") as file:
            self.assertEqual(list(csv.DictReader(file))[-1]["hash"], render(saved)["hash"])
        self.assertIn("orthographic_height", json.loads(saved.read_text())["cameras"]["default"])

    @unittest.skipUnless("OCCLOD" in os.environ, "the command line is not built")
    def test_auto_is_that_of_the_command_line(self):
        """With one calibration both programs choose the same effects for each frame."""
        calibration = self.path / "calibration.json"
        command = [os.environ["OCCLOD"], "render", str(self.path / "path.json"), "--path", "by", "--frame-to-frame", "--occlusion", "auto",
                   "--budget", "1500", "--json"]
        self.played_path()  # writes the scene
        for option in ("--save-calibration", "--calibration"):
            done = subprocess.run([*command, option, str(calibration)], env=self.environment, capture_output=True, text=True, check=True, timeout=300)
        shown = self.played_path(("occlusion", "auto"), options=("--calibration", str(calibration)))
        frames = json.loads(done.stdout)["frames"]
        self.assertEqual([shown[frame["frame"]]["hash"] for frame in frames], [frame["hash"] for frame in frames])

    @unittest.skipUnless("OCCLOD" in os.environ, "the command line is not built")
    def test_difference_and_export_are_those_of_the_command_line(self):
        """Beside the full mesh there are the figures of --reference, and what is exported is what --mesh writes."""
        meshes = [self.path / "shown.ply", self.path / "rendered.ply"]
        scene = dict(PLANET, cameras={"default": {"eye": [0, 1.3, 0.3], "target": [0, 1, -0.8], "width": 160, "height": 120}})
        (self.path / "small.json").write_text(json.dumps(scene))
        done = subprocess.run([os.environ["OCCLOD"], "render", str(self.path / "small.json"), "--budget", "1500", "--reference", "--json",
                               "--mesh", str(meshes[1])], env=self.environment, capture_output=True, text=True, check=True, timeout=300)
        expected = json.loads(done.stdout)
        result = self.run_script([
            {"do": "open", "file": str(self.path / "small.json")},
            {"do": "picture_size", "width": 160, "height": 120},
            {"do": "set", "setting": "frame_to_frame", "value": False},
            {"do": "set", "setting": "budget", "value": 1500},
            {"do": "set", "setting": "compare", "value": True},
            {"do": "set", "setting": "beside", "value": "difference"},
            {"do": "export_mesh", "file": str(meshes[0])},
            {"do": "report"}], "--debug-gl")
        self.assertEqual(result.returncode, 0, result.stderr)
        shown = json.loads(result.stdout)
        self.assertEqual(meshes[0].read_bytes(), meshes[1].read_bytes())
        for name in ("depth_rms_px", "silhouette_mismatch"):
            self.assertAlmostEqual(shown[name], expected[name], delta=1e-6 * max(expected[name], 1), msg=name)
        self.assertGreater(shown["depth_rms_px"], 0)
        self.assertLess(shown["max_quadric_error_px"], shown["max_error_px"])

    @unittest.skipUnless("OCCLOD" in os.environ, "the command line is not built")
    def test_hlod_path_is_that_of_the_command_line(self):
        """The same nodes and queries in each frame, by strategies that wait and those that predict."""
        hlod, scene = self.path / "city.ohlod", self.path / "city.json"
        street = {"eye": [65, 181, 1.7], "target": [300, 180, 8], "up": [0, 0, 1], "near": 0.2, "far": 1500, "width": 160, "height": 120}
        scene.write_text(json.dumps({"objects": [{"generator": "city", "options": {"blocks": 6, "facade_cells": 2}}],
                                     "cameras": {"default": street},
                                     "paths": {"by": {"frames": 6, "keys": [street, dict(street, eye=[125, 181, 1.7])]}}}))
        subprocess.run([os.environ["OCCLOD"], "hlod", "build", scene, "-o", hlod, "--node-triangles", "64"], check=True, capture_output=True)
        for strategy, device in [("coh", "software"), ("vfc", "software")]:
            done = subprocess.run([os.environ["OCCLOD"], "hlod", "render", hlod, "--scene", scene, "--path", "by", "--strategy", strategy, "--device", device,
                                   "--json"], env=self.environment, capture_output=True, text=True, check=True, timeout=300)
            frames = json.loads(done.stdout)["frames"]
            scene_of_hlod = json.loads(scene.read_text())
            scene_of_hlod["objects"] = [{"mesh": "city.ohlod"}]
            (self.path / "hlod.json").write_text(json.dumps(scene_of_hlod))
            numbers = self.path / "numbers.csv"
            result = self.run_script([
                {"do": "set", "setting": "device", "value": device},
                {"do": "set", "setting": "strategy", "value": strategy},
                {"do": "open", "file": str(self.path / "hlod.json")},
                {"do": "play", "name": "by"},
                {"do": "wait", "for": "path"},
                {"do": "export_csv", "file": str(numbers)}])
            self.assertEqual(result.returncode, 0, result.stderr)
            with open(numbers, newline="") as file:
                shown = {int(row["path_frame"]): row for row in csv.DictReader(file) if row["path_frame"] != "-1"}
            self.assertEqual([shown[frame["frame"]]["hash"] for frame in frames], [frame["hash"] for frame in frames])
            for name in ("drawn_nodes", "rarn", "delayed", "blocked", "queries", "wasted_queries"):
                self.assertEqual([int(shown[frame["frame"]][name]) for frame in frames], [frame[name] for frame in frames], name)

    def test_hlod_within_a_cache(self):
        """All meshes are asked for: what there is no room for does not come, what is damaged is told once."""
        hlod = self.path / "city.ohlod"
        subprocess.run([os.environ["OCCLOD"], "generate", "city", "blocks=6", "facade_cells=2", "-o", self.path / "city.ply"], check=True, capture_output=True)
        subprocess.run([os.environ["OCCLOD"], "hlod", "build", self.path / "city.ply", "-o", hlod, "--node-triangles", "64"], check=True, capture_output=True)
        whole = hlod.read_bytes()
        damaged = bytearray(whole)
        damaged[len(whole) // 2] ^= 1  # in a mesh
        for content, budget, failed in ((whole, 64 << 10, 0), (damaged, 4 << 20, 1)):
            hlod.write_bytes(content)
            result = self.run_script([
                {"do": "set", "setting": "device", "value": "software"},
                {"do": "set", "setting": "strategy", "value": "vfc"},
                {"do": "set", "setting": "hlod_tolerance", "value": 0},
                {"do": "open", "file": str(hlod)},
                {"do": "wait", "for": "refinement"},
                {"do": "report"}], "--memory", str(budget))
            self.assertEqual(result.returncode, 0, result.stderr)
            told = json.loads(result.stdout)
            self.assertEqual((told["cache_budget_bytes"], told["cache_loading_bytes"], told["cache_failed"]), (budget, 0, failed))
            self.assertGreater(told["cache_resident_bytes"], budget / 2 if failed == 0 else 64 << 10)
            self.assertLessEqual(told["cache_resident_bytes"], budget)
            self.assertEqual(told["cache_missing"] > 0, failed == 0, "what has failed is waited for no more")
            lines = [line for line in result.stderr.splitlines() if "is damaged" in line]
            self.assertEqual((len(lines), len(set(lines))), (failed, failed), result.stderr)

    @unittest.skipUnless("BENCH_FRAMES" in os.environ, "SKIPPED: the benchmarks are not built")
    def test_path_is_that_of_the_benchmark(self):
        """bench_frames prints one number of the triangles of all frames: h = 31 h + the hash of the frame."""
        shown, expected = self.played_path(), 0
        for frame in range(8):
            expected = (31 * expected + int(shown[frame]["hash"], 16)) % 2**64
        done = subprocess.run([os.environ["BENCH_FRAMES"], str(self.path / "path"), "--tables", "scenes", "--budgets", "1500", "--no-errors"],
                              env=self.environment, capture_output=True, text=True, check=True, timeout=300)
        rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in done.stdout.splitlines()]
        [row] = [row for row in rows if row[3:5] == ["star", "software"]]
        self.assertEqual(row[-1], f"{expected:016x}")

    def test_failures_are_one_line_that_names_the_action(self):
        for actions, place in [
                ([{"do": "open", "file": "nowhere.ply"}], "/actions/0"),
                ([{"do": "open", "file": str(self.path / "planet.json")}, {"do": "set", "setting": "budget", "value": 3}],
                 "/actions/1/value"),
                ([{"do": "screenshot", "file": "/nonexistent/picture.png"}], "/actions/0"),
                ([{"do": "export_csv", "file": "/nonexistent/numbers.csv"}], "/actions/0"),
                ([{"do": "export_csv", "file": str(self.path / "script.json")}], "script.json is the script"),
                ([{"do": "repeat", "seconds": 1e300, "actions": [{"do": "report"}]}], "/actions/0/seconds"),
                ([{"do": "open", "file": str(self.path / "planet.json")}, {"do": "pan", "right": 1e308, "up": 0}], "/actions/1")]:
            result = self.run_script(actions)
            self.assertEqual(result.returncode, 1, result.stdout)
            self.assertIn(place, result.stderr)
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)

    def test_display_without_opengl_names_the_way_without(self):
        with on_virtual_display.VirtualDisplay("-extension", "GLX") as environment:
            result = view("--settings", str(self.path / "view.json"), environment=environment)
        self.assertEqual(result.returncode, 1)
        self.assertIn("OpenGL", result.stderr)
        self.assertIn("occlod render", result.stderr)

    def preload_losing_driver(self):
        """See tests/support/losing_driver.cpp."""
        self.environment["LD_PRELOAD"] = os.environ["LOSING_DRIVER"]
        if view("--version", environment=self.environment).returncode != 0:
            self.skipTest("SKIPPED: nothing can be preloaded (sanitizers do not allow it)")

    def test_display_without_contexts_that_are_lost(self):
        self.preload_losing_driver()
        self.environment["REFUSE_LOSING_CONTEXTS"] = "1"
        result = self.run_script([{"do": "report"}])
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_context_lost_while_used(self):
        """Whenever the driver tells it: between two pictures, or when one is read back. The settings are kept as ever."""
        self.preload_losing_driver()
        settings = self.path / "view.json"
        screenshots = [{"do": "screenshot", "file": str(self.path / f"{i}.png")} for i in range(20)]
        steps = set()
        for at in range(1000):
            self.environment["LOSE_CONTEXT_AT"] = str(at)
            result = self.run_script([{"do": "open", "file": str(self.path / "planet.json")}, *screenshots], "--settings", str(settings), "--size", "320x240")
            if result.returncode == 0:
                break
            self.assertEqual((result.returncode, result.stderr.count("\n")), (1, 1), result.stderr)
            self.assertRegex(result.stderr, "^occlod-view: error: OpenGL: .*: the context is lost: this program has made the GPU reset; run again")
            steps.add(result.stderr.split(": ")[3])
        self.assertEqual(steps, {"drawing a picture", "reading a picture"})
        self.assertTrue(settings.exists())
        self.assertTrue((self.path / "19.png").exists())

    @unittest.skipUnless("OCCLOD" in os.environ, "SKIPPED: the command line is not built")
    def test_mapped_file_cut_short(self):
        """Pages that are gone raise SIGBUS, on the thread that refines or the one that draws. The viewer waits between two budgets when the file is
        cut short; should it have gone on before, the next attempt counts."""
        mesh, file = self.path / "planet.ply", self.path / "planet.olod"
        for command in (["generate", "rough-planet", "level=7", "-o", mesh], ["build", mesh, "-o", file]):
            subprocess.run([os.environ["OCCLOD"], *command], capture_output=True, check=True, timeout=300)
        whole = file.read_bytes()
        pictures = [self.path / "coarse.png", self.path / "fine.png"]
        (self.path / "script.json").write_text(json.dumps({"actions": [
            {"do": "open", "file": str(file)},
            {"do": "set", "setting": "budget", "value": 1000},
            {"do": "screenshot", "file": str(pictures[0])},
            {"do": "wait", "for": "pictures", "count": 100},
            {"do": "set", "setting": "budget", "value": 100000},
            {"do": "screenshot", "file": str(pictures[1])}]}))
        for _ in range(20):
            file.write_bytes(whole)
            for picture in pictures:
                picture.unlink(missing_ok=True)
            process = subprocess.Popen([VIEW, "--script", str(self.path / "script.json"), "--size", "320x240"], env=self.environment,
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            with process:
                while process.poll() is None and not pictures[0].exists():
                    time.sleep(0.01)
                self.assertIn(str(file), pathlib.Path(f"/proc/{process.pid}/maps").read_text())
                os.kill(process.pid, signal.SIGSTOP)
                os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WEXITED | os.WNOWAIT)
                in_time = not pictures[1].exists()
                os.truncate(file, 4096)
                os.kill(process.pid, signal.SIGCONT)
                output, errors = process.communicate(timeout=300)
            if in_time:
                break
        self.assertEqual((process.returncode, output, errors.count("\n")), (1, "", 1), errors)
        self.assertTrue(errors.startswith(f"occlod-view: error: {file}: was cut short"), errors)
        self.assertFalse(pictures[1].exists())

    def test_closed_standard_error_gets_into_no_file(self):
        """Its number must not go to the connection to the display, nor to a file: the picture is what it is."""
        pictures = [self.path / "open.png", self.path / "closed.png"]
        for picture, redirection in zip(pictures, ("", "2>&-")):
            (self.path / "script.json").write_text(json.dumps({"actions": [
                {"do": "open", "file": str(self.path / "planet.json")}, {"do": "screenshot", "file": str(picture)},
                {"do": "open", "file": "nowhere.ply"}]}))
            done = subprocess.run(f'"$VIEW" --size 320x240 --script "$SCRIPT" {redirection}', shell=True, capture_output=True, check=False, timeout=300,
                                  env=dict(self.environment, VIEW=VIEW, SCRIPT=str(self.path / "script.json")))
            self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual(pictures[0].read_bytes(), pictures[1].read_bytes())

    def test_settings_that_cannot_be_read_are_left_alone(self):
        settings = self.path / "planet.json"
        before = settings.read_bytes()
        result = self.run_script([{"do": "report"}], "--settings", str(settings))
        self.assertEqual((result.returncode, result.stderr.count("\n")), (1, 1), result.stderr)
        self.assertIn("no settings file", result.stderr)
        self.assertEqual(settings.read_bytes(), before)

    def test_signals_end_it_as_closing_the_window_does(self):
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            settings, picture = self.path / f"{number}.json", self.path / f"{number}.png"
            (self.path / "script.json").write_text(json.dumps({"actions": [
                {"do": "set", "setting": "budget", "value": 4321}, {"do": "screenshot", "file": str(picture)},
                {"do": "repeat", "seconds": 300, "actions": [{"do": "wait", "for": "pictures", "count": 1}]}]}))
            with subprocess.Popen([VIEW, "--script", str(self.path / "script.json"), "--settings", str(settings), "--size", "320x240"], env=self.environment,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
                while process.poll() is None and not picture.exists():
                    time.sleep(0.01)
                process.send_signal(number)
                output, errors = process.communicate(timeout=60)
            self.assertEqual((process.returncode, output, errors), (128 + number, "", ""))
            self.assertEqual(json.loads(settings.read_text())["settings"]["budget"], 4321)

    def test_settings_are_remembered(self):
        settings = self.path / "view.json"
        for action, expected in [({"do": "set", "setting": "budget", "value": 4321}, 4321), ({"do": "report"}, 4321)]:
            result = self.run_script([action], "--settings", str(settings))
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(json.loads(settings.read_text())["settings"]["budget"], expected)


if __name__ == "__main__":
    if sys.argv[1:] == ["Script"] and not on_virtual_display.is_available():
        sys.exit(on_virtual_display.SKIPPED)
    unittest.main()
