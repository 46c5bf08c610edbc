#!/usr/bin/env python3
"""readme_test.py PREFIX LIBDIR WORK: builds the smallest program of README.md against the package installed in PREFIX, in
both ways that the README says, word for word, and runs it on a mesh of its name. Writes into the folder WORK."""
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BUDGET = 10_000


def first_block(language):
    """The first block of code in that language."""
    found = re.search(rf"^```{language}\n(.*?)^```$", (ROOT / "README.md").read_text(), re.M | re.S)
    assert found, f"README.md shows no {language}"
    return found[1]


def write_statue(path, side=100):
    """A wavy square of 2 * side * side triangles, more than the budget."""
    corner = range(side + 1)
    vertices = [f"{2 * x / side - 1} {2 * y / side - 1} {0.1 * ((x * 7 + y * 13) % 5)}" for y in corner for x in corner]
    faces = []
    for y in range(side):
        for x in range(side):
            v = y * (side + 1) + x
            faces += [f"3 {v} {v + 1} {v + side + 1}", f"3 {v + 1} {v + side + 2} {v + side + 1}"]
    header = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}", "property float x", "property float y",
              "property float z", f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    path.write_text("\n".join(header + vertices + faces) + "\n")


def run(command, folder, environment):
    done = subprocess.run(command, cwd=folder, env=environment, shell=isinstance(command, str), text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    assert done.returncode == 0, f"{command} in {folder} failed:\n{done.stdout}"
    return done.stdout


def check_program(folder, program, environment):
    (folder / "refined.png").unlink(missing_ok=True)
    said = run([str(folder / program)], folder, environment)
    triangles = int(re.fullmatch(r"(\d+) triangles to draw\n", said)[1])
    # A split adds two triangles at most, so a budget that the mesh could exceed is missed by a few.
    assert BUDGET * 9 // 10 < triangles <= BUDGET, said
    assert (folder / "refined.png").read_bytes().startswith(b"\x89PNG"), "no picture"


def main():
    prefix, libdir, work = (pathlib.Path(argument) for argument in sys.argv[1:4])
    environment = dict(os.environ, CMAKE_PREFIX_PATH=str(prefix), PKG_CONFIG_PATH=str(libdir / "pkgconfig"),
                       LD_LIBRARY_PATH=f"{libdir}:{os.environ.get('LD_LIBRARY_PATH', '')}")
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    (work / "hello.cpp").write_text(first_block("cpp"))
    (work / "CMakeLists.txt").write_text(first_block("cmake"))
    write_statue(work / "statue.ply")

    by_cmake, without = first_block("sh").splitlines()
    run(by_cmake, work, environment)
    check_program(work, "build/hello", environment)
    if shutil.which("pkg-config") is None:
        print("pkg-config is not here: built by CMake only")
        return
    run(without, work, environment)
    check_program(work, "./hello", environment)


if __name__ == "__main__":
    main()
