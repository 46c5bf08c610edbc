"""`occlod tiles`, by tileset_check.py; and that the checker refuses tilesets that are broken in one way each."""
import base64
import json
import math
import shutil
import struct
import subprocess
import unittest
import zlib

import glb_check
import tileset_check
from tool_case import OCCLOD, TRIANGLES, ToolTest


class Tileset(ToolTest):
    def setUp(self):
        super().setUp()
        self.make_planet()
        self.build("planet.ohlod")

    def build(self, output, node_triangles=64, inputs=("planet.ply",)):
        return self.json_of("hlod", "build", *inputs, "-o", output, "--node-triangles", node_triangles, "--grouping", "nested", "--borders", "free")

    def export(self, *arguments, folder="tiles"):
        return self.json_of("tiles", "planet.ohlod", "-o", folder, *arguments)

    def check(self, folder="tiles", max_tiles=None):
        return tileset_check.check(self.folder / folder, max_tiles)

    def root(self, folder="tiles"):
        return json.loads((self.folder / folder / "tileset.json").read_text())["root"]

    def gltf(self, path):
        data = path.read_bytes()
        return json.loads(data[20:20 + struct.unpack_from("<I", data, 12)[0]])

    def errors(self, tile):
        yield tile["geometricError"]
        for child in tile.get("children", []):
            yield from self.errors(child)

    def assert_nothing_left(self, *names):
        self.assertEqual(sorted(path.name for path in self.folder.iterdir() if path.name not in ("cache", "data")), sorted(["planet.ply", "planet.ohlod", *names]))

    def test_all_nodes_are_tiles(self):
        told, info = self.export(), self.json_of("hlod", "info", "planet.ohlod")
        found = self.check()
        self.assertEqual((found["tiles"], found["contents"], told["tiles"]), (info["nodes"],) * 3)
        self.assertEqual((found["triangles"], told["triangles"]), (info["stored_triangles"],) * 2)
        self.assertEqual((found["leaf_triangles"], found["leaves"]), (TRIANGLES, info["level"][0]["nodes"]))
        self.assertEqual((told["tileset_files"], told["content_bytes"], found["depth"]), (1, found["content_bytes"], info["levels"] - 1))
        self.assertEqual(told["bytes"], sum(path.stat().st_size for path in (self.folder / "tiles").rglob("*") if path.is_file()))
        self.assertAlmostEqual(max(self.errors(self.root())), info["level"][-1]["guaranteed_error"], delta=1e-5 * info["level"][-1]["guaranteed_error"])
        self.assert_nothing_left("tiles")

    def test_external_tilesets(self):
        self.export(folder="one")
        whole = self.check("one")
        for most in (1, 10, 50):
            told = self.export("--tiles-per-file", most, folder=f"of{most}")
            # A tile and its children are in one file, whatever the limit.
            found = self.check(f"of{most}", max(most, 9))
            self.assertGreater(found["tilesets"], 1)
            self.assertEqual(told["tileset_files"], found["tilesets"])
            for key in ("tiles", "triangles", "leaves", "content_bytes"):
                self.assertEqual(found[key], whole[key], key)

    def test_features(self):
        """Groups of an OBJ file, rows of squares, are in the tables of tiles, with one number and name everywhere."""
        side, names = 24, [f"row {k}: \u00df" for k in range(24)]
        lines = [f"v {i} {j} {(i * j) % 7 / 9}" for j in range(side + 1) for i in range(side + 1)]
        for j in range(side):
            lines.append(f"g {names[j]}")
            lines += [f"f {a} {a + 1} {a + side + 2} {a + side + 1}" for i in range(side) for a in [j * (side + 1) + i + 1]]
        (self.folder / "rows.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")
        for options in ([], ["--quantise", 12, "--skirts"], ["--memory", "64M"]):
            told = self.json_of("tiles", "rows.obj", "-o", "rows", "--node-triangles", 64, "--replace", *options)
            self.assertEqual(told["features"], side)
            self.check("rows")
            found = {}
            for path in (self.folder / "rows/tiles").rglob("*.glb"):
                for number, name in self.features(path):
                    self.assertEqual(found.setdefault(number, name), name)
            self.assertEqual(found, dict(enumerate(names)))
        self.assertEqual(self.export(folder="planet")["features"], 0)
        self.assertNotIn("extensions", self.gltf(next((self.folder / "planet/tiles").rglob("*.glb"))))

    def features(self, path):
        """Pairs of number and name, of a tile."""
        glb = glb_check.Glb(path, path.name)
        (table,) = glb.gltf["extensions"]["EXT_structural_metadata"]["propertyTables"].list()
        numbers = struct.unpack(f"<{len(glb.names)}I", glb.bytes_of(table["properties"]["id"]["values"]))
        return list(zip(numbers, glb.names))

    def test_the_same_bytes_again(self):
        for folder in ("a", "b"):
            self.export("--skirts", "--tiles-per-file", 20, folder=folder)
        files = [sorted(path.relative_to(self.folder / folder) for path in (self.folder / folder).rglob("*") if path.is_file()) for folder in ("a", "b")]
        self.assertEqual(*files)
        self.assertTrue(all(self.same_bytes(f"a/{path}", f"b/{path}") for path in files[0]))

    def test_a_place_on_earth(self):
        """A degree of the meridian in Munich: the way between two origins is what the ellipsoid says, and up is up."""
        self.export("--origin", "11.5,48.1,520")
        self.check()
        matrix = self.root()["transform"]
        latitude, longitude = math.radians(48.1), math.radians(11.5)
        up = (math.cos(latitude) * math.cos(longitude), math.cos(latitude) * math.sin(longitude), math.sin(latitude))
        for k in range(3):
            self.assertAlmostEqual(matrix[8 + k], up[k], places=14)
        # Bowring's inverse of the place gives the same latitude, longitude and height.
        x, y, z = matrix[12:15]
        a, b = 6378137.0, 6356752.314245179
        p, theta = math.hypot(x, y), math.atan2(z * a, math.hypot(x, y) * b)
        e2, d2 = 1 - (b / a) ** 2, (a / b) ** 2 - 1
        phi = math.atan2(z + d2 * b * math.sin(theta) ** 3, p - e2 * a * math.cos(theta) ** 3)
        self.assertAlmostEqual(math.degrees(phi), 48.1, places=9)
        self.assertAlmostEqual(math.degrees(math.atan2(y, x)), 11.5, places=12)
        self.assertAlmostEqual(p / math.cos(phi) - a / math.sqrt(1 - e2 * math.sin(phi) ** 2), 520, places=5)
        for bad in ("11.5", "11.5,48.1", "181,0,0", "0,91,0", "a,b,c", "0,0,nan", "0,0,0,0", "0,,0"):
            done = self.run_tool("tiles", "planet.ohlod", "-o", "bad", "--origin", bad)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
            self.assertIn("--origin", done.stderr)
        self.assert_nothing_left("tiles")

    def test_y_up(self):
        """y of the input becomes z of the tileset, and z becomes -y: right-handed as before."""
        self.export("--up", "y")
        self.check()
        self.assertEqual(self.root()["transform"], [1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1])
        self.export(folder="z")
        self.assertNotIn("transform", self.root("z"))

    def test_quantised(self):
        plain = self.export(folder="plain")
        for bits in (8, 12, 16):
            told = self.export("--quantise", bits, folder=f"q{bits}")
            found = self.check(f"q{bits}")
            self.assertEqual(found["leaf_triangles"], TRIANGLES)
            self.assertLess(told["content_bytes"], plain["content_bytes"])
            content = self.gltf(self.folder / f"q{bits}/tiles/0/0.glb")
            position = content["accessors"][content["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]
            self.assertLess(max(position["max"]), 2**bits)
            self.assertGreaterEqual(max(position["max"]), 2 ** (bits - 1) - 1)
        for bad in (1, 7, 17):
            done = self.run_tool("tiles", "planet.ohlod", "-o", "bad", "--quantise", bad)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)

    def test_compressed(self):
        self.build("planet.ohlod", 1024)
        done = self.run_tool("tiles", "planet.ohlod", "-o", "small", "--compress", "meshopt", "--json")
        if "this build of occlod has no EXT_meshopt_compression" in done.stderr:
            self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1))
            self.skipTest("occlod was built without meshoptimizer")
        self.assertEqual(done.returncode, 0, done.stderr)
        quantised = self.export("--quantise", 14, folder="quantised")
        self.assertLess(json.loads(done.stdout)["content_bytes"], 0.7 * quantised["content_bytes"])
        small, large = self.check("small"), self.check("quantised")
        for key in ("tiles", "triangles", "leaf_triangles"):
            self.assertEqual(small[key], large[key], key)
        exact = self.export("--compress", "meshopt", "--quantise", 0, folder="exact")
        self.check("exact")
        self.assertNotIn("KHR_mesh_quantization", self.gltf(self.folder / "exact/tiles/0/0.glb")["extensionsUsed"])
        self.assertGreater(exact["content_bytes"], json.loads(done.stdout)["content_bytes"])

    def test_skirts(self):
        plain, skirts = self.export(folder="plain"), self.export("--skirts")
        self.assertEqual((plain["skirt_triangles"], plain["triangles"]), (0, skirts["triangles"]))
        self.assertGreater(skirts["skirt_triangles"], 0)
        self.assertEqual(self.check()["triangles"], skirts["triangles"] + skirts["skirt_triangles"])

    def test_textures(self):
        """Two squares with images of their own, one of which is missing, and one in a plain colour."""
        quads = "".join(f"v {x + dx} {dy} 0\nvt {dx} {dy}\n" for x in (0, 2, 4) for dx, dy in ((0, 0), (1, 0), (1, 1), (0, 1)))
        faces = "".join(f"usemtl {name}\nf {k}/{k} {k + 1}/{k + 1} {k + 2}/{k + 2}\nf {k}/{k} {k + 2}/{k + 2} {k + 3}/{k + 3}\n"
                        for name, k in (("a", 1), ("b", 5), ("c", 9)))
        images = self.folder / "images"
        images.mkdir()
        (images / "quads.obj").write_text("mtllib quads.mtl\n" + quads + faces)
        (images / "quads.mtl").write_text("newmtl a\nmap_Kd a b.png\nnewmtl b\nmap_Kd missing.png\nnewmtl c\nKd 1 0 0\n")
        png = base64.b64decode("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==")
        (images / "a b.png").write_bytes(png)
        self.build("planet.ohlod", inputs=["images/quads.obj"])
        for options in ([], ["--compress", "meshopt"], ["--quantise", 14]):
            told = self.export("--images", "images", "--replace", *options)
            self.assertEqual(told["images_left_out"], ["missing.png"])
            self.check()
            self.assertEqual([path.name for path in (self.folder / "tiles/textures").iterdir()], ["0.png"])
            self.assertEqual((self.folder / "tiles/textures/0.png").read_bytes(), png)
            gltf = self.gltf(self.folder / "tiles/tiles/0/0.glb")
            primitives = gltf["meshes"][0]["primitives"]
            self.assertEqual(len(primitives), 3)
            looks = [gltf["materials"][primitive["material"]]["pbrMetallicRoughness"] for primitive in primitives]
            self.assertEqual([("baseColorTexture" in look, "TEXCOORD_0" in primitive["attributes"]) for look, primitive in zip(looks, primitives)],
                             [(True, True), (False, False), (False, False)])
            self.assertEqual(looks[2]["baseColorFactor"], [1, 0, 0, 1])
            self.assertEqual(gltf["images"], [{"uri": "../../textures/0.png"}])
        note = self.run_tool("tiles", "planet.ohlod", "-o", "tiles", "--replace").stderr
        self.assertEqual(note.count("\n"), 2, note)  # the other is where it was when the .ohlod file was built
        self.assertIn("--images names the folder", note)
        self.assertIn("a b.png stays one file for all tiles", note)

    def test_vertices_that_no_triangle_uses(self):
        """A sheet with islands of texture coordinates: coarse nodes keep vertices for finer ones to slide to, and tiles leave them out."""
        n, lines = 24, ["vn 0 0 1"]
        lines += [f"v {x} {y} {2 * math.sin(x / 3) * math.cos(y / 4):.6f}" for y in range(n + 1) for x in range(n + 1)]
        lines += [f"vt {u / n:.6f} {v / n:.6f}" for turned in (False, True) for y in range(n + 1) for x in range(n + 1) for u, v in [(y, x) if turned else (x, y)]]
        for y in range(n):
            for x in range(n):
                corner, island = y * (n + 1) + x + 1, (n + 1) ** 2 * ((x // 4 + y // 4) % 2)
                lines.append("f " + " ".join(f"{v}/{v + island}/1" for v in (corner, corner + 1, corner + n + 2, corner + n + 1)))
        (self.folder / "sheet.obj").write_text("\n".join(lines) + "\n")
        self.build("planet.ohlod", inputs=["sheet.obj"])
        vertices_of_nodes = sum(level["vertices"] for level in self.json_of("hlod", "info", "planet.ohlod")["level"])
        for options in (["--skirts"], ["--quantise", 14], []):
            self.export("--replace", *options)
            self.assertGreaterEqual(self.check()["leaf_triangles"], 2 * n * n)
        contents = [self.gltf(path) for path in (self.folder / "tiles/tiles").rglob("*.glb")]
        self.assertLess(sum(gltf["accessors"][gltf["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]["count"] for gltf in contents), vertices_of_nodes)

    def test_only_trees(self):
        self.json_of("hlod", "build", "planet.ply", "-o", "shifted.ohlod", "--node-triangles", 64)
        line = self.failure_of("tiles", "shifted.ohlod", "-o", "tiles")
        self.assertIn("shifted.ohlod: has shifted groups", line)
        self.assertIn("--grouping nested", line)
        self.assertFalse((self.folder / "tiles").exists())

    def test_folders_that_are_there(self):
        (self.folder / "tiles").mkdir()
        self.export()
        self.assertIn("holds a tileset already", self.failure_of("tiles", "planet.ohlod", "-o", "tiles"))
        before = self.check()
        (self.folder / "tiles/old").write_text("")
        self.assertIn("holds old, which is no part", self.failure_of("tiles", "planet.ohlod", "-o", "tiles", "--replace"))
        (self.folder / "tiles/old").unlink()
        self.export("--replace", "--quantise", 12)
        self.assertEqual(self.check()["tiles"], before["tiles"])
        (self.folder / "foreign").mkdir()
        for text in ("{}", "[]", "not json", '{"asset": {"extras": {"generator": "other"}}}'):
            (self.folder / "foreign/tileset.json").write_text(text)
            self.assertIn("has not written", self.failure_of("tiles", "planet.ohlod", "-o", "foreign", "--replace"))
            self.assertEqual((self.folder / "foreign/tileset.json").read_text(), text)
        (self.folder / "file").write_text("x")
        self.assertIn("is not a folder", self.failure_of("tiles", "planet.ohlod", "-o", "file", "--replace"))
        self.assertIn("does not exist", self.failure_of("tiles", "planet.ohlod", "-o", "missing/tiles"))
        self.assertIn("name a folder in it", self.failure_of("tiles", "planet.ohlod", "-o", "tiles/."))
        (self.folder / "link").symlink_to("tiles")
        self.export("--replace", folder="link/")
        self.assertTrue((self.folder / "link").is_symlink())
        self.assert_nothing_left("file", "foreign", "link", "tiles")

    def test_damaged_input(self):
        whole = bytearray((self.folder / "planet.ohlod").read_bytes())
        whole[len(whole) // 2] ^= 1
        (self.folder / "planet.ohlod").write_bytes(whole)
        self.assertIn("checksum", self.failure_of("tiles", "planet.ohlod", "-o", "tiles"))
        self.assert_nothing_left()

    def test_full_disk(self):
        """A limit of file sizes ends a write as a full disk does."""
        self.export()
        before = self.check()
        done = subprocess.run(["bash", "-c", f"ulimit -f 1; exec {OCCLOD} tiles planet.ohlod -o tiles --replace"], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
        self.assertIn("tiles: cannot be written", done.stderr)
        self.assertEqual(self.check(), before)
        self.assert_nothing_left("tiles")

    def test_several_roots(self):
        """Two planets a million units apart are one tileset, whatever its roots."""
        self.write_scene('{"objects": [{"mesh": "planet.ply"}, {"mesh": "planet.ply", "position": [1e6, 0, 0]}],'
                         ' "cameras": {"default": {"eye": [0, 0, 4], "target": [0, 0, 0]}}}')
        self.build("planet.ohlod", inputs=["scene.json"])
        for options in ([], ["--quantise", "16", "--skirts"]):
            self.export("--replace", *options)
            self.assertGreaterEqual(self.check()["leaf_triangles"], 2 * TRIANGLES)


class OneCommand(ToolTest):
    """`occlod tiles` of meshes writes the bytes of `occlod tiles` of their HLOD, but for images that the HLOD has for its nodes."""

    gltf = Tileset.gltf

    def files_of(self, folder):
        return {str(path.relative_to(self.folder / folder)): path.read_bytes() for path in (self.folder / folder).rglob("*") if path.is_file()}

    def assert_as_by_two(self, inputs, build=(), export=()):
        """Returns what the one command has told."""
        told = self.json_of("tiles", *inputs, "-o", "one", "--replace", *build, *export)
        self.succeed("hlod", "build", *inputs, "-o", "two.ohlod", "--grouping", "nested", "--borders", "free", "--error-bound", "measured", *build)
        self.succeed("tiles", "two.ohlod", "-o", "two", "--replace", *export)
        self.assertEqual(self.files_of("one"), self.files_of("two"))
        self.assertEqual(told["tiles"], tileset_check.check(self.folder / "one")["contents"])
        self.assert_has_keys(told, "inputs folder up tiles triangles bytes build_ms write_ms peak_bytes")
        return told

    def test_a_mesh(self):
        self.make_planet()
        self.assert_as_by_two(["planet.ply"])
        self.assert_as_by_two(["planet.ply"], ["--node-triangles", 64, "--threads", 1], ["--quantise", 12, "--skirts", "--origin", "11.5,48.1,520"])
        self.assert_as_by_two(["planet.ply"], ["--memory", "64M"], ["--up", "y"])
        self.succeed("tiles", "planet.ply", "-o", "slash/", "--memory", "64M", "--up", "y")
        self.assertEqual(self.files_of("slash"), self.files_of("one"))
        self.make_planet("b.ply", 2)
        self.assert_as_by_two(["planet.ply", "b.ply"])

    def test_an_ohlod_file(self):
        self.make_planet()
        told = self.assert_as_by_two(["planet.ply"], export=["--skirts"])
        again = self.json_of("tiles", "two.ohlod", "-o", "again", "--skirts")
        self.assertEqual(self.files_of("again"), self.files_of("one"))
        self.assertEqual((again["triangles"], "build_ms" in again), (told["triangles"], False))
        self.succeed("tiles", "two.ohlod", "-o", "limited", "--skirts", "--memory", "64M")
        self.assertEqual(self.files_of("limited"), self.files_of("one"))
        done = self.run_tool("tiles", "two.ohlod", "-o", "bad", "--node-triangles", 64)
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
        self.assertIn("--node-triangles: goes with meshes only", done.stderr)
        self.succeed("hlod", "build", "planet.ply", "-o", "shifted.ohlod")
        self.assertIn("shifted.ohlod: has shifted groups", self.failure_of("tiles", "shifted.ohlod", "-o", "bad"))
        self.assertFalse((self.folder / "bad").exists())

    def test_textures(self):
        """In a folder of their own, in a scene, and in a GLB file."""
        source = self.folder / "source"
        source.mkdir()
        (source / "quad.obj").write_text("mtllib quad.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3 4/4\n")
        (source / "quad.mtl").write_text("newmtl a\nmap_Kd a b.png\n")
        (source / "a b.png").write_bytes(base64.b64decode("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNkYPhfDwAChwGA60e6kgAAAABJRU5ErkJggg=="))
        (source / "scene.json").write_text('{"objects": [{"mesh": "quad.obj"}, {"mesh": "quad.obj", "position": [3, 0, 0]}],'
                                           ' "cameras": {"default": {"eye": [0, 0, 4], "target": [0, 0, 0]}}}')
        self.succeed("build", "source/quad.obj", "-o", "quad.olod")
        self.succeed("cut", "quad.olod", "--error", 0, "-o", "quad.glb")
        for name in ("source/quad.obj", "source/scene.json", "quad.glb"):
            self.assertEqual(self.assert_as_by_two([name])["images_left_out"], [], name)
            self.assertTrue((self.folder / "one/textures/0.png").exists(), name)

    def test_images_of_tiles(self):
        """A textured sheet: each tile holds its part of the image, in one file, whatever memory there is and whichever format is asked for."""
        n, size = 48, 256
        lines = ["mtllib sheet.mtl", "usemtl paper", *(f"v {x} {y} {2 * math.sin(x / 3) * math.cos(y / 4):.6f}" for y in range(n + 1) for x in range(n + 1))]
        lines += [f"vt {0.01 + 0.98 * x / n:.6f} {0.01 + 0.98 * y / n:.6f}" for y in range(n + 1) for x in range(n + 1)]
        lines += ["f " + " ".join(f"{v}/{v}" for v in (c, c + 1, c + n + 2, c + n + 1)) for y in range(n) for x in range(n) for c in [y * (n + 1) + x + 1]]
        (self.folder / "sheet.obj").write_text("\n".join(lines) + "\n")
        (self.folder / "sheet.mtl").write_text("newmtl paper\nmap_Kd paper.png\n")

        def chunk(kind, data):
            return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        rows = b"".join(b"\0" + bytes(x * y % 251 for x in range(size)) for y in range(size))
        (self.folder / "paper.png").write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, 8, 0, 0, 0, 0)) +
                                                chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
        build = ["--node-triangles", 256]
        self.succeed("hlod", "build", "sheet.obj", "-o", "sheet.ohlod", "--grouping", "nested", "--borders", "free", "--error-bound", "measured", *build)
        for options in ([], ["--texture-format", "jpeg"], ["--quantise", 14, "--skirts"]):
            told = self.json_of("tiles", "sheet.obj", "-o", "one", "--replace", *build, *options)
            of_nodes = self.json_of("tiles", "sheet.ohlod", "-o", "two", "--replace", *options)
            self.assertEqual((told["images_left_out"], told["images_shared"], told["source_texels"]), ([], [], size * size))
            for one, folder in ((told, self.folder / "one"), (of_nodes, self.folder / "two")):
                self.assertEqual(one["tiles"], tileset_check.check(folder)["contents"])
                self.assertFalse((folder / "textures").exists())
                contents = [self.gltf(path) for path in (folder / "tiles").rglob("*.glb")]
                self.assertEqual({image["mimeType"] for gltf in contents for image in gltf["images"]}, {"image/jpeg" if "jpeg" in options else "image/png"})
                self.assertEqual([len(gltf["images"]) for gltf in contents], [1] * one["tiles"])
                self.assertLess(one["texture_bytes"], one["content_bytes"])
        self.succeed("tiles", "sheet.obj", "-o", "limited", "--node-triangles", 256, *options, "--memory", "64M", "--threads", 1)
        self.assertEqual(self.files_of("limited"), self.files_of("one"))

    def test_folders(self):
        """Refused before anything is read: there is no mesh."""
        (self.folder / "foreign").mkdir()
        (self.folder / "foreign/tileset.json").write_text("{}")
        self.assertIn("has not written", self.failure_of("tiles", "none.ply", "-o", "foreign", "--replace"))
        self.assertIn("none.ply", self.failure_of("tiles", "none.ply", "-o", "new"))
        self.make_planet()
        self.succeed("tiles", "planet.ply", "-o", "new")
        before = self.files_of("new")
        self.assertIn("holds a tileset already", self.failure_of("tiles", "planet.ply", "-o", "new"))
        done = self.run_tool("tiles", "new/tiles/0/0.glb", "-o", "new", "--replace")
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
        self.assertIn("--output: holds an input", done.stderr)
        self.assertEqual(self.files_of("new"), before)


class Broken(ToolTest):
    """Each change to a good tileset is refused, for the right reason."""

    def setUp(self):
        super().setUp()
        self.make_planet()
        self.json_of("hlod", "build", "planet.ply", "-o", "planet.ohlod", "--node-triangles", 64, "--grouping", "nested", "--borders", "free")
        self.json_of("tiles", "planet.ohlod", "-o", "good", "--tiles-per-file", 30)
        tileset_check.check(self.folder / "good")

    def refused(self, reason, change):
        """`change` gets the folder of a copy."""
        copy = self.folder / "broken"
        shutil.copytree(self.folder / "good", copy)
        change(copy)
        try:
            with self.assertRaisesRegex(tileset_check.Wrong, reason):
                tileset_check.check(copy)
        finally:
            shutil.rmtree(copy)

    def change_json(self, reason, change):
        def in_file(folder):
            path = folder / "tileset.json"
            tileset = json.loads(path.read_text())
            change(tileset)
            path.write_text(json.dumps(tileset))
        self.refused(reason, in_file)

    @staticmethod
    def first(tile, accept):
        """The first tile below which `accept` takes."""
        todo = [tile]
        while todo:
            at = todo.pop(0)
            if accept(at):
                return at
            todo += at.get("children", [])
        raise AssertionError("no such tile")

    def leaf(self, tileset):
        return self.first(tileset["root"], lambda tile: "children" not in tile and tile["content"]["uri"].endswith(".glb"))

    def external(self, tileset):
        return self.first(tileset["root"], lambda tile: tile.get("content", {}).get("uri", "").endswith(".json"))

    def test_tilesets(self):
        def inner(tileset):
            return self.first(tileset["root"], lambda tile: tile is not tileset["root"] and "children" in tile)
        for reason, change in (
            ("version: is not 1.1", lambda t: t["asset"].update(version="1.0")),
            ("has no geometricError", lambda t: t.pop("geometricError")),
            ("unknown key", lambda t: t.update(geometricEror=1)),
            ("unknown key", lambda t: inner(t).update(childen=[])),
            ("not above the root's", lambda t: t.update(geometricError=0)),
            ("refine: REPLACE", lambda t: t["root"].pop("refine")),
            ("refine: REPLACE", lambda t: t["root"].update(refine="ADD")),
            ("is below the root and has refine", lambda t: inner(t).update(refine="ADD")),
            ("not less than the parent's", lambda t: inner(t).update(geometricError=t["root"]["geometricError"])),
            ("is below 0", lambda t: inner(t).update(geometricError=-1)),
            ("is no finite number", lambda t: inner(t).update(geometricError=True)),
            ("is no number", lambda t: inner(t).update(geometricError=math.nan)),
            ("or not 0 at a leaf", lambda t: self.leaf(t).update(geometricError=1e-30)),
            ("is 0 above children|not less", lambda t: inner(t).update(geometricError=0)),
            ("empty list of children", lambda t: self.leaf(t).update(children=[])),
            ("leaf without content", lambda t: self.leaf(t).pop("content")),
            ("leaves the parent's", lambda t: inner(t)["boundingVolume"]["box"].__setitem__(3, 100)),
            ("not 12 numbers", lambda t: inner(t)["boundingVolume"]["box"].pop()),
            ("flat, mirrored", lambda t: inner(t)["boundingVolume"]["box"].__setitem__(3, 0)),
            ("flat, mirrored", lambda t: inner(t)["boundingVolume"]["box"].__setitem__(4, 0.1)),
            ("leaves the tile's", lambda t: inner(t)["content"]["boundingVolume"]["box"].__setitem__(0, 100)),
            ("is not tight|leaves the tile's", lambda t: self.leaf(t)["content"]["boundingVolume"]["box"].__setitem__(3, 1.01 * self.leaf(t)["boundingVolume"]["box"][3])),
            ("vertices of .* leave it", lambda t: [self.leaf(t)["content"]["boundingVolume"]["box"].__setitem__(3 + 4 * k, 1e-9) for k in range(3)]),
            ("has no boundingVolume", lambda t: inner(t)["content"].pop("boundingVolume")),
            ("is not there", lambda t: inner(t)["content"].update(uri="tiles/0/none.glb")),
            ("leaves the folder", lambda t: inner(t)["content"].update(uri="../planet.ohlod")),
            ("leaves the folder", lambda t: inner(t)["content"].update(uri="%2e%2e/planet.ohlod")),
            ("no relative uri", lambda t: inner(t)["content"].update(uri="http://example.org/a.glb")),
            ("used twice", lambda t: inner(t)["content"].update(uri=t["root"]["content"]["uri"])),
            ("an external tileset and children", lambda t: self.external(t).update(children=[self.leaf(t)])),
            ("not the tile that refers", lambda t: self.external(t).update(geometricError=self.external(t)["geometricError"] * 0.99)),
            ("not affine", lambda t: t["root"].update(transform=[1, 0, 0, 1] * 4)),
            ("rotate and move", lambda t: t["root"].update(transform=[2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1])),
            ("mirrors", lambda t: t["root"].update(transform=[-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])),
        ):
            with self.subTest(reason=reason):
                self.change_json(reason, change)

    def test_files(self):
        self.refused("not part of the tileset", lambda folder: (folder / "tiles/0/99999.glb").write_bytes(b""))
        self.refused("is no JSON", lambda folder: (folder / "tileset.json").write_text("{"))
        self.refused("is not there", lambda folder: (folder / "tiles/0/0.glb").unlink())
        self.refused("is not there", lambda folder: next(folder.glob("tileset-*.json")).unlink())

    def test_contents(self):
        def content(change_bytes=None, change_json=None):
            def change(folder):
                path = folder / "tiles/0/0.glb"
                data = bytearray(path.read_bytes())
                size = struct.unpack_from("<I", data, 12)[0]
                if change_json:
                    gltf = json.loads(data[20:20 + size])
                    change_json(gltf)
                    text = json.dumps(gltf).encode()
                    text += b" " * (-len(text) % 4)
                    data = data[:12] + struct.pack("<I", len(text)) + b"JSON" + text + data[20 + size:]
                    struct.pack_into("<I", data, 8, len(data))
                if change_bytes:
                    data = change_bytes(data, 28 + size)
                path.write_bytes(data)
            return change

        def put(data, at, form, *values):
            struct.pack_into(form, data, at, *values)
            return data

        for reason, change in (
            ("another length", content(lambda data, binary: data[:-4])),
            ("no binary glTF", content(lambda data, binary: b"glTX" + data[4:])),
            ("min and max", content(lambda data, binary: put(data, binary, "<3f", 50, 50, 50))),
            ("indices that leave", content(lambda data, binary: put(data, len(data) - 4, "<2H", 60000, 60000))),
            ("normal of another length", content(None, lambda gltf: gltf["bufferViews"].__setitem__(1, gltf["bufferViews"][0]))),
            ("unexpected type", content(None, lambda gltf: gltf["accessors"][0].update(type="VEC2"))),
            ("leaves its view|error", content(None, lambda gltf: gltf["accessors"][0].update(count=10**6))),
            ("leaves its buffer", content(None, lambda gltf: gltf["bufferViews"][0].update(byteOffset=4 * 10**6))),
            ("different counts", content(None, lambda gltf: gltf["accessors"][1].update(count=3))),
            ("no triangles", content(None, lambda gltf: gltf["accessors"][-1].update(count=4))),
            ("extension is unknown", content(None, lambda gltf: gltf.update(extensionsUsed=["X"], extensionsRequired=["X"]))),
            ("used and not required", content(None, lambda gltf: gltf.update(extensionsUsed=["KHR_mesh_quantization"]))),
            ("vertices of .* leave it", content(None, lambda gltf: gltf["nodes"][0].update(translation=[9, 9, 9]))),
            ("accessors.3.: is not used", content(None, lambda gltf: gltf["accessors"].append(gltf["accessors"][0]))),
            ("bufferViews.3.: is not used", content(None, lambda gltf: gltf["bufferViews"].append(gltf["bufferViews"][0]))),
            ("has no min", content(None, lambda gltf: gltf["accessors"][0].pop("min"))),
        ):
            with self.subTest(reason=reason):
                self.refused(reason, change)


if __name__ == "__main__":
    unittest.main(verbosity=1)
