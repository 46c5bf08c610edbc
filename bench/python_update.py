#!/usr/bin/env python3
"""python_update.py BENCH_UPDATE [--rounds N] [--budget N]: what Refiner.update() costs from Python beside C++, along paths of
three scenes: processor time a frame, the least of several rounds of both in turn. Run by a Python that has occlod; BENCH_UPDATE
is the program of bench/update.cpp. Prints CSV; exit status 1 where Python takes more than 5 % longer, or other triangles come out."""
import argparse
import json
import pathlib
import subprocess
import sys
import time

import occlod

ROOT = pathlib.Path(__file__).resolve().parents[1]
PATHS = [("planet_near", "low_flight"), ("planet_full", "orbit"), ("city", "walk")]
MOST = 1.05


def from_python(scene, name, budget, hold):
    objects = scene.load()
    views = [occlod.View(camera) for camera in scene.paths[name]]
    refiner, visibility = occlod.Refiner(objects), occlod.Visibility("software")
    seconds, triangles, code, held = 0.0, 0, 0, None
    for view in views:
        if not hold:
            held = None
        start = time.process_time()
        refined = refiner.update(view, budget, visibility)
        triangles += sum(len(refined.triangles(i)) for i in range(len(refined)))
        seconds += time.process_time() - start
        code = (code * 31 + refined.hash) % 2**64
        held = refined
        del refined
    del held
    return {"ms": 1e3 * seconds / len(views), "triangles": triangles, "hash": f"{code:016x}"}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("program")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--budget", type=int, default=10_000)
    arguments = parser.parse_args()
    failed = False
    print("scene,path,cpp_ms,python_ms,ratio,python_holding_ms,holding_ratio,hash")
    for scene_name, path in PATHS:
        file = ROOT / "meshes" / "scenes" / f"{scene_name}.json"
        scene = occlod.Scene.read(file)
        least = {}
        answers = set()
        for _ in range(arguments.rounds):
            results = {"cpp": json.loads(subprocess.run([arguments.program, str(file), path, str(arguments.budget)], check=True,
                                                        capture_output=True, text=True).stdout),
                       "python": from_python(scene, path, arguments.budget, False),
                       "holding": from_python(scene, path, arguments.budget, True)}
            for way, result in results.items():
                least[way] = min(least.get(way, float("inf")), result["ms"])
                answers.add((result["triangles"], result["hash"]))
        ratios = least["python"] / least["cpp"], least["holding"] / least["cpp"]
        print(f"{scene_name},{path},{least['cpp']:.3f},{least['python']:.3f},{ratios[0]:.3f},{least['holding']:.3f},{ratios[1]:.3f},"
              f"{' '.join(sorted(h for _, h in answers))}", flush=True)
        failed = failed or max(ratios) > MOST or len(answers) > 1
    sys.exit(int(failed))


if __name__ == "__main__":
    main()
