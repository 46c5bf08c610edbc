"""`occlod tiles ... -o NAME.3tz`: the files of the folder, byte for byte, in a ZIP file with an index, by archive_check.py."""
import signal
import struct
import subprocess
import unittest
import zipfile
import zlib

import tileset_check
from archive_check import INDEX, Archive
from interrupt_test import OLD, Interrupting
from json_place import Wrong
from tool_case import OCCLOD, ToolTest

NESTED = ("--node-triangles", 64, "--grouping", "nested", "--borders", "free")


def picture(size=64):
    """A PNG file."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + bytes(x * y % 251 for x in range(size)) for y in range(size))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, 8, 0, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


class Archives(Interrupting):
    def setUp(self):
        super().setUp()
        self.make_planet()

    def files_of(self, folder):
        return {path.relative_to(self.folder / folder).as_posix(): path.read_bytes() for path in (self.folder / folder).rglob("*") if path.is_file()}

    def assert_holds(self, name, folder):
        """By Python's reader of ZIP files, and by the index."""
        files = self.files_of(folder)
        with zipfile.ZipFile(self.folder / name) as archive:
            self.assertEqual({entry: archive.read(entry) for entry in archive.namelist() if entry != INDEX}, files)
        archive = Archive(self.folder / name)
        self.assertEqual({entry: archive.read(entry) for entry in files}, files)
        for missing in ("", "tiles", "/tileset.json", "tiles/0/99999.glb", INDEX):
            self.assertIsNone(archive.find(missing), missing)

    def test_the_files_of_the_folder(self):
        for options in ([], ["--tiles-per-file", 20, "--skirts", "--origin", "11.5,48.1,520"], ["--quantise", 14, "--memory", "64M"]):
            command = ["tiles", "planet.ply", "--node-triangles", 64, *options, "--replace"]
            in_folder, told = self.json_of(*command, "-o", "a"), self.json_of(*command, "-o", "a.3tz")
            self.assert_holds("a.3tz", "a")
            self.assertEqual((told["archive"], told["bytes"]), ("a.3tz", (self.folder / "a.3tz").stat().st_size))
            self.assertNotIn("folder", told)
            for key in ("tiles", "tileset_files", "triangles", "content_bytes"):
                self.assertEqual(told[key], in_folder[key], key)
            self.assertEqual(tileset_check.check(self.folder / "a.3tz"), tileset_check.check(self.folder / "a"))
        self.assertEqual(self.names(), ["a", "a.3tz", "planet.ply"])

    def test_textures(self):
        """Of the tiles, and one that they share."""
        for number, corner in enumerate((1, 9)):
            (self.folder / "quad.obj").write_text(f"mtllib quad.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt {corner} {corner}\nvt 0 1\n"
                                                  "usemtl a\nf 1/1 2/2 3/3 4/4\n")
            (self.folder / "quad.mtl").write_text("newmtl a\nmap_Kd paper.png\n")
            (self.folder / "paper.png").write_bytes(picture())
            for name in ("a", "a.3tz"):
                told = self.json_of("tiles", "quad.obj", "-o", name, "--replace")
            self.assertEqual(len(told["images_shared"]), number)
            self.assertEqual((self.folder / "a/textures/0.png").exists(), number == 1)
            self.assert_holds("a.3tz", "a")

    def test_the_same_bytes_again(self):
        """Whenever it is written, by however many threads, under whatever name."""
        for threads, name in ((1, "a.3tz"), (2, "b.3TZ"), (5, "c.3tz")):
            self.succeed("tiles", "planet.ply", "-o", name, "--threads", threads)
            self.assertTrue(self.same_bytes("a.3tz", name))
        with zipfile.ZipFile(self.folder / "a.3tz") as archive:
            self.assertEqual({entry.date_time for entry in archive.infolist()}, {(1980, 1, 1, 0, 0, 0)})

    def test_what_is_there(self):
        (self.folder / "a.3tz").write_bytes(OLD)
        self.assertIn("a.3tz: is there already; choose a new name, or replace it with --replace", self.failure_of("tiles", "none.ply", "-o", "a.3tz"))
        self.assertIn("none.ply", self.failure_of("tiles", "none.ply", "-o", "a.3tz", "--replace"))
        self.assertEqual((self.folder / "a.3tz").read_bytes(), OLD)
        (self.folder / "link.3tz").symlink_to("a.3tz")
        self.succeed("tiles", "planet.ply", "-o", "link.3tz", "--replace")
        self.assertTrue((self.folder / "link.3tz").is_symlink())
        Archive(self.folder / "a.3tz")
        (self.folder / "folder.3tz").mkdir()
        self.assertIn("folder.3tz: is a folder", self.failure_of("tiles", "planet.ply", "-o", "folder.3tz", "--replace"))
        self.assertIn("does not exist", self.failure_of("tiles", "planet.ply", "-o", "missing/a.3tz"))
        (self.folder / "input.3tz").symlink_to("planet.ply")
        before = (self.folder / "planet.ply").read_bytes()
        done = self.run_tool("tiles", "planet.ply", "-o", "input.3tz", "--replace")
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
        self.assertIn('--output: holds an input, "planet.ply"', done.stderr)
        self.assertEqual((self.folder / "planet.ply").read_bytes(), before)

    def test_full_disk(self):
        """A limit of file sizes ends a write as a full disk does: at the first tiles, and in the directory at the end."""
        self.succeed("tiles", "planet.ply", "-o", "whole.3tz")
        for limit in (1, (self.folder / "whole.3tz").stat().st_size // 1024):
            (self.folder / "a.3tz").write_bytes(OLD)
            before = self.names()
            done = subprocess.run(["bash", "-c", f"ulimit -f {limit}; exec {OCCLOD} tiles planet.ply -o a.3tz --replace"], cwd=self.folder, capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
            self.assertIn("a.3tz: cannot be written", done.stderr)
            self.assertEqual((self.folder / "a.3tz").read_bytes(), OLD)
            self.assertEqual(self.names(), before)

    def test_damaged_input(self):
        self.succeed("hlod", "build", "planet.ply", "-o", "planet.ohlod", *NESTED)
        whole = bytearray((self.folder / "planet.ohlod").read_bytes())
        whole[len(whole) // 2] ^= 1
        (self.folder / "planet.ohlod").write_bytes(whole)
        (self.folder / "a.3tz").write_bytes(OLD)
        self.assertIn("checksum", self.failure_of("tiles", "planet.ohlod", "-o", "a.3tz", "--replace"))
        self.assertEqual((self.folder / "a.3tz").read_bytes(), OLD)
        self.assertEqual(self.names(), ["a.3tz", "planet.ohlod", "planet.ply"])

    def test_interrupts(self):
        self.make_large_planet(8)
        for number in (signal.SIGINT, signal.SIGTERM):
            self.cancel("building", number, "tiles", "planet.ply", "--replace", target="a.3tz")
        self.succeed("hlod", "build", "planet.ply", "-o", "planet.ohlod", *NESTED)
        self.cancel_while_writing(signal.SIGTERM, "tiles", "planet.ohlod", "--replace", target="a.3tz")

    def test_serve_says_that_it_needs_a_folder(self):
        self.succeed("tiles", "planet.ply", "-o", "a.3tz")
        done = self.run_tool("serve", "a.3tz")
        if done.returncode == 2:
            self.skipTest("SKIPPED: built without the server of tiles")
        self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
        self.assertIn("a.3tz: is a file, and a tileset is served from a folder", done.stderr)


class BrokenArchives(ToolTest):
    def refused(self, reason, change=lambda names, index: None, comment=b""):
        """`change` gets the names in their order and the entries of the index; Python's writer gives local headers the same places again."""
        with zipfile.ZipFile(self.folder / "good.3tz") as good, zipfile.ZipFile(self.folder / "bad.3tz", "w") as bad:
            names, whole = good.namelist(), good.read(INDEX)
            index = [whole[at:at + 24] for at in range(0, len(whole), 24)]
            change(names, index)
            for name in names:
                bad.writestr(zipfile.ZipInfo(name), b"".join(index) if name == INDEX else good.read(name))
            bad.comment = comment
        with self.assertRaisesRegex(Wrong, reason):
            tileset_check.check(self.folder / "bad.3tz")

    def test_broken(self):
        """Each change to a good archive is refused, for the right reason."""
        self.make_planet()
        self.succeed("tiles", "planet.ply", "-o", "good.3tz")
        with self.assertRaisesRegex(AssertionError, "Wrong not raised"):
            self.refused("")
        self.refused("has a comment", comment=b"a")
        self.refused("has no tileset.json", lambda names, index: names.remove("tileset.json"))
        self.refused("does not end in a stored index", lambda names, index: names.remove(INDEX))
        self.refused("does not end in a stored index", lambda names, index: names.insert(0, names.pop()))
        self.refused("index of another length", lambda names, index: index.pop())
        self.refused("not sorted", lambda names, index: index.reverse())
        self.refused("not sorted", lambda names, index: index.sort())  # by bytes, which is not by little-endian numbers
        self.refused("does not have .* in its index", lambda names, index: index.__setitem__(0, index[0][:15] + bytes([index[0][15] ^ 1]) + index[0][16:]))
        self.refused("names offset .*, behind its end", lambda names, index: index.__setitem__(0, index[0][:23] + b"\1"))
        self.refused("has no local header", lambda names, index: index.__setitem__(0, index[0][:16] + struct.pack("<Q", 1)))
        data = bytearray((self.folder / "good.3tz").read_bytes())
        data[1000] ^= 1
        (self.folder / "bad.3tz").write_bytes(data)
        with self.assertRaisesRegex(Wrong, "wrong checksum"):
            tileset_check.check(self.folder / "bad.3tz")


if __name__ == "__main__":
    unittest.main(verbosity=1)
