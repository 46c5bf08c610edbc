#!/usr/bin/env python3
"""The commands in the guides run. Each block of sh runs in bash as printed, the blocks of a page one after the other, in
a folder that holds a mesh and a scene of the names that the guides use. Indented blocks are shown only.

Environment: OCCLOD, the command line.
"""
import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = sorted([*(ROOT / "docs" / "guide").glob("*.md"), ROOT / "docs" / "which_method.md"])

CITY = {
    "objects": [{"mesh": "city.ply"}],
    "cameras": {"default": {"eye": [58, 56, 1.7], "target": [110, 60, 8], "up": [0, 0, 1], "near": 0.1, "far": 500}},
    "paths": {"walk": {"frames": 4, "keys": [
        {"eye": [58, 60, 1.7], "target": [110, 60, 8], "up": [0, 0, 1], "near": 0.1, "far": 500},
        {"eye": [62, 60, 1.7], "target": [110, 60, 8], "up": [0, 0, 1], "near": 0.1, "far": 500}]}},
    "cells": {"regions": [{"min": [56, 56, 1], "max": [64, 64, 2.5]}], "root_cell": 4, "smallest_cell": 4},
}

# Two triangles with one corner apart by a little, and one of them twice.
BROKEN = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0.00001 0\nv 1 1 0\nf 1 2 3\nf 1 2 3\nf 3 4 5\n"


def run(command, folder):
    tools = str(pathlib.Path(os.environ["OCCLOD"]).resolve().parent)
    environment = dict(os.environ, PATH=f"{tools}:{os.environ['PATH']}", XDG_CACHE_HOME=str(folder / "cache"))
    return subprocess.run(["bash", "-e", "-c", command], cwd=folder, env=environment, capture_output=True, text=True, check=False)


class GuideCommands(unittest.TestCase):
    def test_blocks_run(self):
        for page in PAGES:
            blocks = re.findall(r"^```sh\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)
            with tempfile.TemporaryDirectory() as name:
                folder = pathlib.Path(name)
                made = run("occlod generate rough-planet level=6 -o statue.ply; occlod generate city blocks=2 facade_cells=4 -o city.ply", folder)
                self.assertEqual(made.returncode, 0, made.stderr)
                (folder / "city.json").write_text(json.dumps(CITY))
                (folder / "broken.obj").write_text(BROKEN)
                for number, block in enumerate(blocks, 1):
                    with self.subTest(f"{page.name}, block {number}"):
                        result = run(block, folder)
                        self.assertEqual(result.returncode, 0, f"\n{block}\n{result.stdout}{result.stderr}")


if __name__ == "__main__":
    unittest.main()
