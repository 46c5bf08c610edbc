"""bench_viewcells on a small scene: it runs, measures every path, and gives the same cuts and walks each time; scripts/viewcells_table.py judges it."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = ROOT / "bench" / "scenes" / "small" / "vlod_city.json"
sys.path.insert(0, str(ROOT / "scripts"))
import viewcells_table as table  # noqa: E402


def run(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise AssertionError(f"{command}: {done.stderr}")
    return done.stdout


class SmallCity(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as folder:
            os.environ["XDG_CACHE_HOME"] = folder
            cells = pathlib.Path(folder) / "city.vlod"
            run(os.environ["OCCLOD_TOOL"], "cells", "build", SCENE, "-o", cells, "--image", "1024x768,60,0.1")
            cls.runs = [json.loads(run(os.environ["BENCH_VIEWCELLS"], cells, SCENE, "--quick")) for _ in range(2)]

    def test_measures_each_path(self):
        measured = self.runs[0]
        paths = json.loads(SCENE.read_text())["paths"]
        self.assertEqual(set(measured["paths"]), {name for name, path in paths.items() if not path.get("jump")})
        for name, path in measured["paths"].items():
            self.assertEqual(path["frames"], paths[name]["frames"])
            self.assertEqual(path["outside"], 0, name)
            self.assertEqual(path["compared"]["unexplained_px"], 0, name)
        self.assertGreater(sum(path["crossings"] for path in measured["paths"].values()), 3)
        self.assertGreater(sum(path["late_without_prefetch"] for path in measured["paths"].values()), 0)
        self.assertEqual(measured["teleports"]["empty_frames"], 0)
        self.assertEqual(measured["cuts"]["differ_from_file"], 0)

    def test_gives_the_same_each_time(self):
        one, other = self.runs
        self.assertEqual(one["cuts"]["hash"], other["cuts"]["hash"])
        for name, path in one["paths"].items():
            self.assertEqual(path["compared"]["over_update"], other["paths"][name]["compared"]["over_update"], name)

    def test_is_judged(self):
        text = table.table(self.runs[0])
        for goal in ("2", "4", "5", "6", "7", "11", "13", "14"):
            self.assertIn(f"\n| {goal} | ", text)
        self.assertEqual({row[0] for row in table.rows(self.runs[0])} - {"-"}, {"2", "4", "5", "6", "7", "11", "13", "14"})

    def test_verdicts_are_on_the_right_side(self):
        def verdicts(change):
            changed = json.loads(json.dumps(self.runs[0]))
            change(changed)
            return {row[1]: row[4] for row in table.rows(changed)}

        def walk(name, key, value):
            return lambda measured: measured["paths"][name].update({key: value})

        late = next(row[1] for row in table.rows(self.runs[0]) if row[0] == "13")
        self.assertFalse(verdicts(walk("walk", "late", 1))[late])
        seconds = "seconds a cell and core: median, most"
        for most, met in ((2.9, True), (3.1, False)):
            self.assertEqual(verdicts(lambda measured: measured["cuts"].update({"seconds": {"median": 0.5, "largest": most}}))[seconds], met)
        ms = "frame without drawing, 99th percentile, ms"
        for p99, met in ((3.9, True), (4.1, False)):
            self.assertEqual(verdicts(lambda measured: [path.update({"frame_ms": {"p99": p99}}) for path in measured["paths"].values()])[ms], met)


if __name__ == "__main__":
    unittest.main(verbosity=1)
