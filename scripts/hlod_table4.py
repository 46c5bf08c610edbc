#!/usr/bin/env python3
"""hlod_table4.py FOLDER: table 4 of Guthe, Balazs and Klein 2006 with our scenes, devices and strategies, and what is asked of them with verdicts.
Draws what FOLDER lacks with `occlod hlod compare` (--occlod), and keeps its reports there as table4_SCENE_DEVICE.json and .csv."""
import argparse
import csv
import json
import math
import pathlib
import subprocess
import sys

SCENES = {"plant": "around", "city": "walk", "dragon_alone": "around", "car": "around"}
DEVICES = ("virtual:query-cheap", "virtual:query-dear", "virtual:fill-bound", "virtual:modern", "gl")
STRATEGIES = ("vfc", "bool", "chc++", "nohc", "optimum", "two-pass", "cesium", "batch", "auto")
NAMES = {"vfc": "VFC", "bool": "CHC", "nohc": "NOHC", "chc++": "CHC++"}
WINDOW = 30  # frames


def report_of(options, scene, device):
    name = f"table4_{scene}_{device.replace(':', '_')}"
    file, rows = options.folder / f"{name}.json", options.folder / f"{name}.csv"
    if not (file.exists() and rows.exists()):
        hlod = options.folder / f"{scene}_{options.grouping}.ohlod"
        source = options.scenes / f"{scene}.json"
        if not hlod.exists():
            borders = ["--grouping", "nested", "--borders", "free", "--node-triangles", "1000"] if options.grouping == "nested" else []
            run([options.occlod, "hlod", "build", source, "-o", hlod, *borders])
        frames = ["--frames", str(options.frames)] if options.frames else []
        out = run([options.occlod, "hlod", "compare", hlod, "--scene", source, "--path", SCENES[scene], *frames, "--bias", "none", "--tolerance",
                   str(options.tolerance), "--cover-model", options.cover_model, "--strategies", ",".join(STRATEGIES), "--device", device, "--csv", rows, "--json"])
        file.write_text(out)
    times = {}
    with rows.open() as lines:
        for row in csv.DictReader(lines):
            times.setdefault(row["strategy"], []).append(float(row["frame_ms"]))
    return {found["strategy"]: found for found in json.loads(file.read_text())["runs"]}, times


def run(command):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"hlod_table4.py: {done.stderr.strip().splitlines()[-1]}")
    return done.stdout


def geometric_mean(values):
    return math.exp(sum(map(math.log, values)) / len(values)) if values else float("nan")


def worst_window(times, other):
    """The largest ratio of the times of WINDOW frames in a row."""
    size = min(WINDOW, len(times))
    return max(sum(times[i:i + size]) / sum(other[i:i + size]) for i in range(len(times) - size + 1))


def print_table(results):
    for scene in dict.fromkeys(scene for scene, _ in results):
        devices = [device for s, device in results if s == scene]
        print(f"\n{scene}\n\n| ms, mean / largest | " + " | ".join(devices) + " |\n" + "|---" * (len(devices) + 1) + "|")
        for strategy in STRATEGIES:
            cells = [results[scene, device][0][strategy] for device in devices]
            print(f"| {NAMES.get(strategy, strategy)} | " + " | ".join(f"{c['frame_ms']:.3f} / {c['largest_frame_ms']:.3f}" for c in cells) + " |")


def verdict(what, value, limit, digits=3):
    print(f"| {what} | {value:.{digits}f} | {limit} | {'met' if value <= limit else 'missed'} |")


def print_verdicts(results):
    """Over simulated devices: real times differ from run to run."""
    runs = {key: found for key, found in results.items() if key[1].startswith("virtual:")}
    if not runs:
        return
    ratio = lambda a, b: [found[a]["frame_ms"] / found[b]["frame_ms"] for found, _ in runs.values()]
    print("\n| goal, over simulated devices | reached | at most | |\n|---|---|---|---|")
    verdict("NOHC / optimum, geometric mean", geometric_mean(ratio("nohc", "optimum")), 1.12)
    wasted = {s: sum(found[s]["wasted_queries"] for found, _ in runs.values()) for s in ("nohc", "bool")}
    verdict("wasted queries of NOHC / of CHC", wasted["nohc"] / max(wasted["bool"], 1e-9), 0.25)
    verdict(f"NOHC / VFC, worst {WINDOW} frames", max(worst_window(times["nohc"], times["vfc"]) for _, times in runs.values()), 1.02)
    verdict("batch / optimum, geometric mean", geometric_mean(ratio("batch", "optimum")), 0.95)
    verdict("batch / optimum, anywhere", max(ratio("batch", "optimum")), 1.02)
    fixed = ("vfc", "nohc", "batch", "bool")
    best = [found["auto"]["frame_ms"] / min(found[s]["frame_ms"] for s in fixed) for found, _ in runs.values()]
    verdict("auto / the best that it chooses from, anywhere", max(best), 1.03)
    verdict("auto / VFC, anywhere", max(ratio("auto", "vfc")), 1.02)
    verdict("batch / two-pass, geometric mean", geometric_mean(ratio("batch", "two-pass")), 0.9)
    triangles = [found["batch"]["drawn_triangles"] / found["cesium"]["drawn_triangles"] for found, _ in runs.values()]
    verdict("triangles of batch / of cesium, geometric mean", geometric_mean(triangles), 0.6)
    print("\n| scene, device | NOHC / optimum | CHC / optimum | VFC / optimum | batch / optimum | auto / best | hash of NOHC |\n" + "|---" * 7 + "|")
    for (scene, device), (found, _) in runs.items():
        cells = [found[s]["frame_ms"] / found["optimum"]["frame_ms"] for s in ("nohc", "bool", "vfc", "batch")]
        cells.append(found["auto"]["frame_ms"] / min(found[s]["frame_ms"] for s in fixed))
        print(f"| {scene}, {device} | " + " | ".join(f"{c:.3f}" for c in cells) + f" | {found['nohc']['hash']} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--occlod", default="build/release/tools/occlod")
    parser.add_argument("--scenes", type=pathlib.Path, default=pathlib.Path(__file__).parent.parent / "meshes/scenes")
    parser.add_argument("--only", default=",".join(SCENES), help="scenes, separated by commas")
    parser.add_argument("--devices", default=",".join(DEVICES))
    parser.add_argument("--frames", type=int, help="go along each path in so many")
    parser.add_argument("--tolerance", type=float, default=1.0, help="pixels; 0: leaves only, as in the paper")
    parser.add_argument("--grouping", choices=("shifted", "nested"), default="nested")
    parser.add_argument("--cover-model", choices=("printed", "corrected"), default="printed")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    results = {(scene, device): report_of(options, scene, device) for scene in options.only.split(",") for device in options.devices.split(",")}
    print_table(results)
    print_verdicts(results)


if __name__ == "__main__":
    main()
