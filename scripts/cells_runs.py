#!/usr/bin/env python3
"""Makes the runs that scripts/cells_page.py shows, each in a file of its own; what is there already is kept.

cells_runs.py --occlod FILE --bench FOLDER --out FOLDER [--quick | --small] [--cluster FILE] [--check] [SCENE...]"""
import argparse
import dataclasses
import datetime
import json
import os
import pathlib
import shutil
import subprocess
import sys

import hlod_runs

ROOT = pathlib.Path(__file__).resolve().parents[1]
EYES = "1024x768,60,0.1"
TOLERANCES = (0.5, 1, 2, 4)
MODES = ("none", "hull", "sampled")
CLUSTER = ROOT / "bench/results/2026-11-23/cells_cluster.csv"


@dataclasses.dataclass(frozen=True)
class Effort:
    scenes: tuple = ("vlod_city_one",)
    folder: str = "meshes/scenes"
    cost_model: str = EYES  # of eyes, where accuracy is measured
    divide: tuple = ()  # how cells are divided at T and T/4, besides
    viewcells: tuple = ()
    compared: int = 60  # frames of each path that are counted
    cost_cells: int = 4  # along each side, of which accuracy is measured
    eyes: int = 50  # of each cell, that judge
    image_size: int = 512
    order: tuple = ()
    shrunk: tuple = ("--sampled",)
    rays: tuple = ("--seconds", "30")


QUICK = Effort(scenes=("vlod_city",), folder="bench/scenes/small", cost_model="512x384,60,0.1", viewcells=("--quick",), compared=30, cost_cells=2, eyes=10, image_size=256,
               order=("--side", "16", "--columns", "9000", "--sort", "1000000"), shrunk=("--sampled", "--blocks", "8", "--edges", "2,4,8", "--image-size", "512"),
               rays=("--blocks", "8", "--edges", "4", "--seconds", "5", "--eyes", "16", "--image-size", "256"))
# Whether everything is there, not what it is worth.
SMALL = Effort(scenes=("vlod_city",), folder="bench/scenes/small", cost_model="160x120,60,0.1", divide=("--root-cell", "8", "--smallest-cell", "4"), viewcells=("--quick",), compared=6, cost_cells=1, eyes=2, image_size=64,
               order=("--side", "4", "--columns", "1000", "--sort", "10000"), shrunk=("--blocks", "2", "--edges", "2,4", "--image-size", "128"),
               rays=("--blocks", "2", "--facade-cells", "4", "--edges", "2", "--seconds", "0.3", "--eyes", "2", "--image-size", "64"))


class Runs:
    def __init__(self, occlod, bench, out, effort):
        self.occlod, self.bench, self.out, self.effort = occlod, bench, out, effort

    def run(self, name, *command, may_fail=False):
        """Standard output, as a file of this name. `may_fail`: the program says by its exit status what it has found."""
        file = self.out / name
        if file.exists():
            return
        print(f"cells_report: {name}", file=sys.stderr)
        if not pathlib.Path(command[0]).is_file():
            sys.exit(f"cells_runs.py: {command[0]}: is not there: build it, or leave --occlod and --bench out")
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
        if done.returncode != 0 and not (may_fail and done.stdout):
            line = (done.stderr.strip().splitlines() or ["ended without a word"])[-1]
            sys.exit(f"cells_runs.py: {name}: {line}")
        part = file.with_suffix(".part")
        part.write_text(done.stdout)
        part.rename(file)

    def build(self, name, scene, *options, eyes=EYES):
        self.run(f"{name}_build.json", self.occlod, "cells", "build", scene, "-o", self.out / f"{name}.vlod", "--image", eyes, "--json", *options)
        return json.loads((self.out / f"{name}_build.json").read_text())

    def scene(self, scene):
        name = scene.stem
        whole = self.build(name, scene)
        self.run(f"{name}_viewcells.json", self.bench / "bench_viewcells", self.out / f"{name}.vlod", scene, *self.effort.viewcells)
        most = round(whole["drawn_median"])  # T: what half of all cells draw before any is divided
        for part, triangles in (("t", most), ("t4", max(1, most // 4))):
            self.build(f"{name}_{part}", scene, "--max-triangles", triangles, *self.effort.divide)
            self.run(f"{name}_{part}_walks.json", self.bench / "bench_cell_walks", self.out / f"{name}_{part}.vlod", scene, "--frames", self.effort.compared)
        self.costs(name, scene)

    def costs(self, name, scene):
        region = ",".join(f"{value:g}" for value in middle_of(json.loads(scene.read_text())["cells"], self.effort.cost_cells))
        for mode in MODES:
            for tolerance in TOLERANCES:
                cost = f"{name}_cost_{mode}_{tolerance:g}"
                self.build(cost, scene, "--region", region, "--max-triangles", 10**12, "--threads", 1, "--occlusion", mode, "--tolerance", tolerance,
                           eyes=self.effort.cost_model)
                self.run(f"{cost}_check.json", self.occlod, "cells", "validate", self.out / f"{cost}.vlod", scene, "--cells", self.effort.cost_cells**2,
                         "--eyes", self.effort.eyes, "--image-size", self.effort.image_size, "--json", may_fail=True)

    def beside(self):
        for name in ("order", "shrunk", "rays"):
            self.run(f"{name}.csv", self.bench / f"bench_cell_{name}", *getattr(self.effort, name))


def middle_of(cells, count):
    """So many root cells along x and y, as far as there are, in the middle of the first region."""
    low, high = cells["regions"][0]["min"], cells["regions"][0]["max"]
    edge, box = cells.get("root_cell", 16.0), [*low, *high]
    for axis in range(2):
        length = high[axis] - low[axis]
        size = min(length, count * edge)
        box[axis] = low[axis] + edge * int((length - size) / 2 / edge)
        box[3 + axis] = box[axis] + size
    return box


def scene_files(names, effort):
    """Complains before anything is built."""
    files = []
    for name in names or effort.scenes:
        file = pathlib.Path(name) if name.endswith(".json") else ROOT / effort.folder / f"{name}.json"
        if not file.is_file():
            sys.exit(f"cells_runs.py: {name}: there is no {file}: name a scene of {effort.folder}, or a file .json")
        try:
            scene = json.loads(file.read_text())
        except ValueError as error:
            sys.exit(f"cells_runs.py: {file}: is no JSON ({error}): name a scene file")
        if not isinstance(scene, dict) or not scene.get("cells", {}).get("regions") or not scene.get("paths"):
            sys.exit(f"cells_runs.py: {file}: has no cells with regions, or no paths to walk: add both, see docs/guide/scenes.md")
        files.append(file.resolve())
    return files


def check_kept(out, about):
    """What is kept has to fit what is made."""
    file = out / "about.json"
    if not file.exists():
        return
    kept = json.loads(file.read_text())
    if any(kept.get(key) != json.loads(json.dumps(about[key])) for key in ("effort", "scenes")):
        sys.exit(f"cells_runs.py: {out}: holds other scenes or runs of another length: delete it, or give another --out")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--occlod", type=pathlib.Path)
    parser.add_argument("--bench", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--small", action="store_true")
    parser.add_argument("--cluster", type=pathlib.Path, default=CLUSTER)
    parser.add_argument("--check", action="store_true", help="only look at the options")
    parser.add_argument("scenes", nargs="*")
    options = parser.parse_args()
    effort = SMALL if options.small else QUICK if options.quick else Effort()
    scenes = scene_files(options.scenes, effort)
    if not options.cluster.is_file():
        sys.exit(f"cells_runs.py: {options.cluster}: is not there: give --cluster a table of bench/cells_cluster.py")
    about = {"date": datetime.date.today().isoformat(), "machine": f"{hlod_runs.processor()}, {len(os.sched_getaffinity(0))} cores", "commit": hlod_runs.commit(),
             "quick": options.quick, "small": options.small, "scenes": [scene.stem for scene in scenes], "effort": dataclasses.asdict(effort)}
    check_kept(options.out, about)
    if options.check:
        return
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "about.json").write_text(json.dumps(about))
    shutil.copyfile(options.cluster, options.out / "cluster.csv")
    runs = Runs(options.occlod.resolve(), options.bench.resolve(), options.out.resolve(), effort)
    for scene in scenes:
        runs.scene(scene)
    runs.beside()


if __name__ == "__main__":
    main()
