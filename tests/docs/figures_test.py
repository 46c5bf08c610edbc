#!/usr/bin/env python3
"""The plots of docs/images show the same in every program: colours are attributes of what is painted, not CSS. They say what
they show, of which scenes, in which units, and are those that scripts/figures.py makes of the committed tables."""
import pathlib
import re
import sys
import tempfile
import unittest
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
import figures  # noqa: E402

SVG = "{http://www.w3.org/2000/svg}"
PAINTED = {SVG + name for name in ("path", "circle", "rect", "text")}
COLOR = re.compile("#[0-9a-f]{6}")


def unpainted(root):
    """What is drawn without a colour of its own, or in one that is no literal."""
    for element in root.iter():
        if element.tag not in PAINTED:
            continue
        paints = [element.get(name) for name in ("fill", "stroke") if element.get(name) not in (None, "none")]
        if element.get("fill") is None or not paints or not all(map(COLOR.fullmatch, paints)):
            yield xml.etree.ElementTree.tostring(element, "unicode")


def texts(root, kind):
    return [element.text for element in root.iter(SVG + "text") if element.get("class") == kind]


class Figures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="occlod-figures-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        sys.argv[1:] = [folder.name]
        figures.main()
        cls.made = {path.name: xml.etree.ElementTree.parse(path).getroot() for path in cls.folder.iterdir()}

    def test_are_those_of_the_documents(self):
        for name in self.made:
            self.assertEqual((self.folder / name).read_bytes(), (ROOT / "docs/images" / name).read_bytes(), f"{name}: run scripts/figures.py")

    def test_need_no_css(self):
        for path in (ROOT / "docs/images").glob("*.svg"):
            with self.subTest(path.name):
                root = xml.etree.ElementTree.parse(path).getroot()
                self.assertEqual(list(root.iter(SVG + "style")), [])
                self.assertEqual(list(unpainted(root)), [])

    def test_say_what_they_show(self):
        for name, scenes, units in (("report.svg", figures.SCENES, ("ms a frame", "px")), ("hlod_above.svg", ("Scene city",), ("frame", "ms"))):
            with self.subTest(name):
                root = self.made[name]
                self.assertEqual(len(texts(root, "title")), 1)
                for scene in scenes:
                    self.assertIn(scene, texts(root, "soft")[0])
                for label, unit in zip(texts(root, "axis"), units, strict=True):
                    self.assertIn(unit, label)

    def test_recommended_is_explained_beside_it(self):
        """By hand from the table: at most 10,000 triangles, within 1.1 of the error 0.661; the front below it begins with 38,847 triangles."""
        root = self.made["report.svg"]
        self.assertIn("recommended", texts(root, "marked"))
        ring = next(element for element in root.iter(SVG + "circle") if element.get("data-marked") == "occlod, frame to frame, 10,000")
        self.assertEqual(ring.get("class"), "mark")
        note = " ".join(texts(root, "note"))
        for words in ("at most 10,000", "within 10 %", "within 25 %", "draws 38,847 triangles or more"):
            self.assertIn(words, note)


if __name__ == "__main__":
    del sys.argv[1:]
    unittest.main()
