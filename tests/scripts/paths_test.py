"""Scripts name no folder outside the project: where meshes lie is for OCCLOD_MESHES to say."""
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
OUTSIDE = re.compile(r"(?<![\w.])\.\./shared\b")


class Paths(unittest.TestCase):
    def test_stay_inside(self):
        scripts = sorted(path for path in (ROOT / "scripts").iterdir() if path.is_file())
        self.assertTrue(scripts)
        self.assertEqual([path.name for path in scripts if OUTSIDE.search(path.read_text())], [])


if __name__ == "__main__":
    unittest.main()
