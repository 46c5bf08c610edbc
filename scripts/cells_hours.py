#!/usr/bin/env python3
"""cells_hours.py SCENE [--hours H] [--occlod FILE] [--work FOLDER]: builds as many view cells of a scene as some hours of this machine give and prints one table.

What an earlier run has left in the folder of the parts is kept, and building goes on where it was stopped. Cells are not divided, so each is one cut. Seconds a cell are those from the
first part of this run to its last: without loading the scene. Figures for more cells than were built are an extrapolation, and the table calls them so."""
import argparse
import os
import pathlib
import re
import signal
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
PART = re.compile(r"[0-9a-f]{16}-(\d{8})-(\d{8})\.vpart")
MILLION = 1_000_000


def arguments():
    parser = argparse.ArgumentParser(description="As many view cells of a scene as some hours give, as one table")
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("--hours", type=float, default=3.0, help="wall time, with loading the scene")
    parser.add_argument("--occlod", type=pathlib.Path, default=ROOT / "build/bench/tools/occlod", help="built by scripts/build.sh bench")
    parser.add_argument("--work", type=pathlib.Path, help="folder of the parts; out/cells_hours/SCENE when not given")
    return parser.parse_args()


def parts_in(folder):
    """(time, cells) of each part, the oldest first."""
    found = [(file.stat().st_mtime, int(match[2])) for file in folder.glob("*.vpart") if (match := PART.fullmatch(file.name))]
    return sorted(found)


def build(options, work):
    """Builds until all is done or the time is over; returns whether all is done."""
    command = [options.occlod, "cells", "build", options.scene, "--work", work, "-o", work / "cells.vlod", "--image", "1024x768,60,0.1", "--max-triangles", "1000000000", "--progress", "never"]
    process = subprocess.Popen([str(part) for part in command], stdout=subprocess.DEVNULL)
    try:
        status = process.wait(timeout=3600 * options.hours)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGINT)
        process.wait()
        return False
    if status != 0:
        sys.exit(status)
    return True


def table(parts, begun, cores, done):
    """Parts made before `begun` are those of earlier runs."""
    cells, new = sum(count for _, count in parts), [part for part in parts if part[0] >= begun]
    yield f"| cells there{'' if done else ', not yet all'} | {cells:,} |"
    yield f"| of these, of this run | {sum(count for _, count in new):,} |"
    timed = sum(count for _, count in new[1:])
    if timed == 0:
        yield "| seconds a cell and core | too few parts to tell |"
        return
    seconds = (new[-1][0] - new[0][0]) / timed
    yield f"| seconds a cell, on {cores} cores | {seconds:.3g} |"
    yield f"| seconds a cell and core | {seconds * cores:.3g} |"
    yield f"| hours for a million cells on {cores} cores, *an extrapolation* | {seconds * MILLION / 3600:,.0f} |"


def main():
    options = arguments()
    work = options.work or ROOT / "out/cells_hours" / options.scene.stem
    work.mkdir(parents=True, exist_ok=True)
    begun = time.time()
    done = build(options, work)
    print("| what | |\n|---|---|")
    for row in table(parts_in(work), begun, len(os.sched_getaffinity(0)), done):
        print(row)
    return 0


if __name__ == "__main__":
    sys.exit(main())
