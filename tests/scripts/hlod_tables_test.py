"""scripts/hlod_tables.py: figures beside the papers', and verdicts that follow from them."""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/hlod_tables.py"
DEVICE = "virtual:modern"


def run_of(strategy, nodes, frame_ms, **more):
    return {"device": DEVICE, "strategy": strategy, "frames": 10, "compared_frames": 2, "drawn_nodes": nodes, "drawn_triangles": 500.0 * nodes, "rarn": 0.0,
            "delayed": 1.0, "queries": 2.0 * nodes, "wasted_queries": 5.0, "frame_ms": frame_ms, "unculled_psnr_y": 44.0, "unculled_psnr_y_deviation": 1.0,
            "unculled_psnr_cb": 60.0, "unculled_psnr_cb_deviation": 1.0, "unculled_psnr_cr": 50.0, "unculled_psnr_cr_deviation": 1.0, "psnr_y": 30.0,
            "crack_px": 0.0, "hash": "0123456789abcdef", **more}


class HlodTables(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="occlod-tables-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.write("about", {"date": "2026-01-01", "machine": "any", "quick": False, "bias": "1,0.1", "effort": {"fronts": 10}})

    def write(self, name, report):
        (self.folder / f"{name}.json").write_text(json.dumps(report))

    def write_runs(self, name, *runs):
        self.write(name, {"scene": "hlod_5m", "path": "walk", "tolerance_px": 1, "bias": {"s": 1, "t": 0.1}, "runs": runs})

    def tables(self):
        return subprocess.run([sys.executable, "-B", SCRIPT, self.folder], check=True, capture_output=True, text=True).stdout

    def verdict(self, what):
        """Of the first row that says so."""
        return next(line for line in self.tables().splitlines() if what in line).split("|")[-2].strip()

    def second_paper(self, **coh):
        return (run_of("bool", 120, 1.2), run_of("sw-b", 100, 2.5), run_of("simp", 110, 1.1), run_of("coh", **{"nodes": 100.4, "frame_ms": 1.0, **coh}))

    def test_verdicts_follow_from_figures(self):
        for change, what, verdict in (({}, "Coh(B) over SW(B), nodes", "met"), ({"nodes": 100.6}, "Coh(B) over SW(B), nodes", "**missed**"),
                                      ({"rarn": 0.05}, "RARN, %", "met"), ({"rarn": 0.06}, "RARN, %", "**missed**"),
                                      ({"delayed": 3.0}, "delayed, %", "met"), ({"delayed": 3.1}, "delayed, %", "**missed**"),
                                      ({}, "speed of Coh(B) over Bool: hlod_5m", "met"), ({"frame_ms": 1.05}, "speed of Coh(B) over Bool: hlod_5m", "**missed**"),
                                      ({}, "PSNR Y of Coh(B) against Bool: hlod_5m", "met"), ({"unculled_psnr_y": 42.9}, "PSNR Y of Coh(B) against Bool: hlod_5m", "**missed**")):
            self.write_runs("second_hlod_5m_walk", *self.second_paper(**change))
            self.assertEqual(self.verdict(what), verdict, (change, what))

    def test_figures_stand_beside_the_papers(self):
        self.write_runs("second_hlod_5m_walk", *self.second_paper())
        row = next(line for line in self.tables().splitlines() if "| Bool |" in line)
        for part in ("120.0 (217.0)", "1.200 (5.886)", "1.20 (1.13)", "0123456789abcdef"):  # 1000 / 169.9; 1.2 / 1; 191.6 / 169.9
            self.assertIn(part, row)

    def test_sessions_are_averages_of_their_paths(self):
        for nodes, path in ((90, "overview"), (100, "rotation"), (110, "close_ups")):
            self.write_runs(f"first_hlod_row_{path}", *(run_of(strategy, nodes, nodes / 100) for strategy in ("sw", "sw-b", "bool", "simp")))
        row = next(line for line in self.tables().splitlines() if "| CHLOD-eps^q |" in line)
        self.assertIn("| 1,000.0 | (72.3) | 100.0 (94.8) |", row)

    def test_equal_errors(self):
        """Shifted groups with a tenth more triangles at every error; nested ones were measured between the tolerances of the others."""
        for tolerance, rms, triangles in ((1, 0.5, 1000), (2, 1.0, 500)):
            self.write_runs(f"rms_hlod_grid_nested_overview_{tolerance}", run_of("vfc", 1, 1, depth_rms_px=rms, drawn_triangles=triangles))
        for tolerance, rms, triangles in ((0.5, 0.25, 2200), (1, 0.5, 1100), (2, 1.0, 550)):
            self.write_runs(f"rms_hlod_grid_shifted_overview_{tolerance}", run_of("vfc", 1, 1, depth_rms_px=rms, drawn_triangles=triangles))
        self.assertIn("1.100 (1.100 to 1.100)", self.tables())

    def test_cracks_are_added_up(self):
        self.write_runs("cracks_hlod_row_shifted_overview", run_of("vfc", 1, 1))
        self.assertEqual(self.verdict("crack pixels, vfc, shifted"), "met")
        self.write_runs("cracks_hlod_row_shifted_rotation", run_of("vfc", 1, 1, crack_px=1.5))
        self.assertIn("3 in 4 frames of 2 paths", self.tables())
        self.assertEqual(self.verdict("crack pixels, vfc, shifted"), "**missed**")

    def test_nothing_was_measured(self):
        self.assertIn("0 met, 0 missed", self.tables())

    def test_all_runs_are_in_one_table(self):
        self.write_runs("second_hlod_5m_walk", *self.second_paper())
        self.tables()
        with open(self.folder / "runs.csv", newline="") as file:
            self.assertEqual([(row["run"], row["strategy"]) for row in csv.DictReader(file)],
                             [("second_hlod_5m_walk", strategy) for strategy in ("bool", "sw-b", "simp", "coh")])


if __name__ == "__main__":
    unittest.main()
