"""The built bench_visibility (environment variable BENCH_VISIBILITY) on a small generated scene: what it writes can be read, its tables agree with each
other, and a second run gives the same."""
import csv
import json
import os
import pathlib
import statistics
import struct
import subprocess
import tempfile
import unittest

SCENE = """{"objects": [{"generator": "rough-planet", "options": {"level": 5}}],
            "cameras": {"default": {"eye": [0, 0, 3], "target": [0, 0, 0], "near": 0.1}, "low": {"eye": [0, 1.2, 0], "target": [0, 0.9, -1]}},
            "paths": {"teleports": {"frames": 6, "jump": true, "keys": [{"eye": [0, 0, 3], "target": [0, 0, 0]}, {"eye": [2, 1, 0], "target": [0, 0, 0]}]},
                      "around": {"frames": 9, "keys": [{"eye": [0, 0, 3], "target": [0, 0, 0]}, {"eye": [3, 0, 0], "target": [0, 0, 0]}]}}}"""
TIMES = ("refine_ms", "occlusion_ms", "draw_ms", "frame_ms", "refine_ms_without", "draw_ms_without", "frame_ms_without", "ratio", "both_ms", "seconds")


class Visibility(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="occlod-bench-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        (cls.folder / "small.json").write_text(SCENE)
        cls.tables = cls.run_bench("first")["visibility"]

    @classmethod
    def run_bench(cls, out, *options, scene="small.json"):
        """The JSON files that it writes, by name."""
        environment = dict(os.environ, XDG_CACHE_HOME=str(cls.folder / "cache"), XDG_DATA_HOME=str(cls.folder / "data"))
        environment.pop("OCCLOD_MESHES", None)
        done = subprocess.run([os.environ["BENCH_VISIBILITY"], "--quick", "--scene", scene, "--out", out, *options], cwd=cls.folder,
                              env=environment, capture_output=True, text=True)
        if done.returncode != 0:
            raise AssertionError(done.stderr)
        cls.stdout, cls.stderr = done.stdout, done.stderr
        return {path.stem: json.loads(path.read_text()) for path in (cls.folder / out).glob("*.json")}

    def rows(self, table, **wanted):
        return [row for row in self.tables[table] if all(row[key] == value for key, value in wanted.items())]

    def test_csv_says_what_json_says(self):
        for name, rows in self.tables.items():
            with open(self.folder / "first" / f"{name}.csv", newline="") as file:
                read = list(csv.DictReader(file))
            self.assertEqual(len(read), len(rows), name)
            for row, text in zip(rows, read):
                for key, value in row.items():
                    self.assertEqual(text[key] if isinstance(value, str) else json.loads(text[key]), value, (name, key))

    def test_every_camera_and_path_is_there(self):
        """Frame 0 of the path that moves is that of the one that jumps; the default camera has another near plane."""
        views = {row["view"] for row in self.tables["shares"]}
        self.assertEqual(views, {"default", "low", "around 0", "around 8", "teleports 3"})

    def test_shares_and_budgets(self):
        self.assertEqual(len(self.tables["shares"]), 5 * 2 * 2 * 2)  # views, cullings, budgets, modes
        for table in ("shares", "quality", "variants"):
            for row in self.tables[table]:
                self.assertLessEqual(row["triangles"], row["budget"])
                self.assertLessEqual(row["visible"], row["triangles"])
                self.assertAlmostEqual(row["share"], 100 * row["visible"] / row["triangles"])
                self.assertTrue(0 < row["share"] <= 100, row)

    def test_smaller_shares_are_found(self):
        self.assertEqual(self.tables["shares_made_smaller"], [row for row in self.tables["shares"] if row["gain"] < 0])
        summary = self.tables["shares_summary"]
        self.assertEqual(sum(row["smaller_paper"] + row["smaller_conservative"] for row in summary), len(self.tables["shares_made_smaller"]))
        self.assertEqual(2 * sum(row["views"] for row in summary), len(self.tables["shares"]))
        for row in summary:
            for mode in ("paper", "conservative"):
                gains = [share["gain"] for share in self.rows("shares", culling=row["culling"], budget=row["budget"], mode=mode)]
                self.assertAlmostEqual(row[f"mean_{mode}"], sum(gains) / len(gains))

    def test_variants_by_scene(self):
        for key in ("share", "queries", "wasted"):
            self.assertEqual([row["small"] for row in self.tables[f"variants_{key}"]], [row[key] for row in self.tables["variants"]])

    def test_tables_agree(self):
        """The same scene, view, budget and options are measured for several tables."""
        [table_2] = self.tables["table_2"]
        for culling, without, with_occlusion in (("subtree", "lod", "lod_oc"), ("star", "ours", "ours_oc")):
            [share] = self.rows("shares", view="default", culling=culling, budget=1000, mode="paper")
            [variant] = self.rows("variants", culling=culling, variant="as it is")
            self.assertEqual((share["visible_without"], share["visible"]), (table_2[without], table_2[with_occlusion]))
            self.assertEqual((variant["visible"], variant["hash"]), (share["visible"], share["hash"]))
            [no_steps] = self.rows("variants", culling=culling, variant="no occluder")
            self.assertEqual((no_steps["visible"], no_steps["queries"]), (share["visible_without"], 0))
        self.assertEqual([row["visible"] for row in self.tables["quality"]], [table_2[way] for way in ("lod", "lod_oc", "ours", "ours_oc")])
        for row in self.tables["variants"]:
            self.assertEqual(row["queries"], row["hidden"] + row["wasted"])

    def test_pictures(self):
        for name in ("small_view.png", "small_birdseye.png"):
            self.assertEqual(struct.unpack(">II", (self.folder / "first" / name).read_bytes()[16:24]), (2 * 160 + 8, 120))

    def test_second_run_is_the_same(self):
        def without_times(tables):
            return {name: [{key: value for key, value in row.items() if key not in TIMES} for row in rows] for name, rows in tables.items()
                    if not name.endswith("_ms")}
        self.assertEqual(without_times(self.run_bench("second")["visibility"]), without_times(self.tables))

    def test_wrongly_hidden(self):
        tables = self.run_bench("hidden", "--wrongly-hidden")["wrongly_hidden"]
        self.assertEqual([row["mode"] for row in tables["wrongly_hidden"]], ["paper", "conservative"])
        for row in tables["wrongly_hidden"]:
            views = [view["pixels"] for view in tables["wrongly_hidden_views"] if view["mode"] == row["mode"]]
            self.assertEqual((row["views_with_any"], row["sum_px"], row["largest_px"]), (len(views), sum(views), max(views, default=0)))
            self.assertEqual(row["random_views"], 3)
            self.assertLessEqual(row["largest_allowed_px"], 2.0)

    def test_paper(self):
        """The same view as that of small.json; random views are those in which about as much is visible as in the paper's."""
        (self.folder / "planet_full.json").write_text(SCENE)
        tables = self.run_bench("paper", "--paper", scene="planet_full.json")["paper"]
        [scene], [small] = tables["paper_table_2"], self.tables["table_2"]
        self.assertEqual([scene[key] for key in ("lod", "oc", "ours", "ours_oc")], [small[key] for key in ("lod", "lod_oc", "ours", "ours_oc")])
        self.assertEqual((scene["paper_lod"], scene["paper_oc"]), (3546, 4781))
        for choice in tables["paper_choices"]:
            views = [row for row in tables["paper_views"] if row["variant"] == choice["variant"]]
            [figure] = [row["with"] for row in views if row["view"] == "figure"]
            random = [row for row in views if row["view"] != "figure"]
            self.assertEqual((figure, len(random)), (choice["with"], scene["kept"]))
            self.assertTrue(0 < len(random) < scene["views"])
            for row in random:
                self.assertLessEqual(abs(row["without"] - 354.6), 35.46)
                self.assertAlmostEqual(row["improvement_pct"], 100 * (row["with"] / row["without"] - 1))
            quartiles = statistics.quantiles([row["improvement_pct"] for row in random], n=4, method="inclusive")
            for key, quartile in zip(("lower_pct", "median_pct", "upper_pct"), quartiles):
                self.assertAlmostEqual(choice[key], quartile)
        queries = {choice["variant"]: choice["queries"] for choice in tables["paper_choices"]}
        self.assertGreater(queries["every level"], 1.5 * queries["as published"])
        [published] = [choice for choice in tables["paper_choices"] if choice["variant"] == "as published"]
        self.assertEqual((scene["ir_pct"], scene["median_ir_pct"]), (published["improvement_pct"], published["median_pct"]))

    def test_missing_mesh_is_told(self):
        (self.folder / "gone.json").write_text("""{"objects": [{"mesh": "nowhere.ply"}], "cameras": {"default": {"eye": [0, 0, 3], "target": [0, 0, 0]}}}""")
        self.assertEqual(self.run_bench("gone", scene="gone.json"), {})
        self.assertIn("SKIPPED: gone: nowhere.ply", self.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=1)
