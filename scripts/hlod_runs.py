#!/usr/bin/env python3
"""Builds the HLODs and makes the runs that scripts/hlod_tables.py prints. Each run is one JSON object in its own file.

hlod_runs.py --occlod FILE --out FOLDER [--quick] [--reuse] [--devices NAME,NAME,...]"""
import argparse
import dataclasses
import datetime
import json
import os
import pathlib
import platform
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
SCENES = ROOT / "meshes" / "scenes"
SESSION = ("overview", "rotation", "close_ups")  # of Charalambos 2006: overall views, rotations, extreme close-ups
FIRST_PAPER = ("hlod_row", "hlod_grid", "hlod_shelves")
SECOND_PAPER = ("hlod_5m", "hlod_12m")
PAPER_SIZE = ("--size", "640x480")
AS_PUBLISHED = ("--metric", "sphere")
BIAS = "1,0.1"  # chosen from the sweep
SWEEP = ("none", "0,0", "1,0", "0.5,0.1", "1,0.1", "1,0.2", "1,0.3", "1,0.5")
NESTED_TRIANGLES = {"hlod_12m": 2600}  # for about as many nodes as the papers have
TOLERANCES = (0.5, 0.7, 1, 1.4, 2)


@dataclasses.dataclass(frozen=True)
class Effort:
    scenes: tuple = FIRST_PAPER + SECOND_PAPER
    session_frames: int = 200  # of each of the three paths
    walk_frames: int = 600
    slow_frames: int = 3000
    compared: int = 20
    crack_frames: int = 8  # of each path
    pop_frames: int = 60
    llvmpipe_frames: int = 30
    fronts: int = 10_000


QUICK = Effort(scenes=("hlod_row", "hlod_grid"), session_frames=20, walk_frames=20, slow_frames=100, compared=3, crack_frames=2, pop_frames=4,
               llvmpipe_frames=3, fronts=100)


class Runs:
    def __init__(self, occlod, out, effort, reuse):
        self.occlod, self.out, self.effort, self.reuse = occlod, out, effort, reuse

    def run(self, name, *command, **environment):
        file = self.out / f"{name}.json"
        if self.reuse and file.exists() and file.stat().st_size > 0:
            return
        print(f"hlod_tables: {name}", file=sys.stderr)
        done = subprocess.run([self.occlod, "hlod", *map(str, command), "--json"], capture_output=True, text=True, env={**os.environ, **environment})
        if done.returncode != 0:
            line = (done.stderr.strip().splitlines() or ["ended without a word"])[-1]
            print(f"hlod_tables: SKIPPED {name}: {line}", file=sys.stderr)
            file.unlink(missing_ok=True)
            return
        part = file.with_suffix(".part")
        part.write_text(done.stdout)
        part.rename(file)

    def hlod(self, scene, kind):
        return self.out / f"{scene}_{kind}.ohlod"

    def build(self, scene):
        for kind, options in (("nested", ("--grouping", "nested", "--borders", "free", "--node-triangles", NESTED_TRIANGLES.get(scene, 2000))), ("shifted", ())):
            if not (self.reuse and self.hlod(scene, kind).exists()):
                (self.out / f"{scene}_{kind}.json").unlink(missing_ok=True)
                self.run(f"{scene}_{kind}", "build", SCENES / f"{scene}.json", "-o", self.hlod(scene, kind), *options)

    def compare(self, name, scene, kind, path, frames, *options, **environment):
        self.run(name, "compare", self.hlod(scene, kind), "--scene", SCENES / f"{scene}.json", "--path", path, "--frames", frames, *options, **environment)

    def first_paper(self, devices):
        """B = mu and alpha as in Charalambos 2006."""
        for scene in self.scenes(FIRST_PAPER):
            for path in SESSION:
                self.compare(f"first_{scene}_{path}", scene, "nested", path, self.effort.session_frames, *PAPER_SIZE, *AS_PUBLISHED, "--alpha", "paper",
                             "--bias", "0,0", "--strategies", "sw,sw-b,bool,simp", "--device", devices)

    def second_paper(self, devices):
        strategies = ("--bias", BIAS, "--strategies", "bool,sw-b,simp,coh", "--device", devices)
        for scene in self.scenes(SECOND_PAPER):
            self.compare(f"second_{scene}_walk", scene, "nested", "walk", self.effort.walk_frames, *PAPER_SIZE, *AS_PUBLISHED, *strategies,
                         "--reference", self.effort.compared)
            self.compare(f"ours_{scene}_walk", scene, "shifted", "walk", self.effort.walk_frames, *PAPER_SIZE, *strategies, "--reference", self.effort.compared)
        for scene in self.scenes(FIRST_PAPER):
            for path in SESSION:
                self.compare(f"second_{scene}_{path}", scene, "nested", path, self.effort.session_frames, *PAPER_SIZE, *AS_PUBLISHED, *strategies)

    def slow(self):
        """The same walk at a fifth of the speed: what is predicted from the frame before gets better."""
        for scene in self.scenes(("hlod_5m",)):
            self.compare(f"slow_{scene}", scene, "nested", "walk", self.effort.slow_frames, *PAPER_SIZE, *AS_PUBLISHED, "--bias", BIAS,
                         "--strategies", "sw-b,coh", "--device", "software")

    def sweep(self, device):
        scene, path = ("hlod_5m", "walk") if "hlod_5m" in self.effort.scenes else ("hlod_grid", "close_ups")
        for bias in SWEEP:
            self.compare(f"bias_{bias.replace(',', '_')}", scene, "nested", path, self.effort.compared, *PAPER_SIZE, *AS_PUBLISHED, "--bias", bias,
                         "--strategies", "ideal", "--device", device, "--reference", self.effort.compared)

    def llvmpipe(self):
        for scene in self.scenes(SECOND_PAPER):
            for threads in ("0", "2"):
                self.compare(f"llvmpipe{threads}_{scene}", scene, "nested", "walk", self.effort.llvmpipe_frames, *PAPER_SIZE, *AS_PUBLISHED, "--bias", BIAS,
                             "--strategies", "bool,sw-b,simp,coh", "--device", "gl", LP_NUM_THREADS=threads)

    def cracks(self):
        for scene in self.effort.scenes:
            for path in SESSION if scene in FIRST_PAPER else ("walk", "overview"):
                for kind in ("nested", "shifted"):
                    self.compare(f"cracks_{scene}_{kind}_{path}", scene, kind, path, self.effort.crack_frames, *PAPER_SIZE, "--strategies", "vfc",
                                 "--reference", self.effort.crack_frames)

    def equal_errors(self):
        for scene, path in (("hlod_grid", "close_ups"), ("hlod_grid", "overview")):
            for kind in ("nested", "shifted"):
                for tolerance in TOLERANCES:
                    self.compare(f"rms_{scene}_{kind}_{path}_{tolerance}", scene, kind, path, self.effort.crack_frames, *PAPER_SIZE, "--strategies", "vfc",
                                 "--tolerance", tolerance, "--reference", self.effort.crack_frames)

    def geomorphs(self):
        for way, options in (("off", ()), ("on", ("--geomorph",))):
            self.compare(f"geomorph_{way}", "hlod_row", "shifted", "overview", 10 * self.effort.pop_frames, *PAPER_SIZE, "--strategies", "vfc", *options,
                         "--reference", self.effort.pop_frames)

    def fronts(self):
        for scene in self.scenes(("hlod_row", "hlod_grid")):
            self.run(f"fronts_{scene}", "validate", self.hlod(scene, "shifted"), "--fronts", self.effort.fronts)

    def scenes(self, wanted):
        return [scene for scene in wanted if scene in self.effort.scenes]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--occlod", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--reuse", action="store_true")
    parser.add_argument("--devices", default="virtual:query-dear,virtual:modern")
    options = parser.parse_args()
    effort = QUICK if options.quick else Effort()
    options.out.mkdir(parents=True, exist_ok=True)
    if not options.reuse:
        for file in options.out.glob("*.json"):
            file.unlink()
    runs = Runs(options.occlod.resolve(), options.out, effort, options.reuse)
    for scene in effort.scenes:
        runs.build(scene)
    runs.second_paper(options.devices)
    runs.first_paper(options.devices)
    runs.sweep(options.devices.split(",")[-1])
    runs.geomorphs()
    runs.equal_errors()
    runs.cracks()
    runs.fronts()
    runs.slow()
    runs.llvmpipe()
    about = {"date": datetime.date.today().isoformat(), "machine": f"{platform.processor() or platform.machine()}, {len(os.sched_getaffinity(0))} cores",
             "quick": options.quick, "bias": BIAS, "effort": dataclasses.asdict(effort)}
    (options.out / "about.json").write_text(json.dumps(about))


if __name__ == "__main__":
    main()
