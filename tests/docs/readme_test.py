#!/usr/bin/env python3
"""The README's program, written out and built as a new user does: by its CMake lines and by its pkg-config line, against
the installed package; and the C++ in the guide, which has to compile.

Environment: PREFIX, where occlod is installed; CXX and CXXFLAGS, what it was built with.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PREFIX = pathlib.Path(os.environ.get("PREFIX", "/usr/local"))
BUDGET = 10_000

# What the fragments of the guide may name.
PREAMBLE = """#include <occlod/occlod.h>
#include <occlod/effects/auto_refiner.h>
template <class... Arguments> void upload(const Arguments&...) {}
"""
FRAGMENT = """void fragment_%d(std::span<const occlod::RefineObject> objects, const occlod::Camera& camera, occlod::Refiner& refiner,
                 occlod::Visibility* visibility) {
  {
%s  }
  static_cast<void>(objects), static_cast<void>(camera), static_cast<void>(refiner), static_cast<void>(visibility);
}
"""


def blocks(path, language):
    return re.findall(rf"^```{language}\n(.*?)^```", path.read_text(encoding="utf-8"), flags=re.M | re.S)


def write_sphere(path, level):
    """A sphere of radius 1 with 20 * 4^level triangles, from an icosahedron."""
    golden = (1 + 5 ** 0.5) / 2
    vertices = [(a, b * golden, 0) for a in (-1, 1) for b in (-1, 1)]
    vertices = vertices + [(0, x, y) for x, y, _ in vertices] + [(y, 0, x) for x, y, _ in vertices]
    near = [[j for j, q in enumerate(vertices) if j != i and abs(sum((a - b) ** 2 for a, b in zip(p, q)) - 4) < 1e-9]
            for i, p in enumerate(vertices)]
    faces = [(i, j, k) for i in range(12) for j in near[i] for k in near[i] if i < j and i < k and k in near[j]]
    faces = [face for face in faces if is_outward([vertices[corner] for corner in face])]
    for _ in range(level):
        middles = {}

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(vertices)
                vertices.append(tuple(p + q for p, q in zip(vertices[a], vertices[b])))
            return middles[key]

        halves = [(a, b, c, middle(a, b), middle(b, c), middle(c, a)) for a, b, c in faces]
        faces = [face for a, b, c, ab, bc, ca in halves for face in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))]
        for i, p in enumerate(vertices):
            length = sum(x * x for x in p) ** 0.5
            vertices[i] = tuple(x / length for x in p)
    with open(path, "w", encoding="ascii") as file:
        file.write(f"ply\nformat ascii 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
                   f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
        file.writelines(f"{x} {y} {z}\n" for x, y, z in vertices)
        file.writelines(f"3 {a} {b} {c}\n" for a, b, c in faces)
    return len(faces)


def is_outward(corners):
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = corners
    return ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx) > 0


class Readme(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)
        (self.folder / "hello.cpp").write_text(blocks(ROOT / "README.md", "cpp")[0], encoding="utf-8")
        # A third of the sphere can be seen from three radii away: 27,000 of these triangles, more than the budget.
        self.assertEqual(write_sphere(self.folder / "statue.ply", 6), 20 * 4 ** 6)

    def run_in_folder(self, command, **more):
        environment = os.environ | {name: str(value) for name, value in more.items()}
        result = subprocess.run(command, cwd=self.folder, env=environment, capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 0, f"{command}\n{result.stdout}{result.stderr}")
        return result.stdout

    def expect_that_the_program_uses_the_budget(self, output):
        triangles = int(re.fullmatch(r"(\d+) triangles to draw\n", output).group(1))
        self.assertLessEqual(triangles, BUDGET)
        # It ends when no split fits any more. On a closed surface a split adds two triangles, and few force more than ten others.
        self.assertGreater(triangles, BUDGET - 20)

    def test_program_by_cmake(self):
        lines = blocks(ROOT / "README.md", "cmake")[0]
        (self.folder / "CMakeLists.txt").write_text(lines, encoding="utf-8")
        self.run_in_folder(["cmake", "-S", ".", "-B", "build", "-DCMAKE_BUILD_TYPE=Release", f"-DCMAKE_PREFIX_PATH={PREFIX}"])
        self.run_in_folder(["cmake", "--build", "build"])
        self.expect_that_the_program_uses_the_budget(self.run_in_folder(["build/hello"]))

    @unittest.skipUnless(shutil.which("pkg-config"), "pkg-config is not installed")
    def test_program_by_pkg_config(self):
        line = blocks(ROOT / "README.md", "sh")[0]
        self.assertTrue(line.startswith("c++ "))
        compiler = f"{os.environ.get('CXX', 'c++')} {os.environ.get('CXXFLAGS', '')} "
        libraries = next(PREFIX.glob("lib*/**/pkgconfig/occlod.pc")).parents[1]
        self.run_in_folder(["sh", "-c", compiler + line.removeprefix("c++ ")], PKG_CONFIG_PATH=libraries / "pkgconfig")
        self.expect_that_the_program_uses_the_budget(self.run_in_folder(["./hello"], LD_LIBRARY_PATH=libraries))

    def test_fragments_of_the_guide_compile(self):
        fragments = [block for page in sorted((ROOT / "docs" / "guide").glob("*.md")) for block in blocks(page, "cpp")]
        self.assertGreaterEqual(len(fragments), 2)
        source = PREAMBLE + "".join(FRAGMENT % pair for pair in enumerate(fragments))
        (self.folder / "fragments.cpp").write_text(source, encoding="utf-8")
        (self.folder / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.25)\nproject(fragments LANGUAGES CXX)\nfind_package(occlod 0.1 CONFIG REQUIRED)\n"
            "add_library(fragments OBJECT fragments.cpp)\ntarget_link_libraries(fragments PRIVATE occlod::occlod)\n", encoding="utf-8")
        self.run_in_folder(["cmake", "-S", ".", "-B", "build", f"-DCMAKE_PREFIX_PATH={PREFIX}"])
        self.run_in_folder(["cmake", "--build", "build"])


if __name__ == "__main__":
    sys.exit(unittest.main())
