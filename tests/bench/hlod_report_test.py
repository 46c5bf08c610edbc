"""scripts/hlod_report.sh --small with built programs (environment variables OCCLOD_TOOL and COVER_PROBABILITY): the page needs nothing else, has every table
and figure of the papers, and what it shows is what was measured."""
import csv
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import report_test

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
import hlod_table4  # noqa: E402
import hlod_tables  # noqa: E402

PRESETS = ["virtual:query-cheap", "virtual:query-dear", "virtual:fill-bound", "virtual:modern"]


class Page(report_test.Page):
    """And the lines of plots: by plot, (name, points, mean)."""

    def __init__(self, text):
        self.lines = []
        super().__init__(text)

    def handle_starttag(self, tag, attributes):
        super().handle_starttag(tag, attributes)
        attributes = dict(attributes)
        if tag == "svg" and "plot" in (attributes.get("class") or "").split():
            self.lines.append([])
        if "data-line" in attributes:
            self.lines[-1].append((attributes["data-line"], int(attributes["data-points"]), float(attributes["data-mean"])))

    def table(self, *titles):
        """The first whose header begins so."""
        return next((table for table in self.tables if table[0][:len(titles)] == list(titles)), None)


def scene_tables(page, scene):
    """Table 4 of a scene: with levels of detail and without."""
    return [table for table in page.tables if table[0][0].startswith(f"{scene}, ")]


def lacks(page):
    """Which tables and figures the page has not."""
    missing = []
    first = [table for table in page.tables if table[0][-1] == "hashes"]
    second = [table for table in page.tables if "speed-up of Coh" in table[0] and table[0][0] == "device"]
    for name, found, wanted in (("Charalambos 2006, table 1", first, 3), ("Charalambos 2007, table 1", second, 6)):
        missing += [name] * (len(found) != wanted)
    for name, titles, rows in (("goals", ("goal", "", "met", "missed"), 7), ("scenes", ("scene", "triangles", "nodes, nested (most triangles each)"), 5),
                               ("speed", ("", "hlod_row"), 3), ("PSNR", ("scene", "device", "frames", "Y"), 4), ("bias sweep", ("s, t",), 8),
                               ("Guthe, table 3", ("scene", "triangles", "nodes", "theirs"), 4), ("ratios", ("", "plant (Power Plant)"), 11), ("lengths", ("scene", "frames", "p_cov as printed"), 8),
                               ("choices of auto", ("scene", "device", "chosen"), 16), ("fig. 3", ("", "boxes", "covered"), 5)):
        table = page.table(*titles)
        missing += [name] * (table is None or len(table) != rows + 1)
    for scene, theirs in hlod_table4.SCENES.items():
        missing += [f"table 4: {scene}"] * ([len(table) - 1 for table in scene_tables(page, scene)] != [11, 4])
        missing += [f"table 4: {theirs}"] * (page.table(theirs, "9800XT") is None)
    missing += ["figures"] * (len(page.lines) != 6 + 4 + 1 + 2 + 2 or not all(page.lines))
    return missing


class HlodReport(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="occlod-hlod-report-")
        cls.addClassCleanup(folder.cleanup)
        cls.out = pathlib.Path(os.environ.get("REPORT_OUT") or folder.name)
        shutil.rmtree(cls.out, ignore_errors=True)  # of an earlier test: nothing is reused
        done = subprocess.run([ROOT / "scripts/hlod_report.sh", "--small", "--out", cls.out, "--occlod", os.environ["OCCLOD_TOOL"],
                               "--compare", os.environ["HLOD_COMPARE"], "--cover", os.environ["COVER_PROBABILITY"]], capture_output=True, text=True)
        if done.returncode != 0:
            raise AssertionError(done.stderr)
        cls.stderr = done.stderr
        cls.text = (cls.out / "report.html").read_text()
        cls.page = Page(cls.text)
        cls.results = hlod_tables.Results(cls.out)

    def test_page_needs_nothing_else(self):
        for reference in self.page.references:
            self.assertRegex(reference, "^(data:|#part)")
        self.assertIsNone(re.search(r"https?:|//[a-z]|@import|url\(|fetch\(|import\(", re.sub(r"data:[^\"]*", "", self.text)))

    def test_everything_is_there(self):
        self.assertEqual(lacks(self.page), [])
        skipped = [line for line in self.stderr.splitlines() if "SKIPPED" in line and not re.search("SKIPPED (llvmpipe|table4gl)", line)]
        self.assertEqual(skipped, [])

    def test_what_is_missing_is_noticed(self):
        for name, what in (("table4_city.json", "table 4: city"), ("first_hlod_row_rotation.json", "Charalambos 2006, table 1"), ("cover_plant.json", "fig. 3"),
                           ("bias_1_0.json", "bias sweep"), ("figure8_city.csv", "figures"), ("ours_hlod_5m_walk.json", "Charalambos 2007, table 1")):
            with tempfile.TemporaryDirectory() as folder:
                less = pathlib.Path(folder) / "less"
                shutil.copytree(self.out, less, ignore=shutil.ignore_patterns(name, "*.ohlod"))
                subprocess.run([sys.executable, "-B", ROOT / "scripts/hlod_page.py", less], check=True, capture_output=True)
                self.assertIn(what, lacks(Page((less / "report.html").read_text())), name)

    def test_table_4_shows_what_was_measured(self):
        for scene in hlod_table4.SCENES:
            runs, by_gl = self.results.runs(f"table4_{scene}"), self.results.runs(f"table4gl_{scene}")
            self.assertEqual({device for device, _ in runs}, set(PRESETS))
            table = scene_tables(self.page, scene)[0]
            for row in table[1:]:
                strategy = next(s for s, name in hlod_table4.NAMES.items() if name == row[0])
                run, drawn_by = (f"table4printed_{scene}", "nohc") if strategy == "printed" else (f"table4_{scene}", strategy)
                for shown, device in zip(row[1:5], PRESETS):
                    frames = [float(frame["frame_ms"]) for frame in self.results.frames(run)[device, drawn_by]]
                    mean, largest = map(float, shown.split(" / "))
                    self.assertAlmostEqual(mean, sum(frames) / len(frames), delta=0.0006)
                    self.assertAlmostEqual(largest, max(frames), delta=0.0006)
                    self.assertGreater(mean, 0)
                self.assertEqual(row[5], hlod_table4.times(by_gl["gl", strategy]) if ("gl", strategy) in by_gl else "-")

    def test_papers_figures_are_beside(self):
        """Some of each, as printed there."""
        text = json.dumps(self.page.tables)
        for figure in ("(72.3)", "159.3)", "(468.5)", "(5.219)", "42.84 +- 3.22", "59.34 +- 1.55", "19.96 / 2580.62", "6.37 / 6.96", "12,748,510"):
            self.assertIn(figure, text)
        self.assertEqual(self.page.table("", "plant (Power Plant)")[-3], ["NOHC, theirs", "1.211", "1.102", "1.064", "1.141", "1.128"])

    def test_lines_are_the_frames(self):
        """Of fig. 2 of 2006 (frames a second), fig. 4 of 2007 (nodes) and fig. 8 of Guthe and others (ms)."""
        def frames(run, device, strategy):
            with open(self.out / f"{run}.csv", newline="") as file:
                return [row for row in csv.DictReader(file) if (row["device"], row["strategy"]) == (device, strategy)]
        session = [row for path in ("overview", "rotation", "close_ups") for row in frames(f"first_hlod_row_{path}", PRESETS[1], "simp")]
        for lines, name, values in ((self.page.lines[0], "CHLOD-eps^q", [1e3 / float(row["frame_ms"]) for row in session]),
                                    (self.page.lines[6], "Coh(B)", [float(row["drawn_nodes"]) for row in frames("second_hlod_5m_walk", PRESETS[1], "coh")]),
                                    (self.page.lines[12], "NOHC", [float(row["frame_ms"]) for row in frames("figure8_city", PRESETS[1], "nohc")])):
            found = next(line for line in lines if line[0] == name)
            self.assertEqual(found[1], len(values))
            self.assertGreater(len(values), 5)
            self.assertAlmostEqual(found[2], sum(values) / len(values), places=6)

    def test_auto_is_explained(self):
        for row in self.page.table("scene", "device", "chosen")[1:]:
            shares = [int(share) for share in re.findall(r"(\d+) %", row[2])]
            self.assertAlmostEqual(sum(shares), 100, delta=2)
            self.assertRegex(row[3], r"^\d+\.\d{3} / \d+\.\d{3}$")  # batch, which is drawn by first

    def test_summary_adds_up(self):
        verdicts = [row[-1] for row in self.page.table("goal", "what", "asked", "figure", "verdict")[1:]]
        summary = self.page.table("goal", "", "met", "missed")[1:]
        self.assertEqual([row[0] for row in summary], [str(goal) for goal in range(1, 8)])
        for column, verdict in ((2, "met"), (3, "missed")):
            self.assertEqual(sum(int(row[column]) for row in summary), verdicts.count(verdict))
        for row in summary:
            self.assertGreater(int(row[2]) + int(row[3]), 0, row)

    def test_runs_of_another_length_are_not_mixed(self):
        before = sorted(file.name for file in self.out.iterdir())
        done = subprocess.run([sys.executable, "-B", ROOT / "scripts/hlod_runs.py", "--occlod", "none", "--compare", "none", "--cover", "none", "--out", self.out, "--quick", "--reuse"],
                              capture_output=True, text=True)
        self.assertNotEqual(done.returncode, 0)
        self.assertRegex(done.stderr, "^hlod_runs.py: .*holds runs of another length.*\n$")
        self.assertEqual(sorted(file.name for file in self.out.iterdir()), before)


if __name__ == "__main__":
    unittest.main(verbosity=1)
