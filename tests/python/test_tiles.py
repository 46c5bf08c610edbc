"""write_tiles() writes what `occlod tiles` writes."""
import os
import pathlib
import subprocess
import tempfile
import unittest
import zipfile

import numpy as np

import occlod


def files_of(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


class Tiles(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def by_the_tool(self, name, *options):
        if "OCCLOD" not in os.environ:
            self.skipTest("SKIPPED: no command line to compare with")
        subprocess.run([os.environ["OCCLOD"], "tiles", self.folder / name, "-o", self.folder / "told", "--replace", *options], check=True, capture_output=True)
        return files_of(self.folder / "told")

    def test_the_same_bytes_as_the_command(self):
        mesh = occlod.generate("rough-planet", level=4)
        mesh.write(self.folder / "a.ply")
        (self.folder / "a.json").write_text('{"objects": [{"mesh": "a.ply"}, {"mesh": "a.ply", "position": [3, 0, 0]}],'
                                            ' "cameras": {"default": {"eye": [0, 0, 4], "target": [0, 0, 0]}}}')
        hlod = occlod.build_hlod(mesh, grouping=occlod.Grouping.nested, borders=occlod.Borders.free, error_bound=occlod.ErrorBound.measured)
        hlod.write(self.folder / "a.ohlod")
        plain = self.by_the_tool("a.ply")
        for number, what in enumerate((mesh, hlod, self.folder / "a.ply", str(self.folder / "a.ohlod"))):
            counts = occlod.write_tiles(what, self.folder / f"{number}")
            self.assertEqual(files_of(self.folder / f"{number}"), plain)
            self.assertEqual((counts.tiles, counts.bytes), (hlod.node_count, sum(map(len, plain.values()))))
        occlod.write_tiles(self.folder / "a.json", self.folder / "scene")
        self.assertEqual(files_of(self.folder / "scene"), self.by_the_tool("a.json"))
        occlod.write_tiles(mesh, self.folder / "scene", node_triangles=64, threads=1, quantise_bits=12, skirts=True, up=occlod.UpAxis.y,
                           origin=(11.5, 48.1, 520), replace=True)
        counts = occlod.write_tiles(mesh, self.folder / "a.3tz")
        with zipfile.ZipFile(self.folder / "a.3tz") as archive:
            self.assertEqual({name: archive.read(name) for name in archive.namelist()[:-1]}, plain)
        self.assertEqual(counts.bytes, (self.folder / "a.3tz").stat().st_size)
        options = "--node-triangles 64 --quantise 12 --skirts --up y --origin 11.5,48.1,520".split()
        self.assertEqual(files_of(self.folder / "scene"), self.by_the_tool("a.ply", *options))

    def test_images_of_tiles(self):
        x, y = np.meshgrid(np.arange(64), np.arange(64))
        occlod.write_png(self.folder / "paper.png", np.stack([4 * x, 4 * y, x * y % 251, 255 + 0 * x], axis=-1).astype(np.uint8))
        (self.folder / "a.mtl").write_text("newmtl paper\nmap_Kd paper.png\n")
        (self.folder / "a.obj").write_text("mtllib a.mtl\nusemtl paper\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n")
        for name in ("png", "jpeg"):
            counts = occlod.write_tiles(self.folder / "a.obj", self.folder / name, texture_format=name)
            self.assertEqual((counts.source_texels, counts.charts, counts.images_shared), (64 * 64, 1, []))
            self.assertEqual(files_of(self.folder / name), self.by_the_tool("a.obj", "--texture-format", name))
        with self.assertRaisesRegex(occlod.Error, "texture_format"):
            occlod.write_tiles(self.folder / "a.obj", self.folder / "bad", texture_format="gif")
        (self.folder / "a.obj").write_text((self.folder / "a.obj").read_text().replace("vt 1 1", "vt 9 9"))
        self.assertEqual([name for name, _ in occlod.write_tiles(self.folder / "a.obj", self.folder / "shared").images_shared], ["paper.png"])

    def test_progress_and_what_it_raises(self):
        mesh = occlod.generate("rough-planet", level=5)
        shares = []
        occlod.write_tiles(mesh, self.folder / "a", progress=shares.append)
        self.assertEqual((shares, shares[-1]), (sorted(shares), 1.0))

        def stop(share):
            if share > 0.9:
                raise KeyboardInterrupt

        with self.assertRaises(KeyboardInterrupt):
            occlod.write_tiles(mesh, self.folder / "b", progress=stop)
        self.assertFalse((self.folder / "b").exists())

    def test_refusals(self):
        mesh = occlod.generate("rough-planet", level=3)
        with self.assertRaisesRegex(occlod.Error, "nested"):
            occlod.write_tiles(occlod.build_hlod(mesh), self.folder / "a")
        occlod.write_tiles(mesh, self.folder / "a")
        with self.assertRaisesRegex(occlod.Error, "holds a tileset already"):
            occlod.write_tiles(self.folder / "none.ply", self.folder / "a")
        with self.assertRaisesRegex(occlod.Error, "none.ply"):
            occlod.write_tiles(self.folder / "none.ply", self.folder / "b")
        for bad in (7, 17):
            with self.assertRaisesRegex(occlod.Error, "quantise_bits"):
                occlod.write_tiles(mesh, self.folder / "b", quantise_bits=bad)
        with self.assertRaises(TypeError):
            occlod.write_tiles(3, self.folder / "b")


if __name__ == "__main__":
    unittest.main()
