#!/usr/bin/env python3
"""viewcells_table.py FILE [FILE...]: what walking through view cells is asked to reach and what runs of bench_viewcells measured, as one Markdown table for each.

Only the targets stand here; every figure comes from the files. docs/benchmarks/view_cells.md says what each row means."""
import json
import pathlib
import sys


def worst(run, part, key, pick=max):
    """Over all paths that were compared; None where none was."""
    values = [path["compared"][part][key] for path in run["paths"].values() if "compared" in path]
    return pick(values) if values else None


def over_paths(run, part, key, pick=max):
    return pick(path[part][key] for path in run["paths"].values())


def rows(run):
    """Number of the goal, what, figure, what is asked, met."""
    cuts, paths = run["cuts"], run["paths"].values()
    seen = cuts["drawn_over_seen"]
    yield "2", "triangles drawn over those that 125 eyes see: median, most", f"{seen['median']:.2f}, {seen['largest']:.2f}", "<= 1.5, <= 2.5", seen["median"] <= 1.5 and seen["largest"] <= 2.5
    full, update = worst(run, "over_full", "median"), worst(run, "over_update", "median")
    none = cuts["drawn_over_no_occlusion"]["median"]
    if full is None:
        yield "4", "triangles a frame", "not compared", "", False
    else:
        yield "4", "triangles a frame over the full mesh in the frustum", f"1/{1 / full:.0f}", "<= 1/40", full <= 1 / 40
        yield "4", "triangles of a cell over those without occlusion", f"1/{1 / none:.1f}", "<= 1/4", none <= 1 / 4
        yield "4", "triangles a frame over `Refiner::update` to the same tolerance", f"{update:.2f}", "<= 1.6", update <= 1.6
    time, slowest = worst(run, "ms_over_update", "median"), over_paths(run, "frame_ms", "p99")
    if time is not None:
        yield "5", "frame without drawing over `Refiner::update`", f"1/{1 / time:.0f}", "<= 1/10", time <= 1 / 10
    yield "5", "frame without drawing, 99th percentile, ms", f"{slowest:.2f}", "<= 4", slowest <= 4
    median, largest = over_paths(run, "picture_ms", "median"), over_paths(run, "picture_ms", "largest")
    yield "6", "frames a second with drawing: median, least", f"{1e3 / median:.0f}, {1e3 / largest:.0f}", ">= 30, >= 15", median <= 1e3 / 30 and largest <= 1e3 / 15
    ratio = run["vlod_bytes"] / run["hierarchy_bytes"]
    yield "7", f"`.vlod` of {run['cells']} cells over `.olod`", f"{ratio:.5f}", "<= 0.1", ratio <= 0.1
    seconds = cuts["seconds"]
    yield "11", "seconds a cell and core: median, most", f"{seconds['median']:.2f}, {seconds['largest']:.2f}", "<= 0.5, <= 3", seconds["median"] <= 0.5 and seconds["largest"] <= 3
    late, control = sum(path["late"] for path in paths), sum(path["late_without_prefetch"] for path in paths)
    crossings = sum(path["crossings"] for path in paths)
    yield "13", f"late frames of {sum(path['frames'] for path in paths)} with {crossings} crossings; without prefetch", f"{late}; {control}", "0; > 0", late == 0 and control > 0
    if "teleports" in run:
        jumps = run["teleports"]
        slowest = jumps["complete_ms"]["largest"]
        yield "14", f"{jumps['complete_ms']['count']} teleports: frames with nothing; complete after, ms at most", f"{jumps['empty_frames']}; {slowest:.0f}", "0; <= 150", jumps["empty_frames"] == 0 and slowest <= 150
    if full is not None:
        unexplained = sum(path["compared"]["unexplained_px"] for path in paths if "compared" in path)
        yield "-", "pixels of these frames that the full mesh does not explain", f"{unexplained}", "0", unexplained == 0


def table(run):
    text = f"## {run['scene']}: {run['triangles']:,} triangles, {run['cells']} cells, {run['tolerance_px']:g} px\n\n"
    text += "| goal | what | measured | asked | |\n|---|---|---|---|---|\n"
    for goal, what, figure, asked, met in rows(run):
        text += f"| {goal} | {what} | {figure} | {asked} | {'met' if met else '**missed**'} |\n"
    hashes = ", ".join(f"{name} `{path['hash']}`" for name, path in sorted(run["paths"].items()))
    return text + f"\nHashes: cuts `{run['cuts']['hash']}`; walks {hashes}\n"


def main():
    if len(sys.argv) < 2:
        print("usage: viewcells_table.py FILE [FILE...]", file=sys.stderr)
        return 2
    print("\n".join(table(json.loads(pathlib.Path(file).read_text())) for file in sys.argv[1:]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
