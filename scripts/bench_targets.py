#!/usr/bin/env python3
"""Runs what scripts/targets_table.py judges: this version and, where it is given, an earlier one in turns. Writes every number that was measured.

bench_targets.py --build FOLDER [--reference FILE] [--quick] --out FILE
  --build      the build folder of this version: its command line, benchmarks and pinned hashes
  --reference  the command line of the earlier version
"""
import argparse
import csv
import dataclasses
import datetime
import hashlib
import json
import os
import pathlib
import platform
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
SCENES = ROOT / "meshes" / "scenes"
PAPER_SCENES = ("armadillo", "armadillo_group", "planet_full", "planet_near")
INNER_SCENES = ("sponza", "sibenik", "city", "ww2_city")
STAR_SOFTWARE = ("--occlusion", "software")
STAR = ("--occlusion", "none")
FRAMES = (*STAR_SOFTWARE, "--frame-to-frame")
PAPERS_OWN = ("--paper",)
PAPERS_OWN_BEFORE = ("--culling", "subtree", "--proxy", "cylinder", "--occluder-splits", "300,2500")  # in 582fcf1
MILLION = (*PAPERS_OWN, "--occlusion", "none", "--budget", "1000000")


@dataclasses.dataclass(frozen=True)
class Effort:
    rounds: int = 7  # of each path and view
    million_rounds: int = 4
    path_frames: int = 60  # of each path at most, from frame to frame and from scratch
    path_rounds: int = 3
    effect_scenes: tuple = ()  # all
    effect_rounds: int = 7
    build_meshes: tuple = ()  # all
    build_rounds: int = 5
    large_planet: bool = True  # of level 10


QUICK = Effort(rounds=3, million_rounds=2, path_frames=20, path_rounds=2, effect_scenes=PAPER_SCENES, effect_rounds=2,
               build_meshes=("planet:8", "scans/armadillo_100k.obj"), build_rounds=3, large_planet=False)


class Failure(Exception):
    """A program that could not measure; the message is its last line."""


def run(command, **environment):
    done = subprocess.run([str(part) for part in command], env={**os.environ, **environment}, capture_output=True, text=True)
    if done.returncode != 0:
        lines = done.stderr.strip().splitlines() or [f"{command[0]} ended with {done.returncode}"]
        raise Failure(lines[-1])
    for line in done.stderr.splitlines():
        if line.startswith("SKIPPED"):
            print(line, file=sys.stderr)
    return done.stdout


@dataclasses.dataclass(frozen=True)
class Version:
    """A built command line. Each has a cache of hierarchies of its own."""
    name: str
    occlod: pathlib.Path
    cache: pathlib.Path
    papers_own: tuple = PAPERS_OWN  # what this version calls it

    def run(self, *command):
        return run(command, XDG_CACHE_HOME=str(self.cache))

    def render(self, scene, *options):
        threads = () if "--threads" in options else ("--threads", "1")
        options = [part for option in options for part in (self.papers_own if (option,) == PAPERS_OWN else (option,))]
        return json.loads(self.run(self.occlod, "render", scene, "--json", *options, *threads))


@dataclasses.dataclass(frozen=True)
class PathSubject:
    """What is timed along a path: by the earlier version, by this one, and by this one on two threads where that is asked for."""
    key: str
    scene: pathlib.Path
    options: tuple
    two_threads: bool = False
    rounds: int = 1

    def ways(self, versions):
        for version in versions:
            yield version.name, version, self.options
        if self.two_threads and len(os.sched_getaffinity(0)) > 1:
            yield "present, 2 threads", versions[-1], (*self.options, "--threads", "2")

    def measure(self, versions):
        """For each way: ms of refinement and occlusion for each round and frame, and what came out."""
        ways = list(self.ways(versions))
        result = {name: {"rounds": []} for name, _, _ in ways}
        for at in range(self.rounds):
            for name, version, options in ways[at % len(ways):] + ways[:at % len(ways)]:
                frames = version.render(self.scene, "--path", "orbit", *options)["frames"]
                result[name]["rounds"].append([frame["refine_ms"] + frame["occlusion_ms"] for frame in frames])
                result[name].update(hash=hash_of(frames), triangles=max(frame["triangles"] for frame in frames),
                                    visible_share=sum(frame["visible_share"] for frame in frames) / len(frames))
        return result


def hash_of(frames):
    return hashlib.sha256("".join(frame["hash"] for frame in frames).encode()).hexdigest()[:16]


def changed_scene(folder, name, scene, change):
    """A shipped scene with a change, as a file."""
    description = json.loads((SCENES / f"{scene}.json").read_text())
    change(description)
    path = folder / f"{name}.json"
    path.write_text(json.dumps(description))
    return path


def planet(level, frames):
    """As many frames of the orbit as there is time for with a million triangles."""
    def change(description):
        description["objects"][0]["options"]["level"] = level
        description["paths"]["orbit"]["frames"] = frames
    return change


def path_subjects(effort, folder):
    armadillo = SCENES / "armadillo.json"
    planet_8 = changed_scene(folder, "planet_8", "planet_full", planet(8, 13))
    planet_9 = changed_scene(folder, "planet_9", "planet_full", planet(9, 40))
    subjects = [
        PathSubject("star_software", armadillo, STAR_SOFTWARE, False, effort.rounds),
        PathSubject("subtree_software", armadillo, (*PAPERS_OWN, "--occlusion", "software"), False, effort.rounds),
        PathSubject("star", armadillo, STAR, False, effort.rounds),
        PathSubject("frames", armadillo, FRAMES, True, effort.rounds),
        PathSubject("frames_100000", planet_9, (*FRAMES, "--budget", "100000"), True, effort.million_rounds),
        PathSubject("million_planet_full", planet_8, MILLION, True, effort.million_rounds)]
    if effort.large_planet:
        planet_10 = changed_scene(folder, "planet_10", "planet_full", planet(10, 13))
        subjects.append(PathSubject("million_level_10", planet_10, MILLION, True, effort.million_rounds))
    return subjects


def measure_frame(scene, versions, rounds):
    """For each version without and with occlusion, and for the last also with pictures: ms of refinement, occlusion and drawing from frame to frame,
    of each round and frame."""
    path = "low_flight" if scene == "planet_near" else "orbit"
    ways = [(version, occlusion) for version in versions for occlusion in ("none", "software")] + [(versions[-1], "picture")]
    result = {version.name: {} for version in versions}
    for at in range(rounds):
        for version, occlusion in ways[at % len(ways):] + ways[:at % len(ways)]:
            frames = version.render(SCENES / f"{scene}.json", "--path", path, "--frame-to-frame", "--occlusion", occlusion)["frames"]
            result[version.name].setdefault(occlusion, []).append(
                [frame["refine_ms"] + frame["occlusion_ms"] + frame.get("show_ms", 0.0) + frame["draw_ms"] for frame in frames])
    return result


def measure_pictures(scene, versions):
    """For each version and way: how far the default view of 10,000 triangles is from the full mesh's. Such figures are the same in each run."""
    ways = {"star + software": STAR_SOFTWARE, "star": STAR, "paper's LOD + software": (*PAPERS_OWN, "--occlusion", "software"),
            "paper's LOD": (*PAPERS_OWN, "--occlusion", "none")}
    keys = ("triangles", "visible_share", "depth_rms_px", "silhouette_mismatch", "hash")
    result = {}
    for version in versions:
        for way, options in ways.items():
            report = version.render(SCENES / f"{scene}.json", "--reference", *options)
            result.setdefault(version.name, {})[way] = {key: report[key] for key in keys}
    return result


def measure_frames(version, bench, effort, folder):
    path = folder / "frames.json"
    version.run(bench / "bench_frames", "--tables", "scenes", "--frames", effort.path_frames, "--repeat", effort.path_rounds, "--json", path)
    return json.loads(path.read_text())


def measure_effects(version, bench, effort, folder):
    path = folder / "effects.csv"
    scenes = ("--scene", *effort.effect_scenes) if effort.effect_scenes else ()
    version.run(bench / "visibility" / "bench_effects", "--frames", 1, "--search", 1, "--repeat", effort.effect_rounds, *scenes, "--out", path)
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def measure_building(version, bench, effort, folder):
    path = folder / "build.json"
    version.run(bench / "bench_build_peers", *effort.build_meshes, "--tools", "occlod", "meshoptimizer", "--repeat", effort.build_rounds, "--json", path)
    return json.loads(path.read_text())["rows"]


def measure_built_files(versions, folder):
    """SHA-256 of a hierarchy's file by version and threads."""
    mesh = folder / "planet.ply"
    versions[-1].run(versions[-1].occlod, "generate", "rough-planet", "level=7", "-o", mesh)
    result = {}
    for version in versions:
        for threads in (1, 2):
            version.run(version.occlod, "build", mesh, "-o", folder / "planet.olod", "--threads", threads)
            result.setdefault(version.name, {})[str(threads)] = hashlib.sha256((folder / "planet.olod").read_bytes()).hexdigest()
    return result


def measure_pinned_hashes(build, folder):
    """The tests that compare with tests/hashes/expected.txt: whether each passed."""
    report = folder / "hashes.json"
    try:
        run([build / "tests" / "hashes" / "test_hashes", f"--gtest_output=json:{report}"])
    except Failure:
        if not report.exists():
            raise
    suites = json.loads(report.read_text())["testsuites"]
    return {f"{suite['name']}.{test['name']}": "failures" not in test for suite in suites for test in suite["testsuite"]
            if test["result"] == "COMPLETED"}


def take_two_cores():
    """What uses all cores takes two, so that rows of two threads mean the same on every machine. Of different cores where there are two."""
    chosen, cores = [], set()
    allowed = sorted(os.sched_getaffinity(0))
    for cpu in allowed:
        siblings = pathlib.Path(f"/sys/devices/system/cpu/cpu{cpu}/topology/thread_siblings_list")
        core = siblings.read_text() if siblings.exists() else str(cpu)
        if core not in cores:
            cores.add(core)
            chosen.append(cpu)
    os.sched_setaffinity(0, (chosen + [cpu for cpu in allowed if cpu not in chosen])[:2])


def processor():
    info = pathlib.Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), platform.processor())


def about(quick):
    described = subprocess.run(["git", "-C", ROOT, "describe", "--always", "--dirty"], capture_output=True, text=True)
    return {"date": datetime.date.today().isoformat(), "commit": described.stdout.strip() or "unknown", "processor": processor(),
            "cores": os.cpu_count(), "load_before": os.getloadavg()[0], "quick": quick}


def steps(effort, build, versions, folder):
    """(section, key, what measures it)"""
    bench, present = build / "bench", versions[-1]
    yield "hashes", "pinned", lambda: measure_pinned_hashes(build, folder)
    yield "hashes", "built", lambda: measure_built_files(versions, folder)
    for subject in path_subjects(effort, folder):
        yield "paths", subject.key, lambda subject=subject: subject.measure(versions)
    for scene in PAPER_SCENES:
        yield "whole_frame", scene, lambda scene=scene: measure_frame(scene, versions, effort.rounds)
        yield "pictures", scene, lambda scene=scene: measure_pictures(scene, versions)
    for scene in INNER_SCENES:
        yield "pictures", scene, lambda scene=scene: measure_pictures(scene, [present])
    yield "programs", "building", lambda: measure_building(present, bench, effort, folder)
    yield "programs", "frames", lambda: measure_frames(present, bench, effort, folder)
    yield "programs", "effects", lambda: measure_effects(present, bench, effort, folder)


def measure(options):
    effort = QUICK if options.quick else Effort()
    caches = options.out.parent / "caches"
    shutil.rmtree(caches / "present", ignore_errors=True)  # hierarchies that this very version builds
    versions = [Version("present", options.build / "tools" / "occlod", caches / "present")]
    if options.reference:
        versions.insert(0, Version("reference", options.reference, caches / "reference", PAPERS_OWN_BEFORE))
    result = {"about": about(options.quick)}
    start = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="occlod-targets-") as folder:
        for section, key, work in steps(effort, options.build, versions, pathlib.Path(folder)):
            print(f"{time.monotonic() - start:6.0f} s  {section}: {key}", file=sys.stderr, flush=True)
            try:
                value = work()
            except (Failure, OSError, ValueError) as failure:
                print(f"SKIPPED: {section}: {key}: {failure}", file=sys.stderr)
                value = {"failed": str(failure)}
            result.setdefault(section, {})[key] = value
    result["about"].update(seconds=round(time.monotonic() - start), load_after=os.getloadavg()[0])
    return result


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--reference", type=pathlib.Path)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    options = parser.parse_args(arguments)
    for occlod in filter(None, (options.build / "tools" / "occlod", options.reference)):
        if not occlod.exists():
            sys.exit(f"bench_targets.py: {occlod}: is not there: run scripts/bench_targets.sh, which builds it")
    options.out = options.out.resolve()
    options.out.parent.mkdir(parents=True, exist_ok=True)
    take_two_cores()
    part = options.out.with_suffix(".part")
    part.write_text(json.dumps(measure(options)) + "\n")
    part.replace(options.out)


if __name__ == "__main__":
    main(sys.argv[1:])
