#!/usr/bin/env python3
"""simplify_peers.py --occlod FILE MESH...: reduces meshes to a tenth of their triangles by `occlod simplify` and by pyvista.decimate, positions only, and prints the two-way distances to
the input, measured by `occlod compare`, as one table. Needs the Python packages occlod and pyvista."""
import argparse
import json
import pathlib
import subprocess
import tempfile

import numpy
import occlod
import pyvista


def distances(tool, mesh, reduced):
    command = [tool, "compare", mesh, reduced, "--samples", "400000", "--json"]
    found = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return found["rms_percent"], found["max_percent"]


def by_occlod(tool, mesh, output):
    subprocess.run([tool, "simplify", mesh, "-o", output, "--ratio", "10%"], check=True, capture_output=True)


def by_pyvista(mesh, output):
    faces = numpy.column_stack((numpy.full(mesh.triangle_count, 3), mesh.triangles)).ravel()
    wanted = mesh.triangle_count // 10
    reduced = pyvista.PolyData(mesh.positions, faces).decimate(1 - wanted / mesh.triangle_count)
    occlod.Mesh(reduced.points, reduced.faces.reshape(-1, 4)[:, 1:]).write(output)


def main():
    parser = argparse.ArgumentParser(description="Reduced meshes beside those of another package, as one table")
    parser.add_argument("--occlod", required=True, type=pathlib.Path, help="built by scripts/build.sh bench")
    parser.add_argument("meshes", nargs="+", type=pathlib.Path)
    options = parser.parse_args()
    print("| mesh | triangles | RMS %: occlod | pyvista | ratio | max %: occlod | pyvista |\n|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        ours, theirs = pathlib.Path(folder, "ours.ply"), pathlib.Path(folder, "theirs.ply")
        for file in options.meshes:
            mesh = occlod.read_mesh(file)
            by_occlod(options.occlod, file, ours)
            by_pyvista(mesh, theirs)
            (rms, largest), (other_rms, other_largest) = distances(options.occlod, file, ours), distances(options.occlod, file, theirs)
            print(f"| {file.stem} | {mesh.triangle_count} | {rms:.4f} | {other_rms:.4f} | {rms / other_rms:.2f} | {largest:.3f} | {other_largest:.3f} |", flush=True)


if __name__ == "__main__":
    main()
