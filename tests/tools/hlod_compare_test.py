"""bench_hlod_compare (environment variable HLOD_COMPARE), from which the tables of papers on HLODs come: rivals, oracles, simulated and recorded devices, a
simulated disk."""
import csv
import json
import os
import subprocess
import unittest

from tool_case import ToolTest

SIZE = ("--size", "160x120")
STRATEGIES = ["vfc", "sw", "sw-b", "bool", "simp", "coh", "ideal", "nohc", "chc++", "two-pass", "cesium", "optimum", "batch", "auto"]


class HlodCompare(ToolTest):
    def setUp(self):
        super().setUp()
        self.make_planets_hlod()

    def run_compare(self, *arguments):
        return subprocess.run([os.environ["HLOD_COMPARE"], *map(str, arguments)], cwd=self.folder, env=self.environment, capture_output=True, text=True)

    def failure(self, *arguments):
        done = self.run_compare("planets.ohlod", *arguments)
        self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (1, "", 1), done.stderr)
        return done.stderr

    def told(self, *arguments):
        done = self.run_compare("planets.ohlod", "--scene", "scene.json", *SIZE, *arguments, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def render(self, *arguments):
        """One run, with its frames."""
        report = self.told(*("--strategies" if argument == "--strategy" else argument for argument in arguments))
        (report["mean"],) = report["runs"]
        return report

    def compare(self, *arguments):
        return {(run["device"], run["strategy"]): run for run in self.told("--path", "by", *arguments)["runs"]}

    def test_what_strategies_promise(self):
        """Those without a bias show what vfc shows; ideal draws what sw-b draws, and nobody asks for it."""
        runs = self.compare("--strategies", "all", "--reference", 7)
        self.assertEqual([strategy for _, strategy in runs], STRATEGIES)
        run = {strategy: runs["software", strategy] for strategy in STRATEGIES}
        for strategy in ("vfc", "sw", "bool", "nohc", "chc++", "two-pass", "optimum"):
            self.assertEqual((run[strategy]["equal_pictures"], run[strategy]["unculled_psnr_y"], run[strategy]["wrongly_hidden_px"]), (7, None, 0), strategy)
            self.assertEqual(run[strategy]["crack_px"], 0, strategy)
        self.assertEqual(run["ideal"]["hash"], run["sw-b"]["hash"])
        self.assertLess(run["sw-b"]["drawn_nodes"], run["sw"]["drawn_nodes"])
        self.assertLess(run["sw"]["drawn_nodes"], run["vfc"]["drawn_nodes"])
        for strategy in ("sw", "sw-b", "bool", "simp", "coh", "chc++", "two-pass", "cesium", "optimum"):
            self.assertGreater(run[strategy]["queries"], 0, strategy)
        self.assertEqual((run["vfc"]["queries"], run["ideal"]["queries"]), (0, 0))

    def test_compare_agrees_with_render(self):
        runs = self.compare("--strategies", "coh,vfc", "--device", "virtual:modern,software", "--tolerance", 2)
        self.assertEqual(list(runs), [(device, strategy) for device in ("virtual:modern", "software") for strategy in ("vfc", "coh")])
        alone = self.render("--path", "by", "--strategy", "coh", "--device", "virtual:modern", "--tolerance", 2)["mean"]
        for key, value in runs["virtual:modern", "coh"].items():
            if key not in ("device", "strategy"):
                self.assertEqual(value, alone[key], key)
        product = self.json_of("hlod", "render", "planets.ohlod", "--scene", "scene.json", *SIZE, "--path", "by", "--tolerance", 2)["mean"]
        self.assertEqual(product["hash"], runs["software", "coh"]["hash"])

    def test_options_are_used(self):
        usual = self.render("--path", "by", "--strategy", "sw-b")["mean"]
        other = lambda *options: self.render("--path", "by", "--strategy", "sw-b", *options)["mean"]
        self.assertLess(other("--tolerance", 4)["drawn_triangles"], usual["drawn_triangles"])
        self.assertNotEqual(other("--bias", "0,0.3")["hash"], usual["hash"])
        self.assertNotEqual(other("--bias", "1,0.9")["hash"], usual["hash"])
        self.assertEqual(other("--bias", "none")["hash"], self.render("--path", "by", "--strategy", "sw")["mean"]["hash"])
        self.assertGreater(other("--metric", "sphere", "--bias", "none")["drawn_triangles"], other("--bias", "none")["drawn_triangles"])
        self.assertNotEqual(other("--alpha", "paper")["hash"], usual["hash"])
        coh = lambda *options: self.render("--path", "by", "--strategy", "coh", "--device", "virtual:modern", *options)
        self.assertNotEqual(coh("--coherence", "published")["mean"]["hash"], coh()["mean"]["hash"])
        self.assertEqual([coh("--coherence", name)["coherence"] for name in ("mended", "published")], ["mended", "published"])
        nohc = lambda *options: self.render("--path", "by", "--strategy", "nohc", "--device", "virtual:fill-bound", *options)
        self.assertEqual(nohc("--cover-model", "printed")["cover_model"], "printed")
        self.assertEqual(nohc()["cover_model"], "in-scene")

    def test_times_of_virtual_devices_are_simulated(self):
        for preset in ("query-cheap", "query-dear", "fill-bound", "modern"):
            first, second = (self.render("--path", "by", "--strategy", "coh", "--device", f"virtual:{preset}") for _ in range(2))
            self.assertEqual(first["frames"], second["frames"], preset)
            self.assertGreater(first["mean"]["frame_ms"], 0)

    def test_saved_costs_give_the_same_nodes(self):
        """What a strategy draws depends on the costs that it is given, and on nothing that differs from run to run."""
        for strategy in ("nohc", "optimum", "batch", "auto"):
            arguments = ("--path", "by", "--bias", "none", "--strategy", strategy)
            saved = self.render(*arguments, "--save-calibration", "costs.json")
            again = self.render(*arguments, "--calibration", "costs.json")
            self.assertEqual(again["mean"]["hash"], saved["mean"]["hash"], strategy)
            self.assertEqual(again["costs"], saved["costs"], strategy)
        devices = json.loads((self.folder / "costs.json").read_text())["devices"]
        self.assertEqual([device["name"] for device in devices], ["software"])
        self.assertIn("virtual:modern", self.failure("--strategies", "nohc", "--device", "virtual:modern", "--calibration", "costs.json"))
        own = self.render("--strategy", "nohc", "--device", "virtual:modern")["costs"]
        self.assertEqual((own["draw_ns"], own["query_ns"]), (1000, 2000))
        dear = dict(own, query_ns=1e9, name="virtual:modern")
        calibration = json.loads((self.folder / "costs.json").read_text())
        calibration["devices"].append(dear)
        (self.folder / "dear.json").write_text(json.dumps(calibration))
        self.assertEqual(self.render("--path", "by", "--strategy", "nohc", "--device", "virtual:modern", "--calibration", "dear.json")["mean"]["queries"], 0)

    def test_recordings_are_replayed(self):
        """Answers, what was available, and times, so that another machine draws and tells the same."""
        drawn = self.render("--path", "by", "--strategy", "coh", "--device", "virtual:query-dear", "--record", "run.orec")
        again = self.render("--path", "by", "--strategy", "coh", "--replay", "run.orec")
        self.assertEqual(again["frames"], drawn["frames"])
        self.assertEqual(again["mean"]["device"], "recorded:virtual:query-dear")
        line = self.failure("--scene", "scene.json", "--path", "by", *SIZE, "--strategies", "coh", "--replay", "run.orec", "--tolerance", 3)
        self.assertIn("frame", line)
        self.assertIn("planet.ply", self.failure("--strategies", "coh", "--replay", "planet.ply"))

    def test_pictures_and_tables(self):
        self.render("--path", "by", "--strategy", "coh", "--frames", 2, "--boxes", "boxes.png", "--csv", "frames.csv")
        for name in ("boxes_00000.png", "boxes_00001.png"):
            self.assertEqual((self.folder / name).read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        with open(self.folder / "frames.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["frame"] for row in rows], ["0", "1"])
        self.assertEqual(len(rows[0]["hash"]), 16)
        self.compare("--strategies", "coh,bool", "--frames", 3, "--csv", "all.csv")
        with open(self.folder / "all.csv", newline="") as file:
            self.assertEqual([(row["strategy"], row["frame"]) for row in csv.DictReader(file)],
                             [(strategy, str(frame)) for strategy in ("bool", "coh") for frame in range(3)])

    def test_simulated_disks_repeat_and_refine(self):
        arguments = ("--path", "by", "--strategy", "vfc", "--frames", 40, "--memory", "64M", "--load")
        hashes = lambda report: [frame["hash"] for frame in report["frames"]]
        report = self.render(*arguments, "simulated:1")
        self.assertEqual(report["cache"]["load"], "simulated:1")
        self.assertEqual(hashes(self.render(*arguments, "simulated:1")), hashes(report))
        self.assertNotEqual(hashes(self.render(*arguments, "simulated:100")), hashes(report))
        self.assertGreater(report["frames"][0]["missing"], 0)
        self.assertGreater(report["frames"][0]["largest_sse_px"], 1.0)

    def test_mistakes_are_told_in_one_line(self):
        self.assertIn("query-cheap, query-dear, fill-bound, modern", self.failure("--device", "software,virtual:magic"))
        self.assertIn("software, gl", self.failure("--device", "magic"))
        self.assertIn("are of one run", self.failure("--record", "a.orec"))
        for arguments in (["--strategies", "coh,magic"], ["--metric", "cube"], ["--bias", "1"], ["--bias", "1,2"], ["--bias", "x,0"], ["--bias", "nan,0"], ["--bias", "0,0,0"],
                          ["--memory", "1M", "--load", "simulated:0"], ["--device", "software", "--replay", "a.orec"]):
            done = self.run_compare("planets.ohlod", *arguments)
            self.assertNotEqual(done.returncode, 0, arguments)
            self.assertIn(arguments[-2] if "--memory" in arguments else arguments[0], done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=1)
