"""Names with control characters or bytes that are not UTF-8, and inputs that are no regular files."""
import json
import os
import subprocess
import unittest

from tool_case import OCCLOD, ToolTest

POINTS = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\n"
FACES = "f 1/1 3/2 2/3\nf 1/1 2/2 4/3\nf 1/1 4/2 3/3\nf 2/1 3/2 4/3\n"


class Names(ToolTest):
    def write_gltf(self, image, material="m"):
        gltf = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
                "materials": [{"name": material, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}], "textures": [{"source": 0}], "images": [{"uri": image}],
                "buffers": [{"byteLength": 60, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/"}],
                "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24}],
                "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
                              {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"}]}
        (self.folder / "a.gltf").write_text(json.dumps(gltf))
        self.succeed("build", "a.gltf", "-o", "a.olod")

    def cut(self, output):
        return ["cut", "a.olod", "--error", 0, "-o", output]

    def images_of(self, file):
        """The names of images as the file, read again, has them in an .olod file: JSON."""
        self.succeed("build", file, "-o", "again.olod")
        data = (self.folder / "again.olod").read_bytes()
        begin = data.index(b'{"materials"')
        return [texture["file"] for texture in json.JSONDecoder().raw_decode(data[begin:].decode(errors="replace"))[0]["textures"]]

    def test_names_that_no_line_can_hold(self):
        for uri in ("x.png%0Anewmtl%20evil", "x.png\nmtllib evil", "x.png\rf 1 2 3", "a\u007f.png", "a%1B.png", "blank%20", "back%5C"):
            self.write_gltf(uri)
            for output in ("o.ply", "o.obj"):
                line = self.failure_of(*self.cut(output))
                self.assertIn("the file name ", line)
                self.assertIn("which OBJ and PLY files cannot hold; rename", line)
            self.assertEqual(sorted(path.name for path in self.folder.iterdir() if path.name.startswith(("o.", ".o."))), [])
            self.succeed(*self.cut("o.glb"))
            before = self.images_of("a.olod".replace(".olod", ".gltf"))
            self.assertEqual(self.images_of("o.glb"), before)
            (self.folder / "o.glb").unlink()

    def test_names_that_begin_like_something_else(self):
        for name in ("-s 2 2 2 x.png", "# x.png", "%22x.png", " x.png", "plain name.png"):
            self.write_gltf(name)
            for output in ("o.ply", "o.obj"):
                self.succeed(*self.cut(output))
                plain = name.replace("%22", '"')
                self.assertEqual(self.images_of(output), [plain if name == "plain name.png" else "./" + plain])

    def test_names_of_materials(self):
        """A break in a name makes no line."""
        self.write_gltf("x.png", "m\nKd 0 0 0\nnewmtl evil")
        self.succeed(*self.cut("o.obj"))
        self.assertEqual((self.folder / "o.mtl").read_text().count("newmtl"), 1)
        self.succeed(*self.cut("o.glb"))
        self.assertIn(b'm\\nKd 0 0 0\\nnewmtl evil', (self.folder / "o.glb").read_bytes())

    def test_names_of_outputs(self):
        self.write_gltf("x.png")
        self.assertIn("cannot hold", self.failure_of(*self.cut("a\nb.obj")))
        self.succeed(*self.cut("#x.obj"))
        self.assertEqual(self.images_of("#x.obj"), ["./x.png"])

    def test_any_bytes_go_round(self):
        (self.folder / "a.obj").write_bytes(b"mtllib a.mtl\n" + POINTS.encode() + b"usemtl Stra\xdfe\n" + FACES.encode())
        (self.folder / "a.mtl").write_bytes(b"newmtl Stra\xdfe\nmap_Kd Stra\xdfe.png\n")
        self.succeed("build", "a.obj", "-o", "a.olod")
        self.succeed(*self.cut("o.obj"))
        library = (self.folder / "o.mtl").read_bytes()
        self.assertNotIn(b"\xef\xbf\xbd", library)
        self.assertTrue(b"map_Kd Stra\xdfe.png\n" in library or "map_Kd Straße.png\n".encode() in library, library)

    def test_nothing_steers_the_terminal(self):
        """Control characters are escaped in errors, in notes, in progress and in tables."""
        name = "\x1b]0;title\x07\n\u009b31m.ply"
        for arguments in (["info", name], ["build", name, "-o", "x.olod"], ["render", name], ["hlod", "info", name]):
            line = self.failure_of(*arguments)
            self.assertIn("\\x1b]0;title\\x07\\n\\x9b31m.ply", line)
        self.make_planet(name)
        shown = self.run_tool("build", name, "-o", "x.olod", "--progress", "always")
        for text in (shown.stdout, shown.stderr, self.succeed("info", name)):
            self.assertIn("\\x1b]0;title\\x07\\n\\x9b31m.ply", text)
            self.assertNotRegex(text, "[\x07\u009b]|\x1b[^[]")
        self.assertEqual(self.json_of("info", name)["file"], name)

    def test_colours_in_shortest_digits(self):
        colors = ("1 1 1", "0 0 0", "0.5 0.25 0.1", "0.8 0.2 1", "0.003 0.04 0.0401", "0.123457 0.9 0.999")
        (self.folder / "a.obj").write_text("mtllib a.mtl\n" + POINTS + "".join(f"usemtl {i}\n{FACES}" for i in range(len(colors))))
        (self.folder / "a.mtl").write_text("".join(f"newmtl {i}\nKd {color}\n" for i, color in enumerate(colors)))
        self.succeed("build", "a.obj", "-o", "a.olod")
        self.succeed(*self.cut("o.obj"))
        lines = (self.folder / "o.mtl").read_text().splitlines()
        self.assertEqual([line[3:] for line in lines if line.startswith("Kd ")][0], "1 1 1")
        for line, color in zip([line for line in lines if line.startswith("Kd ")], colors):
            for written, given in zip(line.split()[1:], color.split()):
                self.assertAlmostEqual(float(written), float(given), delta=1e-7)
                self.assertLessEqual(len(written), 10)
        self.succeed("build", "o.obj", "-o", "again.olod")
        self.succeed("cut", "again.olod", "--error", 0, "-o", "p.obj")
        self.assertTrue(self.same_bytes("o.mtl", "p.mtl"))

    def test_pipes_are_refused(self):
        """At once: nobody writes into them."""
        for name in ("p.olod", "p.ohlod", "p.vlod", "p.ply", "p.obj", "p.gltf", "p.json", "t.png", "tileset.json"):
            os.mkfifo(self.folder / name)
        (self.folder / "a.obj").write_text("mtllib a.mtl\n" + POINTS + "usemtl m\n" + FACES)
        (self.folder / "a.mtl").write_text("newmtl m\nmap_Kd t.png\n")
        (self.folder / "scene.json").write_text('{"objects": [{"mesh": "p.ply"}], "cameras": {"default": {"eye": [0, 0, 3], "target": [0, 0, 0]}}}')
        for arguments in (["info", "p.olod"], ["validate", "p.olod"], ["cut", "p.olod", "--error", 0, "-o", "x.ply"], ["hlod", "info", "p.ohlod"], ["hlod", "validate", "p.ohlod"],
                          ["hlod", "render", "p.ohlod"], ["cells", "info", "p.vlod"], ["cells", "walk", "p.vlod", "p.json", "--path", "p"], ["info", "p.ply"], ["info", "p.obj"],
                          ["info", "p.gltf"], ["render", "p.json"], ["render", "p.olod"], ["render", "scene.json"], ["hlod", "build", "p.json", "-o", "x.ohlod"],
                          ["hlod", "build", "scene.json", "-o", "x.ohlod"], ["hlod", "build", "p.ply", "-o", "x.ohlod", "--memory", "64M"],
                          ["render", "a.obj", "--budget", 9, "--png", "x.png", "--texture", "file"], ["render", "a.obj", "--calibration", "p.json"]):
            with self.subTest(arguments=arguments):
                done = subprocess.run([OCCLOD, *map(str, arguments)], cwd=self.folder, env=self.environment, capture_output=True, text=True, timeout=20)
                self.assertNotEqual(done.returncode, 0)
                self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for arguments in (["info", "p.olod"], ["hlod", "info", "p.ohlod"], ["cells", "info", "p.vlod"]):
            self.assertIn(f"{arguments[-1]}: is not a regular file; save it to a file first", self.failure_of(*arguments))


if __name__ == "__main__":
    unittest.main(verbosity=1)
