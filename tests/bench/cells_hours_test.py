"""scripts/cells_hours.py: a run that is stopped is gone on with, to the bytes of one that was not, and its table counts what is there."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = ROOT / "bench" / "scenes" / "small" / "vlod_city_one.json"
sys.path.insert(0, str(ROOT / "scripts"))
import cells_hours as hours  # noqa: E402


class Hours(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="occlod-hours-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        os.environ["XDG_CACHE_HOME"] = str(self.folder)

    def run_hours(self, work):
        command = [sys.executable, "-B", ROOT / "scripts" / "cells_hours.py", SCENE, "--occlod", os.environ["OCCLOD_TOOL"], "--work", work]
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_goes_on_where_it_was_stopped(self):
        work = self.folder / "work"
        whole = self.run_hours(work)
        self.assertIn("| cells there | 96 |", whole)
        self.assertIn("| of these, of this run | 96 |", whole)
        self.assertIn("*an extrapolation*", whole)
        expected = (work / "cells.vlod").read_bytes()
        parts = sorted(work.glob("*.vpart"))
        self.assertEqual(len(parts), 6)
        # As a run that was stopped leaves it: some parts are not there, and nothing is merged.
        for lost in (parts[1], parts[4], work / "cells.vlod"):
            lost.unlink()
        again = self.run_hours(work)
        self.assertIn("| of these, of this run | 32 |", again)
        self.assertEqual((work / "cells.vlod").read_bytes(), expected)

    def test_a_run_without_time_says_so(self):
        rows = list(hours.table([(10.0, 16), (20.0, 16), (28.0, 16)], 15.0, 2, False))
        self.assertIn("| cells there, not yet all | 48 |", rows)
        self.assertIn("| seconds a cell, on 2 cores | 0.5 |", rows)
        self.assertIn("| seconds a cell and core | 1 |", rows)
        self.assertIn("| hours for a million cells on 2 cores, *an extrapolation* | 139 |", rows)
        self.assertIn("| seconds a cell and core | too few parts to tell |", list(hours.table([(10.0, 16)], 5.0, 2, False)))


if __name__ == "__main__":
    unittest.main()
