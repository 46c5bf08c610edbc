#!/usr/bin/env python3
"""demo_table.py FOLDER: one aligned table of the reports that scripts/demo.sh leaves there.

The paper starts from culling `subtree` without occlusion; improvements are in percent more visible triangles."""
import json
import pathlib
import sys

SCENES = ["armadillo", "armadillo_group", "planet_full", "planet_near"]
CULLINGS = ["subtree", "star"]
BACKENDS = ["none", "software", "gl-query"]
HEADER = ["scene", "culling", "backend", "triangles", "visible", "share %", "over none %", "over paper's start %", "queries",
          "refine ms", "occlusion ms", "draw ms", "quadric error px", "error bound px", "depth RMS px"]


def read_report(folder, scene, culling, backend):
    path = folder / f"{scene}_{culling}_{backend}.json"
    return json.loads(path.read_text()) if path.exists() else None


def gain(report, start):
    if not start or not start["visible_triangles"]:
        return "-"
    return f"{100 * (report['visible_triangles'] / start['visible_triangles'] - 1):+.1f}"


def row(folder, scene, culling, backend):
    report = read_report(folder, scene, culling, backend)
    if report is None:
        return [scene, culling, backend, "failed"] + ["-"] * (len(HEADER) - 4)
    # The first is about the RMS distance; the second is a guaranteed bound, often many times the true error.
    errors = ["unlimited" if report[key] is None else f"{report[key]:.2f}" for key in ("max_quadric_error_px", "max_error_px")]
    return [scene, culling, backend, str(report["triangles"]), str(report["visible_triangles"]), f"{100 * report['visible_share']:.1f}",
            gain(report, read_report(folder, scene, culling, "none")), gain(report, read_report(folder, scene, "subtree", "none")),
            str(report["queries"]), f"{report['refine_ms']:.1f}", f"{report['occlusion_ms']:.1f}", f"{report['draw_ms']:.1f}",
            *errors, f"{report['depth_rms_px']:.2f}"]


def print_table(rows):
    widths = [max(map(len, column)) for column in zip(*rows)]
    for cells in rows:
        print("  ".join(cell.ljust(width) if i < 3 else cell.rjust(width) for i, (cell, width) in enumerate(zip(cells, widths))).rstrip())


def main():
    folder = pathlib.Path(sys.argv[1])
    print_table([HEADER] + [row(folder, scene, culling, backend) for scene in SCENES for culling in CULLINGS for backend in BACKENDS])


if __name__ == "__main__":
    main()
