#!/usr/bin/env python3
"""Builds the HLODs and makes the runs that scripts/hlod_tables.py prints. Each run is one JSON object in its own file.

hlod_runs.py --occlod FILE --compare FILE --cover FILE --out FOLDER [--quick | --small] [--reuse] [--only PART,PART,...] [--crack-frames N]
             [--devices NAME,NAME,...] [--scenes FOLDER]"""
import argparse
import concurrent.futures
import dataclasses
import datetime
import json
import os
import pathlib
import platform
import subprocess
import sys

import hlod_splits

ROOT = pathlib.Path(__file__).resolve().parents[1]
SESSION = ("overview", "rotation", "close_ups")  # of Charalambos 2006: overall views, rotations, extreme close-ups
FIRST_PAPER = ("hlod_row", "hlod_grid", "hlod_shelves")
SECOND_PAPER = ("hlod_5m", "hlod_12m")
SPHERES = ("--metric", "sphere")
AS_PUBLISHED = (*SPHERES, "--coherence", "published")
BIAS = "1,0.1"  # chosen from the sweep
SWEEP = ("none", "0,0", "1,0", "0.5,0.1", "1,0.1", "1,0.2", "1,0.3", "1,0.5")
NESTED_TRIANGLES = {"hlod_12m": 2600}  # for about as many nodes as the papers have
TOLERANCES = (0.5, 0.7, 1, 1.4, 2)
GUTHE = {"plant": "around", "city": "walk", "dragon_alone": "around", "car": "around"}  # the scenes of Guthe and others 2006, and their paths
PRESETS = "virtual:query-cheap,virtual:query-dear,virtual:fill-bound,virtual:modern"
PRINTED = ("--cover-model", "printed")  # as Guthe and others
TABLE_4 = "vfc,bool,coh,chc++,nohc,optimum,two-pass,cesium,batch,auto"
KINDS = {"nested": ("--grouping", "nested", "--borders", "free"), "shifted": (),
         "objects": ("--grouping", "nested", "--borders", "free", "--node-triangles", 1000)}  # of at most 1,000 triangles, as in Guthe and others 2006


@dataclasses.dataclass(frozen=True)
class Effort:
    scenes: tuple = FIRST_PAPER + SECOND_PAPER
    session_frames: int = 200  # of each of the three paths
    walk_frames: int = 600
    slower: tuple = (2, 5)  # the walk at these parts of its speed
    places: int = 20  # of the walk, where the camera stands still
    stand_frames: int = 24  # at each, the last four of which count
    compared: int = 20
    crack_frames: int = 8  # of each path; or as --crack-frames says
    error_frames: int = 8  # of each path, for triangles at equal errors
    pop_frames: int = 60
    llvmpipe_frames: int = 30
    fronts: int = 10_000
    # Of the paths of GUTHE, from their beginning. All of the plant is in view, so a frame of it takes as long as a hundred of the others.
    guthe: dict = dataclasses.field(default_factory=lambda: {"plant": 0.03, "city": 1.0, "dragon_alone": 1.0, "car": 0.5})
    # How many times as many frames that part has: what is visible is asked about after some 50 to 300 frames.
    guthe_frames: dict = dataclasses.field(default_factory=lambda: {"plant": 1, "city": 2.5, "dragon_alone": 2.5, "car": 2.5})
    lengths: dict = dataclasses.field(default_factory=lambda: {"plant": (1, 16, 60), "city": (1, 2.5, 10), "dragon_alone": (1, 2.5, 10), "car": (1, 2.5, 10)})
    llvmpipe_share: float = 0.15  # of these shares
    leaves_share: float = 0.15
    splits: tuple = tuple(hlod_splits.SCENES)  # along their whole paths
    cover_frames: int = 16  # of each path
    cover_images: int = 100  # of random ellipsoids
    size: str = "640x480"
    guthe_size: str = "1024x768"


QUICK = Effort(scenes=("hlod_row", "hlod_grid"), session_frames=20, walk_frames=20, slower=(5,), places=4, compared=3, crack_frames=2, error_frames=2, pop_frames=4,
               llvmpipe_frames=3, fronts=100, guthe={"city": 0.3, "dragon_alone": 0.25},
               guthe_frames={"city": 1, "dragon_alone": 1}, lengths={"dragon_alone": (1, 4)}, llvmpipe_share=0.1, leaves_share=0.2, splits=("armadillo", "city"), cover_frames=4, cover_images=3)
# Of scenes of some thousand triangles (bench/scenes/small): whether everything is there, not what it is worth.
SMALL = Effort(session_frames=6, walk_frames=8, slower=(2,), places=2, stand_frames=6, compared=2, crack_frames=1, error_frames=1, pop_frames=1, llvmpipe_frames=2, fronts=4,
               guthe=dict.fromkeys(GUTHE, 0.2), guthe_frames=dict.fromkeys(GUTHE, 1), lengths=dict.fromkeys(GUTHE, (1, 2)),
               llvmpipe_share=0.1, leaves_share=0.1, splits=("city",), cover_frames=2, cover_images=1, size="192x144", guthe_size="192x144")


class Runs:
    def __init__(self, programs, out, scenes, effort, reuse):
        self.occlod, self.compare_program, self.cover_probability = programs
        self.out, self.scene_files, self.effort, self.reuse = out, scenes, effort, reuse
        self.size = ("--size", effort.size)

    def run(self, name, *command, **environment):
        self.run_program(name, self.occlod, "hlod", *command, **environment)

    def run_program(self, name, *command, **environment):
        file = self.out / f"{name}.json"
        if self.reuse and file.exists() and file.stat().st_size > 0:
            return
        print(f"hlod_tables: {name}", file=sys.stderr)
        done = subprocess.run([*map(str, command), "--json"], capture_output=True, text=True, env={**os.environ, **environment})
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

    def build(self, scene, *kinds):
        for kind in kinds:
            if not (self.reuse and self.hlod(scene, kind).exists()):
                (self.out / f"{scene}_{kind}.json").unlink(missing_ok=True)
                most = ("--node-triangles", NESTED_TRIANGLES.get(scene, 2000)) if kind == "nested" else ()
                self.run(f"{scene}_{kind}", "build", self.scene_file(scene), "-o", self.hlod(scene, kind), *KINDS[kind], *most)

    def scene_file(self, scene):
        return self.scene_files / f"{scene}.json"

    def compare(self, name, scene, kind, path, frames, *options, **environment):
        self.compare_along(name, self.scene_file(scene), scene, kind, path, "--frames", frames, *options, **environment)

    def compare_along(self, name, cameras, scene, kind, path, *options, **environment):
        """Keeps the frames of each run as well, as NAME.csv."""
        self.run_program(name, self.compare_program, self.hlod(scene, kind), "--scene", cameras, "--path", path, "--csv", self.out / f"{name}.csv", *options, **environment)

    def first_paper(self, devices):
        """B = mu and alpha as in Charalambos 2006."""
        for scene in self.scenes(FIRST_PAPER):
            for path in SESSION:
                self.compare(f"first_{scene}_{path}", scene, "nested", path, self.effort.session_frames, *self.size, *AS_PUBLISHED, "--alpha", "paper",
                             "--bias", "0,0", "--strategies", "sw,sw-b,bool,simp", "--device", devices)

    def second_paper(self, devices):
        strategies = ("--bias", BIAS, "--strategies", "bool,sw-b,simp,coh", "--device", devices)
        mended = ("--bias", BIAS, "--strategies", "coh", "--device", devices)
        for scene in self.scenes(SECOND_PAPER):
            self.compare(f"second_{scene}_walk", scene, "nested", "walk", self.effort.walk_frames, *self.size, *AS_PUBLISHED, *strategies,
                         "--reference", self.effort.compared)
            self.compare(f"mended_{scene}_walk", scene, "nested", "walk", self.effort.walk_frames, *self.size, *SPHERES, *mended, "--reference", self.effort.compared)
            self.compare(f"ours_{scene}_walk", scene, "shifted", "walk", self.effort.walk_frames, *self.size, *strategies, "--reference", self.effort.compared)
        self.still()

    def sessions(self, devices):
        """The strategies of 2007 in the scenes of 2006."""
        strategies = ("--bias", BIAS, "--strategies", "bool,sw-b,simp,coh", "--device", devices)
        mended = ("--bias", BIAS, "--strategies", "coh", "--device", devices)
        for scene in self.scenes(FIRST_PAPER):
            for path in SESSION:
                self.compare(f"second_{scene}_{path}", scene, "nested", path, self.effort.session_frames, *self.size, *AS_PUBLISHED, *strategies)
                self.compare(f"mended_{scene}_{path}", scene, "nested", path, self.effort.session_frames, *self.size, *SPHERES, *mended)

    def both_ways(self, name, scene, cameras, path, *options):
        """SW(B), and Coh(B) as published and mended, with answers at once (`software`) and late."""
        for way, how, strategies, device in (("prompt", AS_PUBLISHED, "sw-b,coh", "software"), ("late", AS_PUBLISHED, "coh", "virtual:modern"),
                                             ("promptmended", SPHERES, "coh", "software"), ("latemended", SPHERES, "coh", "virtual:modern")):
            self.compare_along(f"{name}_{way}_{scene}", cameras, scene, "nested", path, *self.size, *how, "--bias", BIAS, "--strategies", strategies,
                               "--device", device, *options)

    def still(self):
        """Where nothing moves, what is predicted is what was answered: only late answers make Coh(B) draw more."""
        for scene in self.scenes(SECOND_PAPER):
            cameras = standing_still(self.scene_file(scene), "walk", self.effort.places, self.effort.stand_frames, self.out / f"{scene}_still.cameras.json")
            self.both_ways("still", scene, cameras, "still")

    def slow(self):
        """The same walk, and slower: what is predicted from the frame before gets better."""
        for scene in self.scenes(SECOND_PAPER):
            for part in (1, *self.effort.slower):
                self.both_ways(f"slow{part}", scene, self.scene_file(scene), "walk", "--frames", part * self.effort.walk_frames)

    def sweep(self, device):
        scene, path = ("hlod_5m", "walk") if "hlod_5m" in self.effort.scenes else ("hlod_grid", "close_ups")
        for bias in SWEEP:
            self.compare(f"bias_{bias.replace(',', '_')}", scene, "nested", path, self.effort.compared, *self.size, *AS_PUBLISHED, "--bias", bias,
                         "--strategies", "ideal", "--device", device, "--reference", self.effort.compared)

    def llvmpipe(self):
        for scene in self.scenes(SECOND_PAPER):
            for threads in ("0", "2"):
                self.compare(f"llvmpipe{threads}_{scene}", scene, "nested", "walk", self.effort.llvmpipe_frames, *self.size, *AS_PUBLISHED, "--bias", BIAS,
                             "--strategies", "bool,sw-b,simp,coh", "--device", "gl", LP_NUM_THREADS=threads)

    def cracks(self):
        for scene in self.effort.scenes:
            for path in SESSION if scene in FIRST_PAPER else ("walk", "overview"):
                for kind in ("nested", "shifted"):
                    name, frames = f"cracks_{scene}_{kind}_{path}", self.effort.crack_frames
                    self.forget_other_length(name, frames)
                    self.compare(name, scene, kind, path, frames, *self.size, "--strategies", "vfc", "--reference", frames)

    def forget_other_length(self, name, frames):
        """A run of another --crack-frames is not kept."""
        file = self.out / f"{name}.json"
        if file.exists() and json.loads(file.read_text())["runs"][0]["compared_frames"] != frames:
            file.unlink()

    def equal_errors(self):
        for scene, path in (("hlod_grid", "close_ups"), ("hlod_grid", "overview")):
            for kind in ("nested", "shifted"):
                for tolerance in TOLERANCES:
                    self.compare(f"rms_{scene}_{kind}_{path}_{tolerance}", scene, kind, path, self.effort.error_frames, *self.size, "--strategies", "vfc",
                                 "--tolerance", tolerance, "--reference", self.effort.error_frames)

    def geomorphs(self):
        for way, options in (("off", ()), ("on", ("--within", "geomorph"))):
            self.compare(f"geomorph_{way}", "hlod_row", "shifted", "overview", 10 * self.effort.pop_frames, *self.size, "--strategies", "vfc", *options,
                         "--reference", self.effort.pop_frames)

    def fronts(self):
        for scene in self.effort.scenes:
            self.run(f"fronts_{scene}", "validate", self.hlod(scene, "shifted"), "--fronts", self.effort.fronts)

    def table_4(self):
        """Guthe and others 2006: whatever is visible counts in full, so all but cesium draw the same picture. Simulated times are the same however many
        programs run; llvmpipe runs alone."""
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            list(pool.map(self.simulated_table_4, self.effort.guthe))
            list(pool.map(self.lengths, self.effort.lengths))
        for scene, share in self.effort.guthe.items():
            self.guthe(f"table4gl_{scene}", scene, share * self.effort.llvmpipe_share, "--strategies", TABLE_4, "--device", "gl", LP_NUM_THREADS="2")

    def simulated_table_4(self, scene):
        share, times = self.effort.guthe[scene], self.effort.guthe_frames[scene]
        self.guthe(f"table4_{scene}", scene, share, "--strategies", TABLE_4, "--device", PRESETS, times=times)
        self.guthe(f"table4printed_{scene}", scene, share, "--strategies", "nohc", "--device", PRESETS, *PRINTED, times=times)
        self.guthe(f"table4leaves_{scene}", scene, share * self.effort.leaves_share, "--strategies", "vfc,bool,nohc,optimum", "--device", PRESETS, "--tolerance", 0, *PRINTED)
        if scene == "city":  # where little is hidden
            self.guthe("figure8_city", scene, share, "--strategies", "vfc,bool,nohc,optimum,batch,auto", "--device", "virtual:query-dear", path="fly_over")

    def lengths(self, scene):
        """The same part of the path in more frames."""
        for times in self.effort.lengths[scene]:
            for name, strategies, model in (("lengthprinted", "nohc,optimum", PRINTED), ("length", "nohc", ())):
                self.guthe(f"{name}_{scene}_{times:g}", scene, self.effort.guthe[scene], "--strategies", strategies, "--device", "virtual:query-cheap", *model, times=times)

    def guthe(self, name, scene, share, *options, path=None, times=1, **environment):
        path = path or GUTHE[scene]
        cameras = part_of_path(self.scene_file(scene), path, share, times, self.out / f"{scene}_{path}_{share:g}_{times:g}.cameras.json")
        self.compare_along(name, cameras, scene, "objects", path, "--size", self.effort.guthe_size, "--bias", "none", *options, **environment)

    def cover(self):
        """Fig. 3 there."""
        self.run_program("cover_ellipsoids", self.cover_probability, "--runs", self.effort.cover_images)
        for scene in self.effort.guthe:
            self.run_program(f"cover_{scene}", self.cover_probability, "--scene", self.scene_file(scene), "--hlod", self.hlod(scene, "objects"),
                             "--path", GUTHE[scene], "--frames", self.effort.cover_frames)

    def splits(self):
        """Where HLODs pay more than refinement by splits."""
        for scene in self.effort.splits:
            path, budget = hlod_splits.SCENES[scene]
            self.run_program(f"splits_{scene}", self.occlod, "render", self.scene_file(scene), "--path", path, "--frame-to-frame", "--budget", budget,
                             "--occlusion", "auto", "--explain", "--threads", 1, "--size", self.effort.guthe_size)

    def scenes(self, wanted):
        return [scene for scene in wanted if scene in self.effort.scenes]


def part_of_path(file, path, share, times, part):
    """The scene, but only the first keys of its path, with so many times as many frames between them as before."""
    scene = json.loads(file.read_text())
    keys, frames = scene["paths"][path]["keys"], scene["paths"][path]["frames"]
    kept = min(len(keys), max(2, round(share * (len(keys) - 1)) + 1))
    scene["paths"] = {path: {**scene["paths"][path], "keys": keys[:kept], "frames": max(2, round(times * frames * (kept - 1) / (len(keys) - 1)))}}
    part.write_text(json.dumps(scene))
    return part


def standing_still(file, path, places, frames, cameras):
    """The scene with a path that stands still at so many places of another, so many frames at each."""
    scene = json.loads(file.read_text())
    keys = scene["paths"][path]["keys"]
    scene["paths"] = {"still": {"frames": places * frames, "jump": True, "keys": [between(keys, (i + 0.5) / places * (len(keys) - 1)) for i in range(places)]}}
    cameras.write_text(json.dumps(scene))
    return cameras


def between(keys, place):
    """The camera at a place along keys, counted in keys."""
    a, b, t = keys[int(place)], keys[int(place) + 1], place - int(place)
    return {name: [x + (y - x) * t for x, y in zip(a[name], b[name])] if isinstance(a[name], list) else a[name] for name in a}


# What --only names, in the order in which it is done.
PARTS = {"second": lambda runs, devices: runs.second_paper(devices), "sessions": lambda runs, devices: runs.sessions(devices), "first": lambda runs, devices: runs.first_paper(devices),
         "sweep": lambda runs, devices: runs.sweep(devices.split(",")[-1]), "geomorphs": lambda runs, _: runs.geomorphs(),
         "equal_errors": lambda runs, _: runs.equal_errors(), "cracks": lambda runs, _: runs.cracks(), "fronts": lambda runs, _: runs.fronts(),
         "slow": lambda runs, _: runs.slow(), "llvmpipe": lambda runs, _: runs.llvmpipe(), "table4": lambda runs, _: runs.table_4(), "cover": lambda runs, _: runs.cover(),
         "splits": lambda runs, _: runs.splits()}
OF_GUTHE, OF_SCENES = {"table4", "cover"}, {"splits"}  # parts with HLODs of their own, and those that need none


def main():
    options = read_options()
    effort = effort_of(options)
    about = {"date": datetime.date.today().isoformat(), "machine": f"{processor()}, {len(os.sched_getaffinity(0))} cores", "quick": options.quick,
             "small": options.small, "commit": commit(), "bias": BIAS, "effort": dataclasses.asdict(effort)}
    if options.reuse or options.only:
        check_kept(options.out, about)
    if not options.check:
        make(options, effort, about)


def make(options, effort, about):
    options.out.mkdir(parents=True, exist_ok=True)
    if not (options.reuse or options.only):
        for file in (*options.out.glob("*.json"), *options.out.glob("*.csv")):
            file.unlink()
    (options.out / "about.json").write_text(json.dumps(about))
    runs = Runs((options.occlod.resolve(), options.compare.resolve(), options.cover.resolve()), options.out.resolve(), options.scenes.resolve(), effort, options.reuse)
    chosen = options.only or list(PARTS)
    if set(chosen) - OF_GUTHE - OF_SCENES:
        for scene in effort.scenes:
            runs.build(scene, "nested", "shifted")
    if set(chosen) & OF_GUTHE:
        for scene in effort.guthe:
            runs.build(scene, "objects")
    for part in chosen:
        PARTS[part](runs, options.devices)


def read_options():
    parser = argparse.ArgumentParser()
    parser.add_argument("--occlod", type=pathlib.Path, required=True)
    parser.add_argument("--compare", type=pathlib.Path, required=True, help="bench_hlod_compare")
    parser.add_argument("--cover", type=pathlib.Path, required=True, help="bench_cover_probability")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--scenes", type=pathlib.Path, default=ROOT / "meshes/scenes")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--small", action="store_true")
    parser.add_argument("--reuse", action="store_true")
    parser.add_argument("--only", type=known_parts, help=", ".join(PARTS))
    parser.add_argument("--crack-frames", type=positive, help="of each path in which crack pixels are counted")
    parser.add_argument("--devices", default="virtual:query-dear,virtual:modern")
    parser.add_argument("--check", action="store_true", help="only look at the options")
    return parser.parse_args()


def effort_of(options):
    effort = SMALL if options.small else QUICK if options.quick else Effort()
    return dataclasses.replace(effort, crack_frames=options.crack_frames) if options.crack_frames else effort


def known_parts(text):
    for part in text.split(","):
        if part not in PARTS:
            raise argparse.ArgumentTypeError(f"there is no '{part}': {', '.join(PARTS)}")
    return text.split(",")


def positive(text):
    if not text.isdecimal() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number above 0")
    return int(text)


def check_kept(out, about):
    """What is kept has to fit what is made."""
    file = out / "about.json"
    if file.exists() and length_of(json.loads(file.read_text())) != length_of(json.loads(json.dumps(about))):
        sys.exit(f"hlod_runs.py: {out}: holds runs of another length (--quick, --small, or an earlier version): delete it, or leave --reuse and --only out")


def length_of(about):
    """But for the frames in which cracks are counted: each run says how many."""
    return {name: value for name, value in about["effort"].items() if name != "crack_frames"}


def processor():
    lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines() if pathlib.Path("/proc/cpuinfo").exists() else []
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), platform.machine())


def commit():
    done = subprocess.run(["git", "-C", ROOT, "describe", "--always", "--dirty"], capture_output=True, text=True)
    return done.stdout.strip() or "not told"


if __name__ == "__main__":
    main()
