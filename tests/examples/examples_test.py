#!/usr/bin/env python3
"""examples_test.py PROGRAM WORK: runs a program of examples/ in the empty folder WORK: it ends well, says what its first lines
promise, writes the files that they name, and has one page. Exit status 77 where a machine lacks OpenGL."""
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import zlib

ROOT = pathlib.Path(__file__).resolve().parents[2]
MAX_LINES = 60
SAYS = {
    "hello": r"\d+ of 131072 triangles, [1-9]\d* of \d+ queries hidden\n",
    "frame_loop": r"frame 0: (\d+) triangles, \1 of them uploaded\n(frame \d0: \d+ triangles, \d{2,3} of them uploaded\n){5}",
    "textured_cut": r"6000 of 131072 triangles, no farther than 0\.\d+ from the input\n",
    "hlod_renderer": r"(frame \d+: \d+ triangles in \d+ draws, [1-9]\d* nodes hidden, \d+ uploaded\n){4}",
    "paging": r"790784 triangles built, with up to [1-9]\d* MiB in scratch files\n(frame \d+: \d+ triangles, \d+ of \d+ nodes in \d{2,4} KiB, \d+ missing\n){4}",
    "cells": r"(frame \d+: \d+ triangles for cell \d+, [\d.]+ px off at most\n){6,}",
    "tiles": r"\d+ tiles with \d+ triangles in \d+ KiB\n",
    "opengl": r".+, (egl|osmesa).*\n(frame \d+: \d+ triangles, [1-9]\d* queries, [1-9]\d* nodes hidden\n){4}",
}


def values_of(png):
    """How many values its rows have: few in an empty picture."""
    at, packed = 8, b""
    while at < len(png):
        (length,) = struct.unpack(">I", png[at:at + 4])
        if png[at + 4:at + 8] == b"IDAT":
            packed += png[at + 8:at + 8 + length]
        at += 12 + length
    return len(set(zlib.decompress(packed)))


def main():
    program, work = map(pathlib.Path, sys.argv[1:3])
    name = program.name.removeprefix("example_")
    source = (ROOT / "examples" / f"{name}.cpp").read_text(encoding="utf-8")
    assert source.count("\n") <= MAX_LINES, f"{name}.cpp has more than {MAX_LINES} lines"
    assert source.startswith("// ")

    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    done = subprocess.run([program], cwd=work, capture_output=True, text=True, check=False)
    if name == "opengl" and re.search("install EGL|install a driver", done.stderr):
        print(f"SKIPPED: {done.stderr.strip()}")
        sys.exit(77)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    assert re.fullmatch(SAYS[name], done.stdout), done.stdout
    head = source[:source.index("#include")]
    for file in re.findall(r"[a-z_]+\.(?:png|glb|ohlod|vlod)\b", head):
        assert (work / file).stat().st_size > 100, file
    for picture in work.glob("*.png"):
        assert values_of(picture.read_bytes()) > 16, f"{picture.name} is empty"
    if name == "tiles":
        assert (work / "tiles/tileset.json").exists()


if __name__ == "__main__":
    main()
