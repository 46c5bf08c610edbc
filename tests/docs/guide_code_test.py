#!/usr/bin/env python3
"""The C++ in the guide compiles. Each block is the body of a function; what it may use without declaring it is in FUNCTION.

Environment: CXX, the compiler; CXXFLAGS, what it needs to find the library's dependencies.
"""
import os
import pathlib
import re
import shlex
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]

PREAMBLE = """#include <occlod/occlod.h>
#include <occlod/base.h>
#include <occlod/gl.h>
#include <occlod/build_hlod.h>
#include <occlod/clusters.h>
#include <occlod/node_store.h>
#include <occlod/scene.h>
#include <occlod/select.h>
#include <occlod/tiles.h>
#include <occlod/traverser.h>
#include <occlod/build_cells.h>
#include <occlod/cell_builder.h>
#include <occlod/cell_walker.h>
#include <occlod/build_cells.h>
#include <occlod/vlod_file.h>
#include <glm/gtc/matrix_transform.hpp>
#include <iostream>
#include <span>
template <class... Arguments> void upload(const Arguments&...) {}
"""
FUNCTION = """void block_%d(std::span<const occlod::RefineObject> objects, const occlod::Camera& camera, occlod::Refiner& refiner,
             occlod::Visibility* visibility, const occlod::hlod::Hlod& hlod, occlod::hlod::RenderDevice& device) {
  static_cast<void>(objects), static_cast<void>(camera), static_cast<void>(refiner), static_cast<void>(visibility);
  static_cast<void>(hlod), static_cast<void>(device);
  {
%s  }
}
"""


class GuideCode(unittest.TestCase):
    def test_blocks_compile(self):
        blocks = []
        for page in sorted((ROOT / "docs" / "guide").glob("*.md")):
            found = re.findall(r"^```cpp\n(.*?)^```", page.read_text(encoding="utf-8"), flags=re.M | re.S)
            blocks += [f"#line 1 \"{page.name}, block {number}\"\n{block}" for number, block in enumerate(found, 1)]
        self.assertGreaterEqual(len(blocks), 2)
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder, "blocks.cpp")
            source.write_text(PREAMBLE + "".join(FUNCTION % pair for pair in enumerate(blocks)), encoding="utf-8")
            compiler = [os.environ.get("CXX", "c++"), *shlex.split(os.environ.get("CXXFLAGS", ""))]
            result = subprocess.run([*compiler, "-std=c++20", "-fsyntax-only", f"-I{ROOT / 'lib' / 'include'}", str(source)],
                                    capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 0, result.stderr)


if __name__ == "__main__":
    unittest.main()
