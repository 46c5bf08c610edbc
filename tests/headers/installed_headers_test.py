"""installed_headers_test.py LIB INCLUDE: the installed headers are the public ones, and include nothing but each other,
GLM and the standard library; openmesh.h also OpenMesh."""
import pathlib
import re
import sys
import unittest

PUBLIC = pathlib.Path(sys.argv[1]) / "include"
INSTALLED = pathlib.Path(sys.argv[2])
OPTIONAL = ("occlod/gl.h", "occlod/openmesh.h")  # installed where they are built


def headers(folder):
    return {path.relative_to(folder).as_posix() for path in (folder / "occlod").glob("*.h")}


def includes(header):
    return re.findall(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', (INSTALLED / header).read_text(), re.MULTILINE)


class InstalledHeaders(unittest.TestCase):
    def test_are_the_public_ones(self):
        self.assertIn("occlod/occlod.h", headers(INSTALLED))
        self.assertEqual(headers(INSTALLED) - headers(PUBLIC), set())
        missing = headers(PUBLIC) - headers(INSTALLED)
        self.assertEqual([name for name in missing if not name.startswith(OPTIONAL)], [])

    def test_include_no_private_header(self):
        for header in sorted(headers(INSTALLED)):
            for kind, name in includes(header):
                if kind == '"':
                    with self.subTest(header=header, include=name):
                        self.assertIn(name, headers(INSTALLED))

    def test_need_glm_and_the_standard_library_only(self):
        for header in sorted(headers(INSTALLED)):
            for kind, name in includes(header):
                if kind == "<" and header != "occlod/openmesh.h":
                    with self.subTest(header=header, include=name):
                        self.assertRegex(name, r"^(glm/[a-z0-9_/]+\.hpp|[a-z_]+)$")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
