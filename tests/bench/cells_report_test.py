"""scripts/cells_report.sh --small with built programs (environment variables OCCLOD_TOOL and BENCH_CELLS, a folder): the page needs nothing else, has every table
and figure of the paper, and what it shows is what was measured."""
import csv
import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import unittest

import hlod_report_test

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENE = ROOT / "bench/scenes/small/vlod_city.json"
WALKS = [name for name, path in json.loads(SCENE.read_text())["paths"].items() if not path.get("jump")]
PLACES = 3  # of bench_cell_shrunk and bench_cell_rays


def make_page(folder):
    return subprocess.run([sys.executable, "-B", ROOT / "scripts/cells_page.py", folder], capture_output=True, text=True)


def tables_of(report):
    return {item["table"]: item for part in report["parts"] for item in part["items"] if "table" in item}


def plots_of(report):
    return [item for part in report["parts"] for item in part["items"] if "plot" in item]


def column(table, title):
    return [row[table["titles"].index(title)] for row in table["rows"]]


def lacks(report):
    """Which tables, rows and figures are not there."""
    tables = tables_of(report)
    rows = {"models": 3, "table1": 2, "fig4": 14, "fig10": 2, "fig11": len(WALKS), "codes": 4, "crossings": 1, "shrunk": 2 * PLACES, "cells": 24, "costs": 12, "size": 2 * PLACES,
            "rays": 7 * PLACES, "modelled_cluster": 4, "elsewhere": 3, "hashes": len(WALKS) + 3}
    missing = [name for name, count in rows.items() if name not in tables or len(tables[name]["rows"]) != count]
    found = set(column(tables["goals"], "goal"))
    missing += [f"goal {goal}" for goal in (1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 13, 14, 15) if str(goal) not in found]
    plots = {plot["plot"]: len(plot["lines"]) for plot in plots_of(report)}
    for name, lines in {"fewer_runs": 3, "balls_by_factor": 2, "balls_by_columns": 3, "delta_histogram": 2, "cost_seconds": 3, "cost_bytes": 3, "size_crossing": 4,
                        **{f"frames_vlod_city_{walk}": 5 for walk in WALKS}}.items():
        missing += [name] * (plots.get(name) != lines)
    return missing


class CellsReport(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="occlod-cells-report-")
        cls.addClassCleanup(folder.cleanup)
        cls.out = pathlib.Path(os.environ.get("REPORT_OUT") or folder.name)
        shutil.rmtree(cls.out, ignore_errors=True)  # of an earlier test: nothing is reused
        done = cls.run_report("--small")
        if done.returncode != 0:
            raise AssertionError(done.stderr)
        cls.text = (cls.out / "report.html").read_text()
        cls.page = hlod_report_test.Page(cls.text)
        cls.report = json.loads((cls.out / "report.json").read_text())
        cls.tables = tables_of(cls.report)

    @classmethod
    def run_report(cls, *options, out=None):
        return subprocess.run([ROOT / "scripts/cells_report.sh", "--out", out or cls.out, "--occlod", os.environ["OCCLOD_TOOL"], "--bench", os.environ["BENCH_CELLS"], *options],
                              capture_output=True, text=True)

    def told(self, name):
        return json.loads((self.out / name).read_text())

    def csv_table(self, name, first):
        """The table of a file whose header begins so."""
        text = next(part for part in (self.out / name).read_text().split("\n\n") if part.startswith(first))
        return list(csv.DictReader(text.splitlines()))

    def test_page_needs_nothing_else(self):
        for reference in self.page.references:
            self.assertRegex(reference, "^(data:|#part)")
        self.assertIsNone(re.search(r"https?:|//[a-z]|@import|url\(|fetch\(|import\(", re.sub(r"data:[^\"]*", "", self.text)))

    def test_everything_is_there(self):
        self.assertEqual(lacks(self.report), [])

    def test_tables_show_what_the_json_holds(self):
        self.assertEqual(len(self.page.tables), len(self.tables))
        for shown, table in zip(self.page.tables, self.tables.values()):
            self.assertEqual(shown[0], table["titles"])
            self.assertEqual(len(shown) - 1, len(table["rows"]), table["table"])
            for cells, values in zip(shown[1:], table["rows"]):
                self.assertEqual(len(cells), len(values), values)
                for cell, value in zip(cells, values):
                    self.assert_shown(cell, value)

    def assert_shown(self, cell, value):
        if value is None:
            self.assertEqual(cell, "-")
        elif isinstance(value, str):
            self.assertEqual(cell, value.replace("**", "").replace("`", ""))
        else:
            places = len(cell.partition(".")[2])
            self.assertAlmostEqual(float(cell.replace(",", "")), value, delta=0.5000001 * 10.0**-places)

    def test_csv_holds_the_same(self):
        with open(self.out / "report.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        values = [value for table in self.tables.values() for row in table["rows"] for value in row]
        self.assertEqual([row["value"] for row in rows], ["" if value is None else str(value) for value in values])

    def test_plots_show_what_the_json_holds(self):
        plots = plots_of(self.report)
        self.assertEqual(len(self.page.lines), len(plots))
        for shown, plot in zip(self.page.lines, plots):
            self.assertEqual([name for name, *_ in shown], list(plot["lines"]))
            for (_, points, mean), line in zip(shown, plot["lines"].values()):
                self.assertEqual(points, len(line))
                self.assertAlmostEqual(mean, statistics.mean(y for _, y in line), places=6)

    def test_order_is_what_was_measured(self):
        table = self.tables["table1"]
        for row, measured in zip(table["rows"], self.csv_table("order.csv", "columns,rows")):
            for i, key in ((0, "columns"), (2, "knn_s"), (4, "seed_s"), (6, "fewer_runs_seed"), (8, "fewer_runs_tour"), (11, "fewer_runs_sort"), (12, "sort_s")):
                self.assertEqual(row[i], float(measured[key]), key)
        shares = [float(row["share_mean_pct"]) for row in self.csv_table("order.csv", "columns,within")]
        for matrix in (shares[:7], shares[7:]):
            self.assertEqual(matrix, sorted(matrix))  # larger balls hold more
        self.assertEqual(column(self.tables["fig4"], "mean share, %"), shares)

    def test_deltas_are_what_was_counted(self):
        for row, part in zip(self.tables["fig10"]["rows"], ("t", "t4")):
            walked = self.told(f"vlod_city_{part}_walks.json")
            ratios = [(c["added"] + c["removed"]) / c["drawn"] for path in walked["paths"].values() for c in path["crossings"]]
            self.assertGreater(len(ratios), 3)
            self.assertEqual(row[4], len(ratios))
            self.assertAlmostEqual(row[7], 100 * sum(value > 0.5 for value in ratios) / len(ratios))
        whole = self.told("vlod_city_build.json")["drawn_median"]
        self.assertEqual(column(self.tables["fig10"], "T, triangles"), [round(whole), round(whole) // 4])
        for lines in next(plot for plot in plots_of(self.report) if plot["plot"] == "delta_histogram")["lines"].values():
            self.assertAlmostEqual(sum(share for _, share in lines), 100)

    def test_frames_are_what_was_counted(self):
        walked = self.told("vlod_city_t_walks.json")["paths"]
        for row in self.tables["fig11"]["rows"]:
            frames = walked[row[1]]["frame"]
            self.assertEqual(row[2], len(frames))
            self.assertEqual(row[3], statistics.median(frame["full_in_view"] for frame in frames))
            for frame in frames:
                self.assertLess(frame["lod_in_view"], frame["full_in_view"])
                self.assertLess(frame["vlod_in_view"], frame["lod_in_view"])
                self.assertLessEqual(frame["vlod_in_view"], frame["vlod"])

    def test_costs_are_what_was_measured(self):
        for row in self.tables["costs"]["rows"]:
            scene, mode, tolerance = row[:3]
            build, check = (self.told(f"{scene}_cost_{mode}_{tolerance:g}_{part}.json") for part in ("build", "check"))
            self.assertEqual((build["occlusion"], build["tolerance_px"]), (mode, tolerance))
            self.assertEqual(row[4:7] + row[8:10], [build["cpu_s_per_cell"], build["drawn_mean"], build["bytes_per_cell"], check["pixels"], check["unexplained"]])
            if mode != "sampled":
                self.assertEqual(check["unexplained"], 0)
        for mode in ("none", "hull", "sampled"):  # less is drawn where more may be off
            drawn = [row[5] for row in self.tables["costs"]["rows"] if row[1] == mode]
            self.assertEqual(drawn, sorted(drawn, reverse=True))

    def test_sizes_are_over_what_is_seen(self):
        for row, measured in zip(self.tables["size"]["rows"], self.csv_table("shrunk.csv", "place")):
            self.assertEqual(row[2], float(measured["seen_by_125_eyes"]))
            for i, key in ((3, "drawn_without_occlusion"), (6, "best_drawn"), (7, "hull_drawn")):
                self.assertAlmostEqual(row[i] * row[2], float(measured[key]), places=6)
            self.assertGreaterEqual(row[7], 1)
            self.assertIsNone(row[8])  # takes too long for a test
            self.assertGreaterEqual(row[3], row[7])

    def test_rays_are_what_was_measured(self):
        measured = {(row["place"], row["way"], row["within"]): row for row in self.csv_table("rays.csv", "place")}
        for row in self.tables["rays"]["rows"]:
            end = measured[row[0], row[2], "end"]
            self.assertEqual(row[9:11], [float(end["triangles"]), float(end["missed_pixels"])])
            self.assertAlmostEqual(row[11], 100 * float(end["missed_pixels"]) / float(end["pixels"]))
            if row[2] == "gvs":
                self.assertEqual(row[3], float(measured[row[0], "gvs", "1"]["cpu_ms"]))
                times = [value for value in row[3:7] if value is not None]
                self.assertEqual(times, sorted(times))
            if row[2].startswith("hull") or row[2] == "objects by hull":
                self.assertEqual(row[10], 0, row)
            if row[2].startswith("objects"):  # houses are larger than what is seen of them
                self.assertGreater(row[9], float(measured[row[0], "seen by the judges", "end"]["triangles"]))

    def test_papers_figures_are_beside(self):
        """Some of each, as printed there."""
        text = json.dumps(self.page.tables)
        for figure in ("52,400,000", "four nights on 16 PCs", "228 in 180 cells", "2 to 10", "15 to 40, GeForce 4"):
            self.assertIn(figure, text)
        for figure in ("0.02 s", "5 to 10 %", "less than 10 % of the cases", "25 times smaller"):
            self.assertIn(figure, self.text)

    def changed(self, name, change):
        """What the page would show if this file had been another."""
        with tempfile.TemporaryDirectory() as folder:
            other = pathlib.Path(folder) / "other"
            shutil.copytree(self.out, other, ignore=shutil.ignore_patterns("*.vlod"))
            if change is None:
                (other / name).unlink()
            else:
                (other / name).write_text(change((other / name).read_text()))
            done = make_page(other)
            self.assertEqual(done.returncode, 0, done.stderr)
            return json.loads((other / "report.json").read_text())

    def test_what_is_missing_is_noticed(self):
        for name, what in (("order.csv", "table1"), ("order.csv", "goal 10"), ("shrunk.csv", "size"), ("rays.csv", "goal 15"), ("vlod_city_t4_walks.json", "fig10"),
                           ("vlod_city_t_walks.json", "fig11"), ("vlod_city_viewcells.json", "cells"), ("vlod_city_cost_hull_1_check.json", "costs"), ("cluster.csv", "modelled_cluster")):
            self.assertIn(what, lacks(self.changed(name, None)), name)

    def verdicts(self, report, goal):
        table = tables_of(report)["goals"]
        return [row[4] for row in table["rows"] if row[0] == goal]

    def test_verdicts_follow_from_figures(self):
        def with_gvs(ms):
            def change(text):
                rows = list(csv.DictReader(text.splitlines()))
                for row in rows:
                    if row["way"] == "hull 1 px":
                        row.update(cpu_ms="100.0")
                    if (row["way"], row["within"]) == ("gvs", "0.01"):
                        row.update(cpu_ms=str(ms))
                return "\n".join([",".join(rows[0]), *(",".join(row.values()) for row in rows)])
            return change

        self.assertEqual(self.verdicts(self.changed("rays.csv", with_gvs(501)), "15"), ["met"])
        self.assertEqual(self.verdicts(self.changed("rays.csv", with_gvs(499)), "15"), ["**missed**"])
        wrong = self.changed("vlod_city_cost_hull_1_check.json", lambda text: json.dumps({**json.loads(text), "unexplained": 3}))
        self.assertEqual((self.verdicts(self.report, "1"), self.verdicts(wrong, "1")), (["met"], ["**missed**"]))

    def test_model_is_a_model(self):
        """5 million cells, all cores: c hours; and shards of 30 s, of which the last takes half as long again, and a minute to start."""
        measured = [float(row["one_process_s"]) / float(row["cells"]) for row in self.csv_table("cluster.csv", "run")]
        cell_s = statistics.median(measured)
        for cores, hours, share in self.tables["modelled_cluster"]["rows"]:
            shard = max(30, 3 * cores / 637)
            self.assertAlmostEqual(hours, (5e6 * cell_s / cores + 60 + 1.5 * shard) / 3600)
            self.assertAlmostEqual(share, 100 * 5e6 * cell_s / cores / (3600 * hours))
        self.assertIn("Not measured, but a model", self.text)

    def assert_one_line(self, done, *parts):
        self.assertNotEqual(done.returncode, 0)
        self.assertEqual((done.stdout, done.stderr.count("\n")), ("", 1), done.stderr)
        for part in parts:
            self.assertIn(part, done.stderr)

    def test_wrong_scenes_give_one_line(self):
        with tempfile.TemporaryDirectory() as folder:
            out, plain, broken = (pathlib.Path(folder) / name for name in ("out", "plain.json", "broken.json"))
            plain.write_text(json.dumps({"objects": [], "paths": {"walk": {}}}))
            broken.write_text("{")
            for scene, parts in (("no_such_scene", ("no_such_scene", "name a scene of bench/scenes/small")), (plain, ("plain.json", "no cells with regions")),
                                 (broken, ("broken.json", "is no JSON"))):
                self.assert_one_line(self.run_report("--small", str(scene), out=out), *parts)
                self.assertFalse(out.exists())
        self.assert_one_line(self.run_report("--tiny"), "unknown option --tiny")

    def test_runs_of_another_length_are_not_mixed(self):
        before = sorted(file.name for file in self.out.iterdir())
        self.assert_one_line(self.run_report("--quick"), "holds other scenes or runs of another length")
        self.assertEqual(sorted(file.name for file in self.out.iterdir()), before)


if __name__ == "__main__":
    unittest.main(verbosity=1)
