#!/usr/bin/env python3
"""sdist_test.py WORK: scripts/sdist.py, run by the environment that make_environment.py made in WORK, without a network.
The dependencies that it carries are made here: files of the right names, which CMake can configure and no compiler reads."""
import os
import pathlib
import subprocess
import sys
import tarfile
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
sys.dont_write_bytecode = True
import sdist

PYTHON = pathlib.Path(sys.argv.pop(1), "builder/bin/python")
NO_NETWORK = {"http_proxy": "http://127.0.0.1:9", "https_proxy": "http://127.0.0.1:9"}
PROJECTS = {
    "fmt/CMakeLists.txt": "add_library(fmt INTERFACE)\nadd_library(fmt::fmt ALIAS fmt)\n",
    "hwy/CMakeLists.txt": "add_library(hwy INTERFACE)\n",
    "zstd/build/cmake/CMakeLists.txt":
        'file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/zstd.cpp "")\nadd_library(libzstd_static STATIC ${CMAKE_CURRENT_BINARY_DIR}/zstd.cpp)\n',
}


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def make_sources(folder):
    for name, patterns in sdist.CARRIED.items():
        for pattern in patterns:
            write(folder / name / pattern.replace("*", "any"), "")
        write(folder / name / "tests/large.cpp", "")
    for path, text in PROJECTS.items():
        write(folder / path, "cmake_minimum_required(VERSION 3.5)\nproject(carried CXX)\n" + text)


def run(*command):
    return subprocess.run([str(part) for part in command], env={**os.environ, **NO_NETWORK}, text=True, check=False,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


class Sdist(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = pathlib.Path(folder.name)
        make_sources(self.work / "sources")

    def make(self):
        return run(PYTHON, "-B", ROOT / "scripts/sdist.py", "--sources", self.work / "sources", "--output", self.work)

    def unpack(self):
        done = self.make()
        self.assertEqual(done.returncode, 0, done.stdout)
        (archive,) = self.work.glob("occlod-*.tar.gz")
        with tarfile.open(archive) as opened:
            opened.extractall(self.work / "unpacked")
        (top,) = (self.work / "unpacked").iterdir()
        return top

    def test_holds_what_the_build_needs_and_no_more(self):
        top = self.unpack()
        self.assertEqual({path.name for path in top.iterdir()},
                         {"CMakeLists.txt", "LICENSE", "PKG-INFO", "cmake", "docs", "lib", "pyproject.toml", "python", "scripts",
                          "third_party", "tools"})
        self.assertEqual([path.name for path in (top / "scripts").iterdir()], ["source_groups.py"])
        self.assertEqual({path.name for path in (top / "third_party").iterdir()}, set(sdist.CARRIED))
        for name, patterns in sdist.CARRIED.items():
            self.assertTrue(list((top / "third_party" / name).glob(patterns[0])), f"{name} has no licence")
            self.assertFalse((top / "third_party" / name / "tests").exists(), name)

    def test_configures_without_a_network_from_what_it_carries(self):
        top, build = self.unpack(), self.work / "build"
        nanobind = run(PYTHON, "-m", "nanobind", "--cmake_dir").stdout.strip()
        done = run("cmake", "-S", top / "python", "-B", build, "-DOCCLOD_FETCH_DEPENDENCIES=ON", "-DOCCLOD_PYTHON_COMMAND=ON",
                   f"-DPython_EXECUTABLE={PYTHON}", f"-Dnanobind_DIR={nanobind}")
        self.assertEqual(done.returncode, 0, done.stdout)
        cache = (build / "CMakeCache.txt").read_text().splitlines()
        for name in sdist.CARRIED:
            self.assertTrue(f"FETCHCONTENT_SOURCE_DIR_{name.upper()}:PATH={top}/third_party/{name}" in cache, name)
            of_the_system = [line for line in cache if line.startswith((f"{name}_DIR:PATH=/", f"OCCLOD_{name.upper()}_HEADERS:PATH=/"))]
            self.assertEqual(of_the_system, [])
        self.assertEqual(list((build / "_deps").glob("*-subbuild")), [])

    def test_names_what_is_missing(self):
        (self.work / "sources/tinygltf/tiny_gltf.h").unlink()
        done = self.make()
        self.assertEqual((done.returncode, done.stdout),
                         (1, f"sdist: tinygltf: {self.work}/sources/tinygltf has no tiny_gltf.h\n"))


if __name__ == "__main__":
    if not PYTHON.exists():
        print("SKIPPED: the Python package could not be built: see the test python.wheel")
        sys.exit(77)
    unittest.main(verbosity=2)
