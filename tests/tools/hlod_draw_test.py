"""`occlod hlod render` as people and scripts use it."""
import json
import unittest

from tool_case import TRIANGLES, ToolTest

SIZE = ("--size", "160x120")
STRATEGIES = ["vfc", "coh", "nohc", "batch", "auto"]


class HlodDraw(ToolTest):
    def setUp(self):
        super().setUp()
        self.scene = self.make_planets_hlod()

    def render(self, *arguments):
        return self.json_of("hlod", "render", "planets.ohlod", "--scene", "scene.json", *SIZE, *arguments)

    def test_render_reports(self):
        report = self.render("--path", "by", "--reference", 3)
        self.assert_has_keys(report, "scene path strategy tolerance_px bias geomorph within device hlods mean frames")
        self.assertEqual((report["scene"], report["path"], report["strategy"], report["bias"]), ("planets", "by", "coh", {"s": 1.0, "t": 0.3}))
        self.assertEqual(report["hlods"][0]["triangles"], 3 * TRIANGLES)
        frames = report["frames"]
        self.assertEqual([frame["frame"] for frame in frames], list(range(7)))
        for frame in frames:
            self.assert_has_keys(frame, "drawn_nodes drawn_patches drawn_triangles cut_nodes recut_nodes rarn delayed blocked visits queries wasted_queries hidden_nodes "
                                        "largest_sse_px frame_ms cpu_ms gpu_ms stall_ms starve_ms hash")
            self.assertGreater(frame["drawn_nodes"], 0)
        compared = [frame for frame in frames if "psnr_y" in frame]
        self.assertEqual(len(compared), 3)
        self.assert_has_keys(compared[0], "depth_rms_px silhouette_mismatch psnr_y psnr_cb psnr_cr unculled_psnr_y unculled_psnr_cb unculled_psnr_cr "
                                          "wrongly_hidden_px crack_px popping_px popping_rms_px depth_complexity")
        self.assertGreaterEqual(compared[0]["depth_complexity"], 2)  # planets are closed: two surfaces wherever there is one
        mean = report["mean"]
        self.assertEqual((mean["frames"], mean["compared_frames"]), (7, 3))
        self.assertAlmostEqual(mean["drawn_nodes"], sum(frame["drawn_nodes"] for frame in frames) / 7)
        self.assertAlmostEqual(mean["depth_rms_px"], sum(frame["depth_rms_px"] for frame in compared) / 3)
        self.assertAlmostEqual(mean["fps"], 1e3 / mean["frame_ms"])

    def test_table_has_a_line_for_each_frame(self):
        lines = self.succeed("hlod", "render", "planets.ohlod", "--scene", "scene.json", "--path", "by", *SIZE).splitlines()
        self.assertEqual(len(lines), 1 + 7 + 1)
        self.assertEqual([line.split()[0] for line in lines], ["frame", *map(str, range(7)), "mean"])

    def test_what_strategies_promise(self):
        """What is asked about whether it is visible, and is, is drawn in full by those without a bias: they show what vfc shows."""
        run = {strategy: self.render("--path", "by", "--strategy", strategy, "--reference", 7)["mean"] for strategy in STRATEGIES}
        for strategy in ("vfc", "nohc"):
            self.assertEqual((run[strategy]["equal_pictures"], run[strategy]["unculled_psnr_y"], run[strategy]["wrongly_hidden_px"]), (7, None, 0), strategy)
        for strategy in STRATEGIES:
            self.assertLessEqual(run[strategy]["drawn_nodes"], run["vfc"]["drawn_nodes"], strategy)
        self.assertEqual(run["vfc"]["crack_px"], 0)
        self.assertGreater(run["coh"]["queries"], 0)
        self.assertLess(run["coh"]["drawn_nodes"], run["vfc"]["drawn_nodes"])

    def test_options_are_used(self):
        usual = self.render("--path", "by")["mean"]
        other = lambda *options: self.render("--path", "by", *options)["mean"]
        self.assertLess(other("--tolerance", 4)["drawn_triangles"], usual["drawn_triangles"])
        self.assertNotEqual(other("--within", "geomorph", "--reference", 7)["depth_rms_px"], other("--reference", 7)["depth_rms_px"])
        self.assertNotEqual(self.render("--orthographic")["mean"]["hash"], self.render()["mean"]["hash"])

    def test_pictures(self):
        self.render("--path", "by", "--frames", 2, "--png", "view.png")
        for name in ("view_00000.png", "view_00001.png"):
            self.assertEqual((self.folder / name).read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.render("--png", "one.png", "--within", "geomorph")
        self.assertTrue((self.folder / "one.png").exists())

    def test_nodes_are_refined_within(self):
        self.succeed("hlod", "build", "scene.json", "-o", "planets.ohlod", "--node-triangles", 64, "--within", "splits")
        for strategy in ("vfc", "coh"):
            shared = ("--path", "by", "--strategy", strategy, "--tolerance", 0.5, "--reference", 7)
            usual, within = self.render(*shared), self.render(*shared, "--within", "splits")
            self.assertEqual((usual["within"], within["within"]), (False, True))
            usual, within = usual["mean"], within["mean"]
            self.assertEqual(usual["cut_nodes"], 0)
            self.assertLessEqual(within["crack_px"], usual["crack_px"])
            self.assertGreater(within["cut_nodes"], 0)
            self.assertLess(within["drawn_triangles"], usual["drawn_triangles"])
            self.assertLess(within["drawn_nodes"], usual["drawn_nodes"])
        self.render("--within", "splits", "--png", "one.png")

    def test_no_tolerance_draws_the_input(self):
        frame = self.render("--strategy", "vfc", "--tolerance", 0, "--reference", 1)["frames"][0]
        self.assertEqual((frame["drawn_triangles"], frame["psnr_y"], frame["depth_rms_px"]), (3 * TRIANGLES, None, 0))

    def test_auto_tells_who_drew(self):
        frames = self.render("--path", "by", "--strategy", "auto", "--frames", 20)["frames"]
        self.assertEqual([frame["drawn_by"] for frame in frames[:16]], 15 * ["batch"] + ["vfc"])  # which is tried
        self.assertEqual(["forecast_vfc_ms" in frame for frame in frames], 15 * [False] + 5 * [True])

    def test_frames(self):
        self.assertEqual(len(self.render("--path", "by", "--frames", 3)["frames"]), 3)
        still = self.render("--frames", 4)["frames"]
        self.assertEqual(len({frame["hash"] for frame in still[2:]}), 1)
        self.assertIn("--frames: this path jumps to 2 places", self.failure_of("hlod", "render", "scene.json", "--path", "jump", "--frames", 1))
        self.assertEqual(len(self.render("--path", "jump", "--frames", 2)["frames"]), 2)

    def entries(self):
        return sorted(path.name for path in (self.folder / "cache" / "occlod").glob("*.ohlod"))

    def test_scenes_are_built_once(self):
        built = self.json_of("hlod", "render", "scene.json", *SIZE)
        self.assertEqual(len(self.entries()), 1)
        self.assertEqual(self.json_of("hlod", "render", "scene.json", *SIZE)["mean"]["hash"], built["mean"]["hash"])
        self.assertEqual(len(self.entries()), 1)
        self.succeed("hlod", "build", "scene.json", "-o", "usual.ohlod")
        named = self.json_of("hlod", "render", "usual.ohlod", "--scene", "scene.json", *SIZE)
        self.assertEqual(named["mean"]["hash"], built["mean"]["hash"])
        self.json_of("hlod", "render", "planet.ply", *SIZE, "--no-cache")
        self.assertEqual(len(self.entries()), 1)

    def test_scenes_of_hlods(self):
        self.succeed("hlod", "build", "planet.ply", "-o", "planet.ohlod", "--node-triangles", 64)
        objects = [dict(thing, mesh="planet.ohlod") for thing in self.scene["objects"]]
        (self.folder / "placed.json").write_text(json.dumps(dict(self.scene, objects=objects)))
        placed = self.json_of("hlod", "render", "placed.json", "--strategy", "vfc", "--reference", 1, *SIZE)
        self.assertEqual([hlod["triangles"] for hlod in placed["hlods"]], [TRIANGLES] * 3)
        flat = self.render("--strategy", "vfc", "--reference", 1)
        self.assertAlmostEqual(placed["frames"][0]["depth_complexity"], flat["frames"][0]["depth_complexity"], 2)

    def test_mistakes_are_told_in_one_line(self):
        (self.folder / "text.ohlod").write_text("no HLOD")
        for parts, arguments in (
                (["text.ohlod", "is not an .ohlod file"], ["render", "text.ohlod"]),
                (["none.ohlod: no such file"], ["render", "none.ohlod"]),
                (["planets.ohlod: --path: it has no camera path", "--scene"], ["render", "planets.ohlod", "--path", "by"]),
                (['scene.json: /paths: has no "other"', "by, jump"], ["render", "planets.ohlod", "--scene", "scene.json", "--path", "other"]),
                (['scene.json: /cameras: has no "other"', "default"], ["render", "scene.json", "--camera", "other"]),
                (["scene.json: --scene: this scene has cameras of its own"], ["render", "scene.json", "--scene", "scene.json"]),
                (["planet.ply: --scene: is not a scene file"], ["render", "planets.ohlod", "--scene", "planet.ply"]),
                (["--device: magic: there is no such device; use software, gl"], ["render", "planets.ohlod", "--device", "magic"]),
                (["nowhere/a.png: the folder nowhere does not exist"], ["render", "planets.ohlod", "--png", "nowhere/a.png"])):
            line = self.failure_of("hlod", *arguments)
            for part in parts:
                self.assertIn(part, line)
        self.assertIn("draw it with occlod hlod render", self.failure_of("render", "planets.ohlod"))
        for arguments in (["--strategy", "magic"], ["--path", "by", "--camera", "default"], ["--within", "both"], ["--strategy", "sw"]):
            done = self.run_tool("hlod", "render", "planets.ohlod", *arguments)
            self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), f"{arguments}: {done.stderr}")


if __name__ == "__main__":
    unittest.main(verbosity=1)
