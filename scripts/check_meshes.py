#!/usr/bin/env python3
"""check_meshes.py [--repair | --hlod] [OCCLOD]: builds and validates every mesh below the folders that OCCLOD_MESHES names, separated by ':'. One line each:
built and valid, or refused with the reason. Exit 1 when any crashes, hangs, is refused without a single line that says why, or is not valid.
--repair: repairs each first, and builds and validates what comes out. --hlod: builds an .ohlod file of each, for each kind of groups and borders
and with splits within nodes, with nodes of the usual size and small ones. OCCLOD defaults to build/release/tools/occlod."""
import argparse
import json
import os
import pathlib
import resource
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
EXTENSIONS = {".ply", ".obj", ".off", ".stl", ".gltf", ".glb"}
LIMIT_S = 600  # a command


class Failure(Exception):
    """What a command did that it must not do."""


class Refused(Exception):
    """The line that says why."""


def run(*command):
    """The JSON object that a command prints. Raises Refused when it ends with exit code 1 and one line on standard error."""
    name = command[1]
    try:
        done = subprocess.run([*map(str, command), "--json"], capture_output=True, timeout=LIMIT_S)
    except subprocess.TimeoutExpired:
        raise Failure(f"{name} took more than {LIMIT_S} s") from None
    errors = done.stderr.decode(errors="replace")
    if done.returncode < 0:
        raise Failure(f"{name} was ended by {signal.Signals(-done.returncode).name}")
    if done.returncode == 1 and errors.count("\n") == 1 and errors.endswith("\n"):
        raise Refused(errors.strip().removeprefix("occlod: error: "))
    if done.returncode != 0 or errors:
        raise Failure(f"{name} ended with {done.returncode} and {errors.count(chr(10))} lines: {errors.strip()[:200]!r}")
    return json.loads(done.stdout)


def check(occlod, mesh, hierarchy):
    """What is to be told about one mesh that was built and is valid."""
    built = run(occlod, "build", mesh, "-o", hierarchy)
    try:
        run(occlod, "validate", hierarchy, "--input", mesh)
    except Refused as refusal:
        raise Failure(f"validate: {refusal}") from None
    return f"{built['triangles']:>9} triangles {built['build_ms']:>8.0f} ms {built['peak_bytes'] / 1e6:>6.0f} MB"


HLOD_KINDS = tuple(("--grouping", grouping, "--borders", borders, "--within", within) for grouping, borders in
                   (("shifted", "locked"), ("nested", "locked"), ("nested", "free")) for within in ("geomorph", "splits"))
SMALL_NODES = 64
HLOD_FRONTS = 500


def check_hlod(occlod, mesh, hierarchy):
    """The same about its nodes."""
    file, milliseconds, nodes = hierarchy.with_suffix(".ohlod"), 0.0, []
    for kind in HLOD_KINDS:
        for size in ((), ("--node-triangles", SMALL_NODES)):
            built = run(occlod, "hlod", "build", mesh, "-o", file, *kind, *size)
            milliseconds += built["build_ms"]
            nodes.append(built["nodes"])
            try:
                run(occlod, "hlod", "validate", file, "--input", mesh, "--fronts", HLOD_FRONTS)
            except Refused as refusal:
                raise Failure(f"hlod validate, {' '.join(map(str, kind + size))}: {refusal}") from None
    return f"{built['triangles']:>9} triangles {milliseconds:>8.0f} ms, nodes {' '.join(map(str, nodes))}"


def check_repaired(occlod, mesh, hierarchy):
    """The same about what `repair` makes of it."""
    repaired = hierarchy.with_suffix(".ply")
    begin = time.monotonic()
    told = run(occlod, "repair", mesh, "-o", repaired)
    seconds = time.monotonic() - begin
    try:
        run(occlod, "build", repaired, "-o", hierarchy)
        run(occlod, "validate", hierarchy, "--input", repaired)
    except Refused as refusal:
        raise Failure(f"after repair: {refusal}") from None
    after = told["after"]
    for fault in ("nonmanifold_edges", "nonmanifold_vertices", "inconsistent_edges", "repeated_triangles"):
        if after[fault]:
            raise Failure(f"repair left {after[fault]} {fault}")
    changed = ", ".join(f"{key} {count}" for key, count in told["changes"].items() if count)
    return f"{after['triangles']:>9} triangles {1e3 * seconds:>8.0f} ms {changed}"


def meshes():
    """Every mesh with the name to show for it."""
    for folder in filter(None, os.environ.get("OCCLOD_MESHES", "").split(":")):
        for path in sorted(pathlib.Path(folder).rglob("*")):
            if path.suffix.lower() in EXTENSIONS and path.is_file():
                yield path, path.relative_to(folder)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("occlod", nargs="?", type=pathlib.Path, default=ROOT / "build/release/tools/occlod", help="the command to run")
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument("--repair", dest="check", action="store_const", const=check_repaired, help="repair each mesh first")
    kind.add_argument("--hlod", dest="check", action="store_const", const=check_hlod, help="build .ohlod files")
    arguments = parser.parse_args()
    occlod, check_one = arguments.occlod, arguments.check or check
    if not occlod.is_file():
        parser.error(f"{occlod} is not there; build it with scripts/build.sh")
    counts = {"valid": 0, "refused": 0, "FAILED": 0}
    with tempfile.TemporaryDirectory(prefix="occlod-check-") as folder:
        for path, name in meshes():
            try:
                verdict, told = "valid", check_one(occlod, path, pathlib.Path(folder) / "mesh.olod")
            except Refused as refusal:
                verdict, told = "refused", str(refusal).replace(str(path), path.name)
            except Failure as failure:
                verdict, told = "FAILED", str(failure)
            counts[verdict] += 1
            print(f"{verdict:<8} {str(name):<52} {told}", flush=True)
    if not sum(counts.values()):
        sys.exit("check_meshes: no meshes; OCCLOD_MESHES names the folders, separated by ':'")
    print(", ".join(f"{count} {verdict}" for verdict, count in counts.items()))
    print(f"most memory that a command held: {resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024:.0f} MB")
    sys.exit(1 if counts["FAILED"] else 0)


if __name__ == "__main__":
    main()
