#!/usr/bin/env python3
"""sdist.py [--sources FOLDER] [--output FOLDER]: makes the sdist of the Python package, occlod-VERSION.tar.gz, in build/dist.

It carries what the build needs, so that it builds offline with no system package but a C++ compiler: of each release that
cmake/OcclodFetch.cmake declares the files named below, with its licence, in third_party/. The archives are downloaded and
checked by their hashes. --sources takes them, unpacked and unchecked, from FOLDER/NAME instead, for tests without a network.
Archives are kept in build/sdist. The Python that runs this needs scikit-build-core (pip install scikit-build-core)."""
import argparse
import fnmatch
import hashlib
import os
import pathlib
import re
import shutil
import sys
import tempfile
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parent.parent
WORK = ROOT / "build/sdist"
DECLARED = re.compile(r"FetchContent_Declare\((\w+)\s+URL (\S+)\s+URL_HASH SHA256=([0-9a-f]{64})")

# Patterns of paths, where * also stands for slashes. The first of each is its licence.
CARRIED = {
    "CLI11": ["LICENSE", "include/*.hpp"],
    "fmt": ["LICENSE*", "ChangeLog.*", "CMakeLists.txt", "README.*", "include/*.h", "src/format.cc", "src/os.cc", "support/cmake/*"],
    "glm": ["copying.txt", "glm/*.hpp", "glm/*.inl", "glm/simd/*.h"],
    "hwy": ["LICENSE*", "CMakeLists.txt", "cmake/*", "hwy/*.h", "hwy/*.cc"],
    "nlohmann_json": ["LICENSE.MIT", "include/*.hpp"],
    "stb": ["LICENSE", "stb_image.h", "stb_image_write.h"],
    "tinygltf": ["LICENSE", "tiny_gltf.h"],
    "xxhash": ["LICENSE", "xxhash.h"],
    "zstd": ["LICENSE", "build/cmake/*", "lib/*.h", "lib/*.c", "lib/*.S", "lib/libzstd.pc.in"],
}
LEFT_OUT = {
    "hwy": ["hwy/contrib/*", "hwy/examples/*", "*_test.cc"],
    "zstd": ["build/cmake/contrib/*", "build/cmake/programs/*", "build/cmake/tests/*", "build/cmake/README.md", "*/.gitignore",
             "lib/deprecated/*", "lib/legacy/*"],
}


def fail(message):
    sys.exit(f"sdist: {message}")


def releases():
    """Of each name its URL and the hash of its archive."""
    declared = {name: (url, digest) for name, url, digest in DECLARED.findall((ROOT / "cmake/OcclodFetch.cmake").read_text("utf-8"))}
    if set(declared) != set(CARRIED):
        fail(f"cmake/OcclodFetch.cmake declares {sorted(declared)}, this script carries {sorted(CARRIED)}: make them the same")
    return declared


def download(name, url, digest):
    """The folder of the unpacked archive, which is kept for the next call."""
    archive = WORK / "archives" / f"{digest[:16]}-{url.rsplit('/', 1)[-1]}"
    archive.parent.mkdir(parents=True, exist_ok=True)
    if not archive.exists():
        try:
            with urllib.request.urlopen(url, timeout=60) as answer:
                content = answer.read()
        except OSError as error:
            fail(f"{name}: {url}: {error}; give the unpacked sources with --sources")
        archive.write_bytes(content)
    if hashlib.sha256(archive.read_bytes()).hexdigest() != digest:
        archive.unlink()
        fail(f"{name}: {url} is not the file whose hash cmake/OcclodFetch.cmake has; check the release, then the hash")
    folder = WORK / "unpacked" / name
    shutil.rmtree(folder, ignore_errors=True)
    shutil.unpack_archive(archive, folder)
    (top,) = folder.iterdir()
    return top


def matches(path, patterns):
    return any(fnmatch.fnmatchcase(path, pattern) for pattern in patterns)


def carry(name, source, target):
    """Copies what the build needs of one release."""
    if not source.is_dir():
        fail(f"{name}: there is no folder {source}")
    paths = [path for path in sorted(source.rglob("*")) if path.is_file()]
    files = {path.relative_to(source).as_posix(): path for path in paths}
    for pattern in CARRIED[name]:
        if not fnmatch.filter(files, pattern):
            fail(f"{name}: {source} has no {pattern}")
    for relative, path in files.items():
        if matches(relative, CARRIED[name]) and not matches(relative, LEFT_OUT.get(name, [])):
            (target / relative).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, target / relative)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sources", type=pathlib.Path, help="a folder with the unpacked sources of each dependency, by its name")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "build/dist")
    arguments = parser.parse_args()
    try:
        from scikit_build_core.build import build_sdist
    except ImportError:
        fail(f"{sys.executable} has no scikit-build-core: in a virtual environment, pip install scikit-build-core")
    arguments.output.mkdir(parents=True, exist_ok=True)
    output = str(arguments.output.resolve())
    with tempfile.TemporaryDirectory() as third_party:
        for name, (url, digest) in releases().items():
            source = arguments.sources / name if arguments.sources else download(name, url, digest)
            carry(name, source, pathlib.Path(third_party, name))
        os.chdir(ROOT)
        build_sdist(output, {f"sdist.force-include.{third_party}": "third_party"})


if __name__ == "__main__":
    main()
