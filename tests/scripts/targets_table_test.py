"""scripts/targets_table.py: every figure comes from the file, verdicts are on the right side of the targets, and nothing that is missing is called met.
scripts/bench_targets.py: versions take turns."""
import contextlib
import csv
import io
import json
import pathlib
import sys
import tempfile
import unittest

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts"
sys.path.insert(0, str(SCRIPTS))
import bench_targets  # noqa: E402
import targets_table as table  # noqa: E402

ABOUT = {"commit": "abc", "date": "2026-01-01", "processor": "P", "cores": 2, "load_before": 0.0, "load_after": 0.0, "seconds": 60, "quick": False}


def path(*rounds, hash_="a", triangles=10000):
    return {"rounds": list(rounds), "hash": hash_, "triangles": triangles}


def frames_row(scene="armadillo", ratios=(1.0, 1.0), cpu_ms=((1.0, 1.0),), frame=0.6, scratch=0.6):
    return {"scene": scene, "path": "orbit", "culling": "star", "occlusion": "software", "error_ratios": list(ratios),
            "frame_cpu_ms": [list(times) for times in cpu_ms], "frame_shares": [frame], "scratch_shares": [scratch]}


def picture(depth=1.0, share=0.5, silhouette=0.2, hash_="a"):
    return {"depth_rms_px": depth, "visible_share": share, "silhouette_mismatch": silhouette, "hash": hash_}


def pictures(**changed):
    """All four ways alike but for those that are named, as underscores_for_words."""
    ways = {way: picture() for way in (table.OURS, "star", "paper's LOD + software", table.PAPERS)}
    return ways | {{"ours": table.OURS, "star": "star", "papers": table.PAPERS}[name]: value for name, value in changed.items()}


class Judgement(unittest.TestCase):
    def row(self, data, what):
        """The figure of the target of that name, or of the only one whose name begins so."""
        figures = {target.what: figure for target, figure in table.judge({"about": ABOUT, **data})}
        [name] = [what] if what in figures else [name for name in figures if name.startswith(what)]
        return figures[name]

    def test_nothing_is_met_where_nothing_was_measured(self):
        for target, figure in table.judge({"about": ABOUT}):
            self.assertEqual((table.verdict(figure), figure.now), ("not measured", "-"), target.what)
            self.assertTrue(figure.note, target.what)

    def test_times_are_least_of_rounds_then_median_of_frames_without_the_first(self):
        # Least of both rounds: 9, 2, 4, 6; the first frame does not count.
        self.assertEqual(table.typical([[9, 2, 5, 6], [99, 3, 4, 8]]), 4)

    def test_speed(self):
        ways = {"reference": path([0, 10, 10], hash_="a"), "present": path([0, 4.9, 4.9], hash_="b"),
                "present, 2 threads": path([0, 3.8, 3.8], hash_="b")}
        data = {"paths": {"star_software": ways}}
        one = self.row(data, "star + software from scratch, one thread")
        self.assertEqual((one.met, one.ratio, one.answers), (True, "0.490", "differ, expected"))
        two = self.row(data, "star + software from scratch, two threads")
        self.assertEqual((two.met, two.ratio, two.answers), (False, "0.380", "as one thread"))

    def test_speed_without_the_earlier_version_is_undecided(self):
        figure = self.row({"paths": {"star": {"present": path([0, 2])}}}, "star from scratch")
        self.assertEqual((table.verdict(figure), figure.before), ("undecided", "-"))
        self.assertTrue(figure.now.startswith("2 ms"))

    def test_answers_that_may_not_change(self):
        ways = {"reference": path([0, 2], hash_="a"), "present": path([0, 1], hash_="b")}
        built = {"reference": {"1": "x", "2": "x"}, "present": {"1": "x", "2": "x"}}
        self.assertEqual(self.row({"paths": {"million_planet_full": ways}}, "budget of 1 M from scratch, planet_full, one").answers, "**differ**")
        figure = self.row({"hashes": {"built": built}, "paths": {"million_planet_full": ways, "star": ways}}, "the same bits as before")
        self.assertEqual((figure.met, figure.note), (False, "million_planet_full"))  # of star they may
        self.assertTrue(self.row({"hashes": {"built": built}, "paths": {"star": ways}}, "the same bits as before").met)

    def test_threads_and_pinned_hashes(self):
        hashes = {"pinned": {"A.B": True}, "built": {"present": {"1": "x", "2": "x"}}}
        ways = {"present": path([0, 1], hash_="a"), "present, 2 threads": path([0, 1], hash_="b")}
        what = "the same bits for any"
        self.assertTrue(self.row({"hashes": hashes}, what).met)
        self.assertEqual(self.row({"hashes": hashes, "paths": {"star": ways}}, what).note, "star")
        self.assertEqual(self.row({"hashes": hashes | {"pinned": {"A.B": False}}}, what).note, "A.B")

    def test_whole_frame(self):
        data = {"whole_frame": {"planet_full": {"present": {"none": [12, 10], "software": [14, 13]}}}}
        figure = self.row(data, "whole frame with occlusion over without, planet_full")
        self.assertEqual((figure.met, figure.ratio, figure.before), (True, "1.300", "-"))

    def test_building_is_judged_by_the_worst_mesh_at_one_percent(self):
        def rows(mesh, tools):
            return [{"mesh": mesh, "input_triangles": 20000, "target_triangles": target, "tool": tool, "milliseconds": [ms * 9, ms]}
                    for target, factor in ((200, 1), (10000, 0.01)) for tool, ms in ((tool, ms * factor) for tool, ms in tools.items())]
        building = (rows("a", {"occlod": 100, "occlod, 2 threads": 50, "meshoptimizer": 70})
                    + rows("b", {"occlod": 100, "occlod, 2 threads": 80, "meshoptimizer": 60}))
        data = {"programs": {"building": building}}
        self.assertEqual(self.row(data, "building over meshoptimizer, one").ratio, "0.600")
        self.assertEqual(self.row(data, "building over meshoptimizer, two").ratio, "0.750")
        self.assertEqual(self.row(data, "building on two threads over one").ratio, "1.250")
        self.assertFalse(self.row(data, "building on two threads over one").met)

    def test_pictures_are_judged_by_the_worst_way(self):
        before = pictures(ours=picture(depth=1.0, share=0.5), star=picture(share=0.5))
        now = pictures(ours=picture(depth=1.006, share=0.6, hash_="b"), star=picture(share=0.4971))
        data = {"pictures": {"armadillo": {"reference": before, "present": now}}}
        depth, share = self.row(data, "depth RMS, armadillo"), self.row(data, "visible share, armadillo")
        self.assertEqual((depth.met, depth.ratio, depth.answers), (False, "1.006", "differ, expected"))
        self.assertEqual((share.met, share.ratio, share.answers), (True, "-0.29 points", "same"))

    def test_pictures_against_the_papers(self):
        worse = {"present": pictures(ours=picture(depth=0.5, silhouette=0.3))}
        better = {"present": pictures(ours=picture(depth=0.4, silhouette=0.2))}
        scenes = {f"scene {i}": better for i in range(7)}
        data = {"pictures": scenes | {"armadillo": worse}}
        self.assertFalse(self.row(data, "depth RMS over the paper's LOD's, armadillo").met)
        self.assertIn("7 of 8; worst: armadillo", self.row(data, "silhouettes").now)
        self.assertTrue(self.row({"pictures": scenes | {"armadillo": better}}, "silhouettes").met)
        self.assertIsNone(self.row({"pictures": scenes}, "silhouettes").met)  # one is missing

    def test_combinations(self):
        rows = [frames_row(f"scene {i}") for i in range(75)]
        bad = frames_row(ratios=[9.0] + [1.0] * 18 + [1.06] * 2, cpu_ms=[[9, 1, 1, 3, 3, 1, 1], [9, 1, 1, 3, 1, 1, 1]], frame=0.56)
        figures = {"visible share, frame to frame against from scratch, armadillo": (False, "-4.0 points"),
                   "visible share, frame to frame against from scratch, all": (False, "-4.0 points"),
                   # 18 of 20 later frames are at 1: the 19th is the 95th percentile.
                   "largest visible error": (False, "1.060"),
                   # Slow twice in a row in one round alone is another program's doing.
                   "frames in a row": (True, "1")}
        for what, expected in figures.items():
            figure = self.row({"programs": {"frames": [*rows, bad]}}, what)
            self.assertEqual((figure.met, figure.ratio), expected, what)
            self.assertIsNone(self.row({"programs": {"frames": rows[:3]}}, what).met, what)  # not all are there
        self.assertIn("75 of 76; worst: armadillo orbit, star + software", self.row({"programs": {"frames": [*rows, bad]}}, "largest").now)

    def test_an_error_without_a_limit_is_the_worst(self):
        self.assertEqual(table.percentile_95([1.0, None, 1.0]), 1.0)
        self.assertEqual(table.percentile_95([1.0] + [None] * 3), float("inf"))

    def test_auto(self):
        effects = [{"scene": f"scene {i}", "auto_to_best": "1.05", "jumping_to_best": "1.1"} for i in range(10)]
        effects.append({"scene": "city", "auto_to_best": "1.0", "jumping_to_best": "1.2"})
        data = {"programs": {"effects": effects}}
        self.assertTrue(self.row(data, "auto over the best fixed setting, settled").met)
        jumping = self.row(data, "auto over the best fixed setting, jumping")
        self.assertEqual((jumping.met, jumping.now, jumping.ratio), (False, "10 of 11; worst: city", "1.200"))

    def test_what_failed_says_why(self):
        figure = self.row({"paths": {"star": {"failed": "x.json: no mesh"}}}, "star from scratch")
        self.assertEqual((table.verdict(figure), figure.note), ("not measured", "x.json: no mesh"))
        text = table.markdown({"about": ABOUT, "paths": {"star": {"failed": "x.json: no mesh"}}})
        self.assertIn("- star from scratch: x.json: no mesh\n", text)
        self.assertTrue(text.endswith(f"0 met, 0 missed, {len(list(table.targets()))} not measured or undecided."), text[-60:])

    def test_csv_has_the_rows_of_the_table(self):
        data = {"about": ABOUT, "paths": {"star": {"reference": path([0, 4]), "present": path([0, 2])}}}
        [row] = [row for row in csv.DictReader(io.StringIO(table.as_csv(data))) if row["what"] == "star from scratch"]
        self.assertEqual((row["ratio"], row["verdict"], row["answers"]), ("0.500", "met", "same"))

    def test_a_file_that_is_none(self):
        with self.assertRaisesRegex(SystemExit, "nowhere.json: .*bench_targets.sh"):
            table.main(["nowhere.json"])


class FakeVersion:
    """Notes when it is asked, and answers with two frames."""
    def __init__(self, name, log):
        self.name, self.log = name, log

    def render(self, _, *options):
        self.log.append(self.name + (" 2" if "--threads" in options else ""))
        frame = {"refine_ms": 1.0, "occlusion_ms": 0.5, "hash": "a", "triangles": 10, "visible_share": 0.5}
        return {"frames": [frame, frame]}


class Measurement(unittest.TestCase):
    def test_versions_take_turns(self):
        log = []
        subject = bench_targets.PathSubject("key", pathlib.Path("x.json"), (), False, 2)
        result = subject.measure([FakeVersion("reference", log), FakeVersion("present", log)])
        self.assertEqual(log, ["reference", "present", "present", "reference"])
        self.assertEqual(result["present"]["rounds"], [[1.5, 1.5], [1.5, 1.5]])
        self.assertEqual(result["present"]["hash"], result["reference"]["hash"])

    def test_what_fails_is_told_and_does_not_end_the_run(self):
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stderr(io.StringIO()) as told:
            occlod, out = pathlib.Path(folder) / "tools/occlod", pathlib.Path(folder) / "targets.json"
            occlod.parent.mkdir()
            occlod.write_text("#!/bin/sh\necho note >&2\necho x.json: no mesh >&2\nexit 1\n")
            occlod.chmod(0o755)
            bench_targets.main(["--build", folder, "--out", str(out), "--quick"])
            data = json.loads(out.read_text())
        self.assertIn("SKIPPED: paths: star: x.json: no mesh\n", told.getvalue())
        self.assertEqual(data["paths"]["star"], {"failed": "x.json: no mesh"})
        self.assertEqual({table.verdict(figure) for _, figure in table.judge(data)}, {"not measured"})

    def test_what_is_not_built(self):
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaisesRegex(SystemExit, "tools/occlod: .*bench_targets.sh"):
                bench_targets.main(["--build", folder, "--out", f"{folder}/out/targets.json"])
            self.assertEqual(list(pathlib.Path(folder).iterdir()), [])  # nothing is written


if __name__ == "__main__":
    unittest.main()
