"""Drives `occlod render --occlusion auto`: what it prints, and that a calibration repeats a run."""
import json
import unittest

from tool_case import ToolTest

# Triangles are dear, so that each that is seen is worth queries.
CALIBRATION = {"visit_ns": 150.0, "far_visit_ns": 400.0, "cone_ns": 25.0, "split_ns": 350.0, "kept_split_ns": 30.0, "triangle_ns": 1000.0, "fragment_ns": 1.0,
               "backends": [{"name": "software", "occluder_triangle_ns": 20.0, "occluder_fragment_ns": 0.8, "occluder_pixel_ns": 0.4, "query_ns": 200.0, "latency_ns": 200.0}]}
# The wall covers all spheres, which takes most of the budget from the ball before it; from above the planet's ground hides nothing.
WALL = """{"objects": [{"generator": "spheres-behind-wall", "options": {"spheres": 32}},
                       {"generator": "rough-planet", "options": {"level": 5}, "position": [1, 0.3, 0], "scale": 0.3}],
           "cameras": {"default": {"eye": [3, 0.05, 0.05], "target": [-1, 0, 0], "up": [0, 0, 1], "width": 320, "height": 240, "near": 0.01}},
           "paths": {"aside": {"frames": 5, "keys": [{"eye": [3, 0, 0.05], "target": [-1, 0, 0], "up": [0, 0, 1]},
                                                     {"eye": [3, 0.5, 0.05], "target": [-1, 0, 0], "up": [0, 0, 1]}]}}}"""
GROUND = """{"objects": [{"generator": "rough-planet", "options": {"level": 5, "amplitude": 0.005}}],
             "cameras": {"default": {"eye": [0, 0, 1.5], "target": [0, 0, 0], "fov_y_deg": 30, "width": 320, "height": 240, "near": 0.05}}}"""


class Auto(ToolTest):
    def setUp(self):
        super().setUp()
        (self.folder / "calibration.json").write_text(json.dumps(CALIBRATION))
        (self.folder / "wall.json").write_text(WALL)
        (self.folder / "ground.json").write_text(GROUND)

    def render(self, scene, *arguments, budget=5000):
        return self.json_of("render", scene, "--budget", budget, "--calibration", "calibration.json", *arguments)

    def test_is_the_default_along_paths(self):
        """Over a path the looks pay for themselves; in a single view they do not."""
        for options, expected in (([], "software"), (["--path", "aside"], "auto"), (["--path", "aside", "--frame-to-frame"], "software"),
                                  (["--path", "aside", "--frame-to-frame", "--calibration", "calibration.json"], "auto"),
                                  (["--calibration", "calibration.json"], "auto")):
            self.assertEqual(self.json_of("render", "wall.json", "--budget", 3000, *options)["occlusion"], expected, options)

    def test_says_why(self):
        result = self.render("wall.json")
        self.assertEqual((result["occlusion"], result["calibration"]), ("auto", CALIBRATION))
        why = result["auto"]
        # The first forecast is that without occlusion; the chosen one scores best.
        self.assertEqual((why["forecasts"][0]["backend"], why["forecasts"][0]["error"]), ("none", 1.0))
        best = min(why["forecasts"], key=lambda forecast: forecast["score"])
        self.assertEqual(why["backend"], best["backend"])
        self.assertTrue(why["looked_ahead"])
        self.assertEqual(sum(o["queries"] for o in why["objects"]), result["queries"])

    def test_asks_where_it_pays(self):
        self.assertGreater(self.render("wall.json")["queries"], 0)
        result = self.render("ground.json")
        self.assertEqual((result["auto"]["backend"], result["queries"], result["occluder_draws"]), ("none", 0, 0))

    def test_a_calibration_repeats_a_run(self):
        self.json_of("render", "wall.json", "--budget", 5000, "--save-calibration", "measured.json")
        runs = [self.json_of("render", "wall.json", "--budget", 5000, "--path", "aside", "--calibration", "measured.json", "--save-calibration", copy)
                for copy in ("a.json", "b.json")]
        self.assertTrue(self.same_bytes("measured.json", "a.json") and self.same_bytes("a.json", "b.json"))
        hashes, backends = [[[frame["hash"] for frame in run["frames"]] for run in runs], [[frame["auto"]["backend"] for frame in run["frames"]] for run in runs]]
        self.assertEqual((hashes[0], backends[0]), (hashes[1], backends[1]))

    def test_frames_go_on_from_each_other(self):
        """The first frame is all new; those after it change a part of it, and a calibration repeats them."""
        runs = [self.render("wall.json", "--path", "aside", "--frame-to-frame", "--occlusion", "auto", budget=1500)["frames"] for _ in range(2)]
        self.assertEqual([frame["hash"] for frame in runs[0]], [frame["hash"] for frame in runs[1]])
        self.assertTrue(all(frame["triangles"] <= 1500 and frame["queries"] > 0 and frame["auto"]["backend"] != "none" for frame in runs[0]))
        self.assertEqual([frame["new_splits"] == frame["splits"] for frame in runs[0]], [True, False, False, False, False])
        self.assertEqual([frame["auto"]["looked_ahead"] for frame in runs[0]], [True, False, False, False, False])

    def test_explains_itself_to_people(self):
        text = self.succeed("render", "wall.json", "--budget", 5000, "--calibration", "calibration.json", "--explain")
        for part in ("look ahead", "would take", "cones", "occlusion on", "splits or an HLOD"):
            self.assertIn(part, text)
        text = self.succeed("render", "ground.json", "--budget", 5000, "--calibration", "calibration.json", "--explain")
        self.assertIn("occlusion off", text)
        self.assertIn("--explain", self.failure_of("render", "wall.json", "--occlusion", "software", "--explain"))

    def test_says_where_an_hlod_pays(self):
        """HLODs draw more triangles for no larger error, and take less time to find them: below some cost of a triangle they pay."""
        for options in ([], ["--path", "aside", "--frame-to-frame"]):
            splits, *hlods = self.render("wall.json", "--explain", *options, budget=3000)["splits_or_hlod"]
            self.assertEqual((splits["way"], [way["way"] for way in hlods]), ("splits", ["HLOD, vfc", "HLOD, coh"]))
            self.assertLessEqual(splits["triangles"], 3000)
            self.assertTrue(0 < splits["depth_rms_px"] < 10)
            self.assertEqual(hlods[0]["queries"], 0)
            self.assertGreater(hlods[1]["queries"], 0)
            self.assertLess(hlods[1]["triangles"], hlods[0]["triangles"])  # the wall hides the spheres
            for way in hlods:
                self.assertLessEqual(way["depth_rms_px"], splits["depth_rms_px"])
                more, less_ms = way["triangles"] - splits["triangles"], splits["ms"] - way["ms"]
                self.assertGreater(min(more, less_ms, way["tolerance_px"]), 0)
                self.assertAlmostEqual(way["pays_below_ns"] / (1e6 * less_ms / more), 1)
                self.assertEqual(way["pays_above_ns"], "infinite")
        self.assertNotIn("splits_or_hlod", self.render("wall.json"))

    def test_bad_calibrations_are_refused(self):
        self.assertIn("none.json", self.failure_of("render", "wall.json", "--calibration", "none.json"))
        for key, value in (("visit_ns", -1), ("cone_ns", "fast"), ("backends", []), ("more", 1)):
            (self.folder / "bad.json").write_text(json.dumps(dict(CALIBRATION, **{key: value})))
            line = self.failure_of("render", "wall.json", "--calibration", "bad.json")
            self.assertIn("bad.json", line)
            self.assertIn(key, line)
        other = dict(CALIBRATION, backends=[dict(CALIBRATION["backends"][0], name="gl-query")])
        (self.folder / "bad.json").write_text(json.dumps(other))
        self.assertIn("software", self.failure_of("render", "wall.json", "--calibration", "bad.json"))
        self.assertIn("--calibration", self.failure_of("render", "wall.json", "--occlusion", "none", "--calibration", "calibration.json"))


if __name__ == "__main__":
    unittest.main(verbosity=1)
