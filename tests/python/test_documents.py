"""What README.md and the guide print runs as printed, and so do the examples, whose pictures are those of the guide."""
import base64
import contextlib
import importlib.util
import io
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

import numpy
import occlod
from packages import nbclient, nbformat

ROOT = pathlib.Path(__file__).resolve().parents[2]
_SPEC = importlib.util.spec_from_file_location("notebooks", ROOT / "scripts/notebooks.py")
notebooks = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(notebooks)


@contextlib.contextmanager
def working_folder():
    """An empty folder with a mesh and a scene of the names that the documents use."""
    before = pathlib.Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            yield pathlib.Path(folder)
        finally:
            os.chdir(before)


def read_png(data):
    """(height, width, 4) int of a PNG file of 8 bits, RGBA, as write_png() writes it."""
    width, height = struct.unpack(">II", data[16:24])
    at, packed = 8, b""
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        if data[at + 4 : at + 8] == b"IDAT":
            packed += data[at + 8 : at + 8 + length]
        at += 12 + length
    rows = numpy.frombuffer(zlib.decompress(packed), numpy.uint8).reshape(height, 1 + 4 * width)
    pixels = numpy.zeros((height + 1, width + 1, 4), int)  # with an empty row above and an empty column to the left
    for y, row in enumerate(rows, 1):
        values = row[1:].astype(int).reshape(width, 4)
        for x, value in enumerate(values, 1):
            left, up, corner = pixels[y, x - 1], pixels[y - 1, x], pixels[y - 1, x - 1]
            if row[0] == 4:
                guess = left + up - corner
                away = abs(guess - left), abs(guess - up), abs(guess - corner)
                value = value + numpy.where((away[0] <= away[1]) & (away[0] <= away[2]), left, numpy.where(away[1] <= away[2], up, corner))
            else:
                value = value + (0, left, up, (left + up) // 2)[row[0]]
            pixels[y, x] = value % 256
    return pixels[1:, 1:]


class Documents(unittest.TestCase):
    def run_blocks(self, page):
        blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(encoding="utf-8"), re.M | re.S)
        self.assertTrue(blocks)
        names = {}
        said = io.StringIO()
        with working_folder() as folder, contextlib.redirect_stdout(said):
            occlod.generate("rough-planet", level=6).write(folder / "statue.ply")
            scene = occlod.Scene([occlod.SceneObject(occlod.MeshFile(["statue.ply"]))], {"default": occlod.Camera()},
                                 {"walk": occlod.CameraPath([occlod.Camera(), occlod.Camera(eye=(0, 1, 3))], 5)})
            scene.write(folder / "city.json")
            for number, block in enumerate(blocks, 1):
                exec(compile(block, f"{page}, block {number}", "exec"), names)  # pylint: disable=exec-used
            return sorted(path.name for path in folder.iterdir()), said.getvalue()

    def test_readme(self):
        files, said = self.run_blocks("README.md")
        self.assertEqual(files, ["city.json", "refined.ply", "refined.png", "statue.ply"])

    def test_guide(self):
        files, _ = self.run_blocks("docs/guide/python.md")
        self.assertIn("statue.olod", files)

    def test_guide_names_what_there_is(self):
        text = (ROOT / "docs/guide/python.md").read_text(encoding="utf-8")
        for name in occlod.__all__:
            with self.subTest(name):
                self.assertRegex(text, rf"\b{name}\b")


def run_notebook(example, folder):
    """Runs the example as a notebook in the folder. The data of all that its cells show."""
    notebook = nbformat.from_dict(notebooks.notebook_of(example.read_text(encoding="utf-8")))
    nbformat.validate(notebook)
    nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(folder)}}).execute()
    return [output["data"] for cell in notebook.cells for output in cell.get("outputs", ()) if "data" in output]


class Examples(unittest.TestCase):
    """With nbclient they run as notebooks, and one of them as a script; else all as scripts."""

    def test_make_the_pictures_of_the_guide(self):
        examples = sorted((ROOT / "python/examples").glob("*.py"))
        self.assertGreaterEqual(len(examples), 3)
        for example in examples:
            with self.subTest(example.name), tempfile.TemporaryDirectory() as folder:
                if example.stem == "opengl":
                    self.require_opengl()
                picture = pathlib.Path(folder, f"{example.stem}.png")
                if nbclient is None or example.stem == "simplify":
                    subprocess.run([sys.executable, str(example)], cwd=folder, check=True, stdout=subprocess.PIPE)
                else:
                    shown = run_notebook(example, folder)
                    self.assertEqual(base64.b64decode(shown[-1]["image/png"]), picture.read_bytes(), "the last cell shows it")
                made = picture.read_bytes()
                shown = ROOT / f"docs/images/python_{example.stem}.png"
                if os.environ.get("OCCLOD_UPDATE_GOLDEN") == "1":
                    shown.write_bytes(made)
                if made == shown.read_bytes():
                    continue
                # Refinement may have changed since: other triangles, but the same thing to see.
                pair = read_png(made), read_png(shown.read_bytes())
                self.assertEqual(pair[0].shape, pair[1].shape)
                different = (abs(pair[0] - pair[1]).max(axis=2) > 32).mean()
                self.assertLess(different, 0.1, f"look at it; OCCLOD_UPDATE_GOLDEN=1 writes {shown.name} anew")

    def test_begin_with_what_they_are(self):
        for example in (ROOT / "python/examples").glob("*.py"):
            cells = notebooks.notebook_of(example.read_text(encoding="utf-8"))["cells"]
            self.assertEqual(cells[0]["cell_type"], "markdown", example.name)
            self.assertRegex(cells[0]["source"], "^# [A-Z]", example.name)
            self.assertEqual(cells[-1]["source"].splitlines()[-1], "occlod.show(image)", example.name)

    def require_opengl(self):
        try:
            occlod.Device.gl()
        except occlod.Error as error:
            self.skipTest(str(error))


class Docstrings(unittest.TestCase):
    def test_everything_has_one(self):
        without = []
        for name in occlod.__all__:
            thing = getattr(occlod, name)
            if isinstance(thing, int):
                continue
            if not (getattr(thing, "__doc__", None) or "").strip():
                without.append(name)
        self.assertEqual(without, [])
        self.assertEqual(occlod.NO_ID, numpy.iinfo(numpy.uint32).max)


if __name__ == "__main__":
    unittest.main()
