#!/usr/bin/env python3
"""simplify_peers.py --occlod FILE [--cgal FILE] [--meshoptimizer LIBRARY] [--percents P...] [--rounds N] [--csv FILE] [MESH...]: reduces scans, textured
meshes and CAD parts by occlod and by other packages, and prints tables of their time, distance, texture and topology. scripts/bench.sh simplify
installs the packages and runs this. Packages that are missing, and meshes that are not in OCCLOD_MESHES, are left out by name.

Each measurement is a process of its own on one thread. In each round every tool has its turn, slow ones in the first only; times are the least of
all rounds, from arrays to arrays, without reading and writing files. Distances and texture slip are those of `occlod compare`; beside them stand those of
bench/peers/judge.py, which shares no code with it."""
import argparse
import csv
import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy
import occlod

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "bench"))
from peers.judge import Judge  # noqa: E402

MESHES = ["scans/armadillo_100k.obj", "scans/nefertiti.obj", "scans/horse.ply", "scans/dragon_vrip_res2.ply", "scans/turbineblade.ply",
          "textured/spot.obj", "textured/beast.obj", "scenes/sponza.obj", "scans/fandisk.obj", "scenes/gears.stl"]
PACKAGES = {"fast-simplification": "fast_simplification", "pyfqmr": "pyfqmr", "Open3D": "open3d", "PyVista decimate": "pyvista",
            "PyVista decimate_pro": "pyvista"}
POLICIES = {"CGAL Lindstrom-Turk": "lt", "CGAL Garland-Heckbert": "gh"}
TEXTURED_ONLY = ["meshoptimizer, permissive", "meshoptimizer, update, permissive", "PyVista decimate, texture"]
COLUMNS = ["mesh", "percent", "tool", "input_triangles", "target", "triangles", "cpu_ms", "wall_ms", "rms_pct", "max_pct", "open3d_rms_pct",
           "open3d_max_pct", "normals_deg", "turned_pct", "slip_pct", "slip_lost", "color_error_pct", "input_components", "components",
           "input_boundary_edges", "boundary_edges", "input_nonmanifold_edges", "nonmanifold_edges", "collapsed_triangles", "failure"]
TABLES = {"processor time, ms": ("cpu_ms", 0), "RMS distance, %": ("rms_pct", 4), "maximum distance, %": ("max_pct", 3),
          "normals, degrees RMS": ("normals_deg", 1), "texture slip, %": ("slip_pct", 4), "colour error, %": ("color_error_pct", 2)}
LIMIT_S = 300
SLOW_MS = 500


def find_mesh(name):
    folders = os.environ.get("OCCLOD_MESHES", "").split(":")
    found = [path for path in [pathlib.Path(name), *(pathlib.Path(folder, name) for folder in folders)] if path.is_file()]
    if not found:
        print(f"SKIPPED: {name} is in no folder of OCCLOD_MESHES", file=sys.stderr)
    return found[0] if found else None


def available_tools(options):
    tools = ["occlod", "occlod, no refit"]
    if options.meshoptimizer:
        tools += ["meshoptimizer", "meshoptimizer, permissive", "meshoptimizer, update", "meshoptimizer, update, permissive"]
    tools += [tool for tool, package in PACKAGES.items() if importlib.util.find_spec(package)]
    if "PyVista decimate" in tools:
        tools.append("PyVista decimate, texture")
    return tools + (list(POLICIES) if options.cgal else [])


def reduce(options, tool, mesh, triangles, output):
    """Leaves the result in output.npz or output.ply; returns times, or why there are none."""
    if tool in POLICIES:
        command = [options.cgal, mesh, f"{output}.ply", POLICIES[tool], str(triangles)]
    else:
        command = [sys.executable, ROOT / "bench/peers/simplifiers.py", tool, mesh, str(triangles), f"{output}.npz"]
        command += ["--meshoptimizer", options.meshoptimizer] if options.meshoptimizer else []
    try:
        done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=LIMIT_S)
    except subprocess.TimeoutExpired:
        return {"failure": f"more than {LIMIT_S} s"}
    except subprocess.CalledProcessError as error:
        last = (error.stderr.strip().splitlines() or ["no message"])[-1]
        return {"failure": f"exit status {error.returncode}: {last[:120]}"}
    return json.loads(done.stdout.splitlines()[-1])


def result_of(output):
    """Positions, triangles, and texture coordinates or None."""
    if pathlib.Path(f"{output}.npz").exists():
        arrays = numpy.load(f"{output}.npz")
        return arrays["positions"], arrays["triangles"], arrays.get("texture")
    mesh = occlod.read_mesh(f"{output}.ply")
    return mesh.positions, mesh.triangles, None


def compare(options, mesh, reduced, origin, folder):
    positions, triangles, texture = reduced
    file = pathlib.Path(folder, "reduced.ply")
    clean, _ = occlod.Mesh(positions, triangles, texture_coordinates=texture, texture_origin=origin).clean()
    clean.write(file)
    found = json.loads(subprocess.run([options.occlod, "compare", mesh, file, "--json"], check=True, capture_output=True, text=True).stdout)
    scores = {"rms_pct": found["rms_percent"], "max_pct": found["max_percent"]}
    if slip := found.get("texture_slip"):
        scores |= {"slip_pct": slip["rms_percent"], "slip_lost": slip["lost"]}
    return scores


def rows_of(options, tools, mesh, percent):
    whole = occlod.read_mesh(mesh)
    judge = Judge(whole.positions, whole.wedge_triangles, whole.texture_coordinates)
    target = int(whole.triangle_count * percent / 100)
    rows = {tool: {"mesh": mesh.name.split(".")[0], "percent": percent, "tool": tool, "input_triangles": whole.triangle_count, "target": target}
            for tool in tools if whole.texture_coordinates is not None or tool not in TEXTURED_ONLY}
    with tempfile.TemporaryDirectory() as folder:
        for turn in range(options.rounds):
            for i, (tool, row) in enumerate(rows.items()):
                output = pathlib.Path(folder, str(i))
                if "failure" in row or row.get("cpu_ms", 0) > SLOW_MS:
                    continue
                times = reduce(options, tool, mesh, target, output)
                row |= {name: min(value, row.get(name, value)) for name, value in times.items()}
        for i, row in enumerate(rows.values()):
            row |= {f"input_{name}": count for name, count in judge.topology.items() if name != "collapsed_triangles"}
            if "failure" not in row:
                reduced = result_of(pathlib.Path(folder, str(i)))
                row["triangles"] = len(reduced[1])
                row |= compare(options, mesh, reduced, whole.texture_origin, folder) | judge.measure(*reduced)
    return list(rows.values())


def table(rows, percent, title, column, digits):
    chosen = [row for row in rows if row["percent"] == percent and column in row]
    meshes, tools = (list(dict.fromkeys(row[key] for row in chosen)) for key in ("mesh", "tool"))
    cells = {(row["mesh"], row["tool"]): f"{row[column]:.{digits}f}" for row in chosen}
    print(f"\n{title}, {percent:g} %\n\n| | {' | '.join(meshes)} |\n|---|{'---|' * len(meshes)}")
    for tool in tools:
        print(f"| {tool} | {' | '.join(cells.get((mesh, tool), '') for mesh in meshes)} |")


def is_textured(mesh, rows):
    return any(row["mesh"] == mesh and "slip_pct" in row for row in rows)


def summary(rows, title, meshes):
    """Of each tool the geometric means, over meshes, of what it has over what occlod has."""
    values = {(row["percent"], row["mesh"], row["tool"]): row for row in rows if row["mesh"] in meshes}
    percents = list(dict.fromkeys(percent for percent, _, _ in values))
    print(f"\n{title}: over occlod, geometric means\n\n| | {' | '.join(f'{name}, {percent:g} %' for percent in percents for name in TABLES)} |")
    print("|---|" + "---|" * len(percents) * len(TABLES))
    for tool in dict.fromkeys(tool for _, _, tool in values):
        cells = []
        for percent in percents:
            for column, _ in TABLES.values():
                pairs = [(values.get((percent, mesh, tool), {}).get(column), values[percent, mesh, "occlod"].get(column)) for mesh in meshes]
                has_all = all(a is not None and b for a, b in pairs)
                cells.append(f"{numpy.exp(numpy.mean([numpy.log(a / b) for a, b in pairs])):.2f}" if has_all else "")
        print(f"| {tool} | {' | '.join(cells)} |")


def print_tables(rows):
    for percent in dict.fromkeys(row["percent"] for row in rows):
        for title, (column, digits) in TABLES.items():
            table(rows, percent, title, column, digits)
    meshes = list(dict.fromkeys(row["mesh"] for row in rows))
    for title, chosen in (("Without textures", [mesh for mesh in meshes if not is_textured(mesh, rows)]),
                          ("Textured", [mesh for mesh in meshes if is_textured(mesh, rows)])):
        if chosen:
            summary(rows, title, chosen)


def main():
    parser = argparse.ArgumentParser(description="Reduced meshes beside those of other packages")
    parser.add_argument("--occlod", required=True, help="the command line, with `compare`")
    parser.add_argument("--cgal", help="bench_simplify_cgal; without it CGAL is left out")
    parser.add_argument("--meshoptimizer", help="a shared library of its sources; without it meshoptimizer is left out")
    parser.add_argument("--percents", type=float, nargs="+", default=[10, 2], help="of the triangles that are to be left")
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--csv", type=pathlib.Path)
    parser.add_argument("meshes", nargs="*", default=MESHES)
    options = parser.parse_args()
    tools, rows = available_tools(options), []
    for mesh in filter(None, map(find_mesh, options.meshes)):
        for percent in options.percents:
            print(mesh.name, percent, file=sys.stderr, flush=True)
            rows += rows_of(options, tools, mesh, percent)
            if options.csv:
                with options.csv.open("w", newline="") as file:
                    writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
                    writer.writeheader()
                    for row in rows:
                        writer.writerow({name: f"{value:.5g}" if isinstance(value, float) else value for name, value in row.items()})
    print_tables(rows)


if __name__ == "__main__":
    main()
