"""scripts/hlod_tables.py: figures beside the papers', and verdicts that follow from them."""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts"
SCRIPT = SCRIPTS / "hlod_tables.py"
sys.path.insert(0, str(SCRIPTS))
import hlod_runs  # noqa: E402
import hlod_table4  # noqa: E402

DEVICE = "virtual:modern"


def run_of(strategy, nodes, frame_ms, **more):
    return {"device": DEVICE, "strategy": strategy, "frames": 10, "compared_frames": 2, "drawn_nodes": nodes, "drawn_triangles": 500.0 * nodes, "rarn": 0.0,
            "delayed": 1.0, "queries": 2.0 * nodes, "wasted_queries": 5.0, "frame_ms": frame_ms, "largest_frame_ms": 2 * frame_ms, "unculled_psnr_y": 44.0, "unculled_psnr_y_deviation": 1.0,
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

    def cracks(self, *options):
        """The --reference of each crack run that an occlod that draws nothing was asked for."""
        log, occlod = self.folder / "log", self.folder / "occlod"
        log.write_text("")
        occlod.write_text(f"""#!{sys.executable}
import json, sys
words = sys.argv[1:]
if "--reference" in words:
    frames = words[words.index("--reference") + 1]
    print(frames, file=open({str(log)!r}, "a"))
    print(json.dumps({{"runs": [{{"compared_frames": int(frames)}}]}}))
else:
    print("{{}}")
""")
        occlod.chmod(0o755)
        done = subprocess.run([sys.executable, "-B", SCRIPTS / "hlod_runs.py", "--occlod", occlod, "--compare", occlod, "--cover", occlod, "--out", self.folder / "out",
                               "--quick", "--only", "cracks", *options], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return log.read_text().split()

    def test_cracks_are_counted_in_as_many_frames_as_asked_for(self):
        """In two scenes, with three paths and two kinds of groups each; a run of another length is not reused."""
        self.assertEqual(self.cracks(), ["2"] * 12)
        self.assertEqual(self.cracks("--reuse"), [])
        self.assertEqual(self.cracks("--reuse", "--crack-frames", "5"), ["5"] * 12)
        self.assertEqual(self.cracks("--reuse", "--crack-frames", "5"), [])
        done = subprocess.run([sys.executable, "-B", SCRIPTS / "hlod_runs.py", "--occlod", "x", "--compare", "x", "--cover", "x", "--out", self.folder, "--crack-frames", "0"],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("--crack-frames: '0' is not a whole number above 0", done.stderr)

    def write_table_4(self, **changes):
        """Every frame of a strategy takes as long; all ratios are exactly what is asked."""
        ms = {"vfc": 2.0, "bool": 1.5, "coh": 1.5, "chc++": 1.4, "nohc": 1.12, "optimum": 1.0, "two-pass": 1.06, "cesium": 1.0, "batch": 0.95, "auto": 0.95}
        wasted = {"bool": 40.0, "nohc": 10.0}
        runs = [{**run_of(s, 50, ms[s]), "wasted_queries": wasted.get(s, 0.0), "drawn_triangles": 1000.0 if s == "cesium" else 600.0, **changes.get(s, {})} for s in ms]
        self.write_runs("table4_city", *runs)
        lines = [f"{DEVICE},{run['strategy']},{frame},{run['frame_ms']},{'batch' if frame < 30 else 'vfc'}" for run in runs for frame in range(40)]
        (self.folder / "table4_city.csv").write_text("\n".join(["device,strategy,frame,frame_ms,drawn_by", *lines]) + "\n")

    def test_verdicts_on_culling(self):
        for strategy, change, what, verdict in (("nohc", {}, "NOHC / optimum, p_cov as printed", "met"), ("nohc", {"frame_ms": 1.13}, "NOHC / optimum, p_cov as printed", "**missed**"),
                                                ("nohc", {}, "wasted queries of NOHC", "met"), ("nohc", {"wasted_queries": 10.1}, "wasted queries of NOHC", "**missed**"),
                                                ("nohc", {"frame_ms": 2.03}, "worst 30 frames", "met"), ("nohc", {"frame_ms": 2.05}, "worst 30 frames", "**missed**"),
                                                ("batch", {}, "batch / optimum, geometric mean", "met"), ("batch", {"frame_ms": 0.96}, "batch / optimum, geometric mean", "**missed**"),
                                                ("batch", {"frame_ms": 1.02}, "batch / optimum, anywhere", "met"), ("batch", {"frame_ms": 1.03}, "batch / optimum, anywhere", "**missed**"),
                                                ("auto", {"frame_ms": 0.97}, "auto / best fixed strategy, anywhere", "met"),
                                                ("auto", {"frame_ms": 0.98}, "auto / best fixed strategy, anywhere", "**missed**"),
                                                ("auto", {"frame_ms": 2.03}, "auto / VFC", "met"), ("auto", {"frame_ms": 2.05}, "auto / VFC", "**missed**"),
                                                ("batch", {}, "time of batch / of two-pass", "met"), ("batch", {"frame_ms": 0.96}, "time of batch / of two-pass", "**missed**"),
                                                ("batch", {}, "triangles of batch / of cesium", "met"), ("batch", {"drawn_triangles": 601.0}, "triangles of batch / of cesium", "**missed**")):
            self.write_table_4(**{strategy: change})
            self.assertEqual(self.verdict(what), verdict, (strategy, change, what))

    def test_windows_from_above_count_too(self):
        self.write_table_4()
        for ms, verdict in ((2.04, "met"), (2.05, "**missed**")):
            lines = [f"{DEVICE},{strategy},{frame},{time}" for strategy, time in (("vfc", 2.0), ("nohc", ms)) for frame in range(40)]
            (self.folder / "figure8_city.csv").write_text("\n".join(["device,strategy,frame,frame_ms", *lines]) + "\n")
            self.assertEqual(self.verdict("worst 30 frames"), verdict)

    def test_corrected_probability_is_compared_with_the_same_optimum(self):
        self.write_table_4()
        for ms, verdict in ((1.08, "met"), (1.09, "**missed**")):
            self.write_runs("table4corrected_city", run_of("nohc", 50, ms))
            self.assertEqual(self.verdict("p_cov as corrected"), verdict)

    def test_what_auto_chose(self):
        self.write_table_4(auto={"forecast_batch_ms": 0.5})
        row = next(line for line in self.tables().splitlines() if line.startswith("| city | modern | batch 75 %, VFC 25 % |"))
        self.assertIn("| 0.500 / 0.950 |", row)
        self.assertTrue(row.endswith("| 0.950 | batch | 1.000 |"), row)

    def test_splits_or_hlods(self):
        def way(name, triangles, ms, below, **more):
            return {"way": name, "triangles": triangles, "ms": ms, "draw_ms": 20.0, "depth_rms_px": 0.5, "tolerance_px": 1.0, "queries": 7.0, "pays_below_ns": below,
                    "pays_above_ns": "infinite", **more}
        splits = {"way": "splits", "triangles": 1e5, "ms": 100.0, "draw_ms": 20.0, "depth_rms_px": 0.5}
        for triangles, ms, verdicts in ((1.6e5, 20.0, ("met", "met")), (1.7e5, 21.0, ("**missed**", "**missed**"))):
            self.write("splits_hlod_12m", {"splits_or_hlod": [splits, way("HLOD, vfc", triangles, ms, 1234.5)]})
            self.assertEqual((self.verdict("over splits at equal error, ms"), self.verdict("over splits at equal error, triangles")), verdicts)
        self.write("splits_city", {"splits_or_hlod": [splits, way("HLOD, vfc", 2e5, 1.0, "infinite"), way("HLOD, coh", 2e5, 1.0, None), way("HLOD, x", 1.0, 900.0, 0, pays_above_ns=8.0),
                                                      way("HLOD, y", 2e5, 900.0, 0)]})
        rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in self.tables().splitlines()]
        self.assertEqual([row[6] for row in rows if len(row) == 8 and row[2].startswith("HLOD, ")], ["any", "-", "above 8", "never", "1,234"])
        self.assertIn(["city", "0.500", "splits", "100,000", "100.000", "", "", "200"], rows)

    def test_windows_slide(self):
        """Slower in 30 of 60 frames, by half."""
        self.assertAlmostEqual(hlod_table4.worst_window([1.0] * 15 + [1.5] * 30 + [1.0] * 15, [1.0] * 60), 1.5)
        self.assertAlmostEqual(hlod_table4.worst_window([1.0, 2.0], [1.0, 1.0]), 1.5)

    def test_their_ratios(self):
        """Of all cards and scenes: 1.128, 1.50 and 2.62 were reckoned by hand."""
        for strategy, mean in (("nohc", 1.128), ("bool", 1.500), ("vfc", 2.623)):
            self.assertAlmostEqual(hlod_table4.geometric_mean(hlod_table4.paper_ratios(hlod_table4.PAPER_TABLE, strategy)), mean, places=3)

    def test_covered_boxes(self):
        cells = [{"objects": 30, "hidden": 0.5, "printed": 0.4, "corrected": 0.9}, {"objects": 10, "hidden": 1.0, "printed": 0.8, "corrected": 1.0}]
        self.write("cover_city", {"by_coverage": cells, "hash": "ab", "models": {"printed": {"difference": 0.1}, "corrected": {"difference": None}}})
        self.assertIn("| city | 40 | 0.625 | 0.500 | 0.925 | 0.100 | - | ab |", self.tables())

    def test_part_of_a_path_is_as_fast(self):
        keys = [{"eye": [i, 0, 0]} for i in range(9)]
        (self.folder / "scene.json").write_text(json.dumps({"objects": [], "paths": {"walk": {"frames": 160, "keys": keys}, "other": {}}}))
        part = hlod_runs.part_of_path(self.folder / "scene.json", "walk", 0.25, self.folder / "part.json")
        self.assertEqual(json.loads(part.read_text()), {"objects": [], "paths": {"walk": {"frames": 40, "keys": keys[:3]}}})

    def test_options_are_looked_at_before_anything_is_built(self):
        for options, line in ((("--only", "table4,tabel4"), "there is no 'tabel4': second, first, "), (("--crack-frames", "no"), "'no' is not a whole number above 0"),
                              (("--only",), "--only needs a value"), (("--fast",), "unknown option --fast")):
            done = subprocess.run([SCRIPTS / "hlod_tables.sh", *options], capture_output=True, text=True)
            self.assertEqual(done.returncode, 2, options)
            self.assertIn(line, done.stderr)

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
