"""scripts/report.sh --small with the built bench_report (environment variable BENCH_REPORT): the page needs nothing else, every plot has its points
where its axes say, page, CSV and JSON agree, and what is recommended follows from the points."""
import base64
import csv
import html.parser
import io
import json
import math
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Page(html.parser.HTMLParser):
    """Links and other references, plots with their points, and the cells of tables."""

    def __init__(self, text):
        super().__init__()
        self.references, self.plots, self.tables, self.marked, self.in_cell = [], [], [], [], False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.references += [attributes[key] for key in ("src", "href", "xlink:href", "srcset", "data") if key in attributes]
        classes = (attributes.get("class") or "").split()
        if tag == "svg" and "plot" in classes:
            self.plots.append((attributes, [], []))
        if tag == "g" and "data-setting" in attributes:
            self.plots[-1][1].append(attributes)
        if "data-at" in attributes:
            self.plots[-1][2].append(attributes)
        if "data-marked" in attributes:
            self.marked.append(attributes["data-marked"])
        if tag == "table":
            self.tables.append([])
        if tag == "tr":
            self.tables[-1].append([])
        if tag in ("td", "th"):
            self.in_cell = True
            self.tables[-1][-1].append("")

    def handle_endtag(self, tag):
        if tag in ("td", "th"):
            self.in_cell = False

    def handle_data(self, data):
        if self.in_cell:
            self.tables[-1][-1][-1] += data


def front(points, key, more_is_better):
    """Straight from the definition: those that no other is at least as good as in both and better in one."""
    def error(p):
        return -p[key] if more_is_better else p[key]
    known = [p for p in points if p[key] is not None]
    return {p["setting"] for p in known
            if not any(q["ms"] <= p["ms"] and error(q) <= error(p) and (q["ms"], error(q)) != (p["ms"], error(p)) for q in known)}


class Report(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="occlod-report-")
        cls.addClassCleanup(folder.cleanup)
        cls.out = pathlib.Path(os.environ.get("REPORT_OUT") or folder.name)
        done = subprocess.run([ROOT / "scripts/report.sh", "--small", "--bench", os.environ["BENCH_REPORT"], "--out", cls.out], capture_output=True, text=True)
        if done.returncode != 0:
            raise AssertionError(done.stderr)
        cls.stdout, cls.stderr = done.stdout, done.stderr
        cls.text = (cls.out / "report.html").read_text()
        cls.page = Page(cls.text)
        cls.json = json.loads((cls.out / "report.json").read_text())
        cls.measures = [m for m in cls.json["measures"] if any(p[m["key"]] is not None for p in cls.json["points"])]
        cls.points = {scene: [p for p in cls.json["points"] if p["scene"] == scene] for scene in ["all"] + [s["name"] for s in cls.json["scenes"]]}

    def test_page_needs_nothing_else(self):
        self.assertGreater(len(self.page.references), 2)
        for reference in self.page.references:
            self.assertTrue(reference.startswith("data:"), reference[:80])
        self.assertIsNone(re.search(r"https?:|//[a-z]|@import|url\(|fetch\(|import\(", re.sub(r"data:[^\"]*", "", self.text)))

    def test_pictures_are_those_beside_it(self):
        embedded = [base64.b64decode(r.split(",", 1)[1]) for r in self.page.references if r.startswith("data:image/png")]
        self.assertEqual(embedded, [(self.out / p["file"]).read_bytes() for p in self.json["pictures"]])
        self.assertGreaterEqual(len(embedded), 3 * len(self.json["scenes"]))  # full mesh and two settings at least
        self.assertGreaterEqual(len(set(embedded)), 3 * len(self.json["scenes"]))

    def test_every_plot_has_its_points(self):
        """The main plot, the same by triangles, each other measure and each scene; a point for each setting that was measured, with the value of the JSON."""
        keys = [m["key"] for m in self.measures]
        wanted = [("all", "ms", keys[0]), ("all", "triangles", keys[0])] + [("all", "ms", key) for key in keys[1:]]
        wanted += [(s["name"], "ms", keys[0]) for s in self.json["scenes"]]
        self.assertEqual(len(self.page.plots), len(wanted))
        for (scene, x, key), (attributes, shown, _) in zip(wanted, self.page.plots):
            self.assertEqual((attributes["data-x"], attributes["data-y"]), (x, key))
            values = {p["setting"]: (p[x], p[key]) for p in self.points[scene] if p[key] is not None}
            if key != "max_error_px":  # unlimited where the eye is inside of bounds
                self.assertGreater(len(values), 30)
            self.assertEqual({p["data-setting"]: (float(p["data-x"]), float(p["data-y"])) for p in shown}, values, (scene, key))

    def test_points_are_where_the_axes_say(self):
        """Pixels of points and grid lines are one straight line of the values or their logarithms, times to the right, values upwards."""
        def numbers(text):
            return tuple(map(float, re.findall(r"-?[\d.]+", text)))
        for attributes, shown, grid in self.page.plots:
            for axis, sign in ((0, 1), (1, -1)):
                placed = [(float(p["data-y" if axis else "data-x"]), numbers(p["transform"])[axis]) for p in shown]
                lines = [(float(line["data-at"]), numbers(line["d"])[axis]) for line in grid if line["data-axis"] == str(axis)]
                self.assertGreaterEqual(len(lines), 2)
                if attributes["data-log"][axis] == "1":
                    floor = float(attributes["data-floor"])
                    placed, lines = ([(math.log(max(value, floor)), pixel) for value, pixel in pairs] for pairs in (placed, lines))
                (low, first), (high, last) = min(lines), max(lines)
                slope = (last - first) / (high - low)
                self.assertGreater(sign * slope, 0)
                for value, pixel in placed + lines:
                    self.assertAlmostEqual(pixel, first + slope * (value - low), delta=0.05)
                    self.assertTrue(0 < pixel < float(attributes["height" if axis else "width"]))

    def test_tells_what_stability_costs(self):
        """Rounding, in two views three tests each, a file, and occluders in two views; the ratio of what is shown is that of the numbers, rounded."""
        rows = json.loads((self.out / "stability.json").read_text())
        self.assertEqual(len(rows), 9)
        [table] = [table for table in self.page.tables if table[0][0] == "guarantee"]
        self.assertEqual([row[0] for row in table[1:]], [row["what"] for row in rows])
        for shown, row in zip(table[1:], rows):
            self.assertGreater(row["with"]["value"], 0)
            self.assertAlmostEqual(float(shown[5]), row["with"]["value"] / row["without"]["value"], delta=0.006)

    def test_csv_says_what_json_says(self):
        with open(self.out / "points.csv", newline="") as file:
            text = file.read()
        rows = list(csv.DictReader(io.StringIO(text)))
        self.assertEqual(len(rows), len(self.json["points"]))
        for row, point in zip(rows, self.json["points"]):
            for key, value in point.items():
                self.assertEqual(row[key] if isinstance(value, str) else json.loads(row[key] or "null"), value, key)
        for name in ("report.json", "points.csv", "stability.json"):  # and the page holds both
            coded = base64.b64encode((self.out / name).read_bytes()).decode()
            self.assertIn(coded, self.text)

    def test_tables_hold_every_point(self):
        """The last tables are those of all points; their numbers are rounded to three digits."""
        for table, (scene, points) in zip(self.page.tables[-len(self.points):], self.points.items()):
            self.assertEqual(len(table), 1 + len(points), scene)
            for row, point in zip(table[1:], points):
                self.assertEqual(row[0], point["setting"])
                shown, value = float(row[2].replace(",", "")), point["ms"]
                self.assertAlmostEqual(shown, value, delta=0.006 * value)

    def test_textures(self):
        """Sponza alone has some: its slip is that of all. It is not there when the scene was skipped. What may slip slips farther, and is not recommended."""
        textured = "sponza" in self.points
        self.assertEqual("texture_slip_px" in [m["key"] for m in self.measures], textured)
        if not textured:
            self.skipTest("needs Sponza")
        for scene in ("armadillo", "planet_full", "city"):
            self.assertEqual({p["texture_slip_px"] for p in self.points.get(scene, [])} - {None}, set())
        slips = {p["setting"]: p["texture_slip_px"] for p in self.points["sponza"]}
        self.assertEqual(slips, {p["setting"]: p["texture_slip_px"] for p in self.points["all"]})
        self.assertTrue(all(0 < slip <= 10 for slip in slips.values()))
        self.assertLess(slips["occlod, 4,000"], slips["occlod, 1,000"])
        self.assertNotEqual(slips["textures free to slip, 2,000"], slips["occlod, 2,000"])
        self.assertFalse(next(s["offered"] for s in self.json["settings"] if s["knob"] == "textures"))

    def test_fronts(self):
        for measure in self.json["measures"]:
            names = self.json["fronts"][measure["key"]]
            self.assertEqual(set(names), front(self.points["all"], measure["key"], measure["better"] == "more"), measure["key"])
            times = [next(p["ms"] for p in self.points["all"] if p["setting"] == name) for name in names]
            self.assertEqual(times, sorted(times))

    def test_the_first_table_says_where_occlusion_pays(self):
        first = self.page.tables[0]
        self.assertIn("occlusion pays", first[0])
        scenes = [s["name"] for s in self.json["scenes"]]
        self.assertEqual([row[0] for row in first[1:]], [s for s in scenes if any(row[0] == s for row in first[1:])])
        self.assertTrue(first[1:])
        for row in first[1:]:
            self.assertRegex(row[5], "^(always|never|from [0-9,]+ ns a triangle on)$")

    def test_the_second_table_says_where_hlods_pay(self):
        second = self.page.tables[1]
        self.assertIn("pays below, ns a triangle", second[0])
        self.assertEqual([row[0] for row in second[1:] if row[0]], [s["name"] for s in self.json["scenes"]])
        for scene in self.json["scenes"]:
            splits, *hlods = scene["splits_or_hlod"]
            self.assertLessEqual(splits["triangles"], self.json["knob_budget"])
            self.assertEqual(len(hlods), 2)
            self.assertTrue(all(way["depth_rms_px"] <= splits["depth_rms_px"] for way in hlods if way["pays_below_ns"] is not None))

    def test_recommendation(self):
        choice = self.json["choice"]
        offered = {s["name"] for s in self.json["settings"] if s["offered"]}
        points = {p["setting"]: p for p in self.points["all"] if p["setting"] in offered}
        kept = [p for p in points.values() if p["budget"] <= self.json["knob_budget"]]
        key = choice["measure"]
        enough = choice["near_best"] * min(p[key] for p in kept)
        near = [p for p in kept if p[key] <= enough]
        in_time = choice["time_noise"] * min(p["ms"] for p in near)
        self.assertEqual(choice["recommended"], next(p["setting"] for p in near if p["ms"] <= in_time))
        self.assertEqual(choice["budget_front"], sorted(front(kept, key, False), key=lambda name: points[name]["ms"]))
        self.assertIn(choice["recommended"], self.page.marked)
        flags = next(s["flags"] for s in self.json["settings"] if s["name"] == choice["recommended"])
        self.assertIn(f"<code>occlod render SCENE {flags.partition('(')[0].strip()}</code>", self.text[:self.text.index("<svg")])  # above the first plot

    def test_all_scenes_are_the_mean_of_each(self):
        """One picture a scene: squares, powers of ten and plain numbers are averaged as the measures are; times by their logarithms."""
        def decibel(values):
            return -10 * math.log10(sum(10 ** (-v / 10) for v in values) / len(values))

        def square(values):
            return math.sqrt(sum(v * v for v in values) / len(values))

        def plain(values):
            return sum(values) / len(values)
        means = {"depth_rms_px": square, "pop_rms_px": square, "psnr_y": decibel, "psnr_cb": decibel, "psnr_cr": decibel, "largest_px": plain, "visible_share": plain,
                 "ms": lambda values: math.exp(plain([math.log(v) for v in values]))}
        for of_all, *of_scenes in zip(*self.points.values()):
            for key, mean in means.items():
                self.assertAlmostEqual(of_all[key], mean([p[key] for p in of_scenes]), places=6, msg=(of_all["setting"], key))

    def test_budgets_are_kept(self):
        for point in self.json["points"]:
            self.assertLessEqual(point["triangles"], 1.0000001 * point["budget"])

    def test_hash_is_printed_and_shown(self):
        self.assertIn(f"hash: {self.json['hash']}", self.stdout)
        self.assertIn(self.json["hash"], re.sub(r"data:[^\"]*", "", self.text))

    def test_missing_scene_is_told(self):
        """With the real meshes out of reach, scenes that need them are skipped and named; without any scene there is nothing to write."""
        (self.out / "gone.json").write_text("""{"objects": [{"mesh": "nowhere.ply"}], "cameras": {"default": {"eye": [0, 0, 3], "target": [0, 0, 0]}}}""")
        done = subprocess.run([os.environ["BENCH_REPORT"], "--small", "--scene", f"{self.out / 'gone.json'}:orbit", "--out", self.out / "gone"],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("SKIPPED: gone: nowhere.ply", done.stderr)
        self.assertIn("has no scene to work on", done.stderr)
        self.assertEqual(list((self.out / "gone").iterdir()), [])


if __name__ == "__main__":
    unittest.main(verbosity=1)
