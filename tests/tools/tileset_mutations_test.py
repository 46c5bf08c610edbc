"""tileset_check.py on tilesets that are malformed by chance and on purpose: one line that names the file and the place, never a traceback."""
import base64
import contextlib
import copy
import io
import json
import random
import re
import shutil
import struct
import subprocess
import sys
import unittest
import unittest.mock

import tileset_check
from tool_case import ToolTest

RUNS = 600
TILESET, EXTERNAL, CONTENT = "tileset.json", "tileset-1.json", "tiles/0/0.glb"
PNG = base64.b64decode("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNkYPhfDwAChwGA60e6kgAAAABJRU5ErkJggg==")
HUGE = 10**400  # neither a float nor a 64-bit integer

# What takes the place of a value: of each type of JSON, and numbers at the ends of what clients hold.
ODD = [None, True, False, 0, 1, -1, 0.5, 1e308, -1e308, 1e-320, 2**31, 2**32, 2**53 + 1, 2**64, HUGE, "", "x", "\0", "a\nb", "\ud800", "..", "/", "a" * 5000,
       [], [None], [[]], {}, {"": 0}, {"uri": []}]

# Glb and tileset say nothing of these: any value may stand there.
FREE = re.compile(r"asset\.extras|^scene$|materials\.\d+\.name$|baseColorFactor\.[012]$|wrap[ST]$")
# May be left out: without it vertices lie as closely as ours do, or a tileset lies where it is.
OPTIONAL = re.compile(r"byteStride$|^root\.transform$")


def places(value, way=()):
    """The ways to all values of a document but itself."""
    for key, item in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
        yield (*way, key)
        yield from places(item, (*way, key))


def holder_of(document, way):
    for key in way[:-1]:
        document = document[key]
    return document


def is_same(a, b):
    """Equal numbers are the same however they are written; False is no number here."""
    return a == b and isinstance(a, bool) == isinstance(b, bool)


def mutate_json(document, chance):
    """One change; where, and whether it matters: it does but where anything may stand, and where nothing has changed."""
    way = chance.choice(list(places(document)))
    holder, key = holder_of(document, way), way[-1]
    before, kind = copy.deepcopy(holder[key]), chance.randrange(6)
    matters = True
    if kind <= 2:
        holder[key] = copy.deepcopy(chance.choice(ODD))
        matters = not is_same(before, holder[key])
    elif kind == 3:
        holder[key] = [before]
    elif kind == 4:
        del holder[key]
    elif isinstance(holder, dict):
        holder[f"{key}s"] = holder.pop(key)
    else:
        holder.insert(key, before)
    name = ".".join(map(str, way))
    return name, matters and not FREE.search(name) and not (kind == 4 and OPTIONAL.search(name))


def split_glb(data):
    size = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + size]), data[20 + size:]


def join_glb(text, binary):
    text += b" " * (-len(text) % 4)
    return struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text) + len(binary), len(text), b"JSON") + text + binary


class Mutations(ToolTest):
    def setUp(self):
        super().setUp()
        self.make_planet()
        self.json_of("hlod", "build", "planet.ply", "-o", "planet.ohlod", "--node-triangles", 200, "--grouping", "nested", "--borders", "free")
        self.json_of("tiles", "planet.ohlod", "-o", "good", "--tiles-per-file", 6, "--origin", "11.5,48.1,520")
        self.good = self.folder / "good"
        tileset_check.check(self.good)

    def other_exports(self):
        """Quantised and, where occlod can, compressed contents; and one with a texture."""
        self.json_of("tiles", "planet.ohlod", "-o", "quantised", "--quantise", 12)
        if "has no EXT_meshopt_compression" not in self.run_tool("tiles", "planet.ohlod", "-o", "packed", "--compress", "meshopt").stderr:
            yield self.folder / "packed"
        yield self.folder / "quantised"
        (self.folder / "a.obj").write_text("mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n")
        (self.folder / "a.mtl").write_text("newmtl a\nmap_Kd a.png\n")
        (self.folder / "a.png").write_bytes(PNG)
        self.json_of("hlod", "build", "a.obj", "-o", "a.ohlod", "--grouping", "nested", "--borders", "free")
        self.json_of("tiles", "a.ohlod", "-o", "textured")
        yield self.folder / "textured"

    @contextlib.contextmanager
    def changed(self, name, data):
        """The folder, with other bytes in one of its files meanwhile."""
        path = self.good / name
        before = path.read_bytes()
        path.write_bytes(data)
        try:
            yield
        finally:
            path.write_bytes(before)

    def run_main(self):
        """What `tileset_check.py good` would print on standard error; None where it accepts. Any exception but that of sys.exit() gets out."""
        with unittest.mock.patch.object(sys, "argv", ["tileset_check.py", str(self.good)]), contextlib.redirect_stdout(io.StringIO()):
            try:
                tileset_check.main()
            except SystemExit as exit:
                return exit.code
        return None

    def assert_refused(self, line, name):
        self.assertIsInstance(line, str, "was accepted")
        self.assertRegex(line, rf"\A{re.escape(str(self.good))}/[\w./-]+: [ -~]+\Z")
        self.assertLess(len(line) - len(str(self.good)), 300)
        if name:
            self.assertIn(f"{self.good}/{name}: ", line)

    def values_by_chance(self, chance, runs, names):
        for run in range(runs):
            name = chance.choice(names)
            data = (self.good / name).read_bytes()
            document, binary = split_glb(data) if name == CONTENT else (json.loads(data), b"")
            place, matters = mutate_json(document, chance)
            text = json.dumps(document).encode()
            with self.subTest(run=run, file=name, place=place), self.changed(name, join_glb(text, binary) if name == CONTENT else text):
                line = self.run_main()
                if matters:
                    self.assert_refused(line, None)

    def test_values_by_chance(self):
        self.values_by_chance(random.Random(1), RUNS, (TILESET, TILESET, EXTERNAL, CONTENT))

    def test_values_of_other_contents_by_chance(self):
        for folder in self.other_exports():
            self.good = folder
            tileset_check.check(folder)
            self.values_by_chance(random.Random(3), RUNS // 3, (CONTENT,))

    def test_bytes_by_chance(self):
        """Headers of contents, and all bytes of documents; a change inside a text or a number may be for another that is good as well."""
        chance = random.Random(2)
        refused = 0
        for run in range(RUNS):
            name = chance.choice((TILESET, CONTENT, CONTENT))
            data = bytearray((self.good / name).read_bytes())
            kind = chance.randrange(4)
            if kind == 0:
                data = data[:chance.randrange(len(data))]
            elif kind == 1:
                data += chance.randbytes(chance.randrange(1, 40))
            else:
                for _ in range(chance.randrange(1, 4)):
                    data[chance.randrange(20 if kind == 2 and name == CONTENT else len(data))] = chance.randrange(256)
            with self.subTest(run=run, file=name, kind=kind), self.changed(name, data):
                line = self.run_main()
                if line is not None:
                    self.assert_refused(line, None)
                    refused += 1
        self.assertGreater(refused, 0.75 * RUNS)

    def test_on_purpose(self):
        """The place is named as well as the file."""
        tileset, external = (json.loads((self.good / name).read_bytes()) for name in (TILESET, EXTERNAL))
        gltf, binary = split_glb((self.good / CONTENT).read_bytes())
        documents = {TILESET: tileset, EXTERNAL: external, CONTENT: gltf}
        for name, way, value, line in (
            (TILESET, ["asset"], [], "asset: is no object"),
            (TILESET, ["asset", "version"], 1.1, "asset.version: is not 1.1"),
            (TILESET, ["geometricError"], "5", "geometricError: is no finite number"),
            (TILESET, ["root"], [], "root: is no object"),
            (TILESET, ["root", "geometricError"], HUGE, "root.geometricError: is no finite number"),
            (TILESET, ["root", "children"], {}, "root.children: is no list"),
            (TILESET, ["root", "children", 1], None, "root.children[1]: is no object"),
            (TILESET, ["root", "boundingVolume", "box"], None, "root.boundingVolume.box: is not 12 numbers"),
            (TILESET, ["root", "boundingVolume", "box", 7], "0", "root.boundingVolume.box[7]: is no finite number"),
            (TILESET, ["root", "content"], "tiles/0/0.glb", "root.content: is no object"),
            (TILESET, ["root", "content", "uri"], 7, "root.content.uri: is no text"),
            (TILESET, ["root", "content", "uri"], "a\0b", 'root.content.uri: "a\\u0000b" is not there'),
            (TILESET, ["root", "content", "uri"], "\ud800", 'root.content.uri: "\\ud800" is not there'),
            (TILESET, ["root", "content", "uri"], "n" * 5000, "root.content.uri: \"nnn"),
            (TILESET, ["root", "content", "uri"], "two\nlines", 'root.content.uri: "two\\nlines" is not there'),
            (TILESET, ["root", "content", "uri"], "tiles", 'root.content.uri: "tiles" is not there'),  # a folder
            (TILESET, ["root", "transform"], [1] * 15, "root.transform: is not 16 numbers"),
            (TILESET, ["root", "transform", 12], False, "root.transform[12]: is no finite number"),
            (EXTERNAL, ["root", "boundingVolume"], 0, "root.boundingVolume: is no object"),
            (EXTERNAL, ["root", "refine"], None, "root: does not say refine: REPLACE"),
            (CONTENT, ["asset"], "2.0", "asset: is no object"),
            (CONTENT, ["asset", "generator"], 2, "asset.generator: is no text"),
            (CONTENT, ["extensionsUsed"], {}, "extensionsUsed: is no list"),
            (CONTENT, ["extensionsUsed"], [7], "extensionsUsed[0]: is no text"),
            (CONTENT, ["nodes"], {"0": 1}, "nodes: is no list"),
            (CONTENT, ["nodes", 0, "translation"], [0, 0], "nodes[0].translation: is not 3 numbers"),
            (CONTENT, ["nodes", 0, "translation", 1], HUGE, "nodes[0].translation[1]: is no finite number"),
            (CONTENT, ["meshes", 0, "primitives"], [], "meshes[0]: has no primitives"),
            (CONTENT, ["meshes", 0, "primitives", 0, "attributes", "NORMAL"], -1, "attributes.NORMAL: is no integer of at least 0"),
            (CONTENT, ["meshes", 0, "primitives", 0, "attributes", "NORMAL"], 99, "attributes.NORMAL: names an accessor that is not there"),
            (CONTENT, ["meshes", 0, "primitives", 0, "material"], 1.0, "primitives[0].material: is no integer"),
            (CONTENT, ["buffers", 0, "byteLength"], HUGE, "buffers[0]: has another size than the chunk"),
            (CONTENT, ["buffers"], [], "buffers: are too many or too few"),
            (CONTENT, ["bufferViews", 0, "byteLength"], -12, "bufferViews[0].byteLength: is no integer of at least 1"),
            (CONTENT, ["bufferViews", 0, "byteOffset"], -4, "bufferViews[0].byteOffset: is no integer of at least 0"),
            (CONTENT, ["bufferViews", 0, "buffer"], 1, "bufferViews[0].buffer: names a buffer that is not there"),
            (CONTENT, ["bufferViews", 0, "byteStride"], 0, "bufferViews[0].byteStride: is no integer of at least 1"),
            (CONTENT, ["bufferViews", 0, "byteStride"], 4, "accessors[0]: has elements that overlap"),
            (CONTENT, ["bufferViews", 2, "byteOffset"], HUGE, "bufferViews[2]: leaves its buffer"),
            (CONTENT, ["accessors", 0, "count"], HUGE, "accessors[0]: leaves its view"),
            (CONTENT, ["accessors", 0, "count"], 0, "accessors[0].count: is no integer of at least 1"),
            (CONTENT, ["accessors", 0, "type"], [], "accessors[0].type: is no text"),
            (CONTENT, ["accessors", 0, "type"], "MAT4", "accessors[0].type: is no type of elements"),
            (CONTENT, ["accessors", 0, "componentType"], 5124, "accessors[0].componentType: is no type of components"),
            (CONTENT, ["accessors", 0, "componentType"], [5126], "accessors[0].componentType: is no type of components"),
            (CONTENT, ["accessors", 0, "min"], None, "accessors[0].min: is not 3 numbers"),
            (CONTENT, ["materials", 0, "pbrMetallicRoughness"], 3, "materials[0].pbrMetallicRoughness: is no object"),
            (CONTENT, ["materials", 0, "pbrMetallicRoughness", "baseColorTexture"], {"index": 0}, "baseColorTexture.index: names a texture that is not there"),
        ):
            with self.subTest(file=name, way=way, value=str(value)[:40]):
                document = copy.deepcopy(documents[name])
                holder_of(document, way)[way[-1]] = value
                text = json.dumps(document).encode()
                with self.changed(name, join_glb(text, binary) if name == CONTENT else text):
                    told = self.run_main()
                self.assert_refused(told, name)
                self.assertIn(line, told)

    def test_texts_that_are_no_json(self):
        deep = b"[" * 100_000
        binary = split_glb((self.good / CONTENT).read_bytes())[1]
        for text, line in (
            (b"", "is no JSON"),
            (deep, "is nested too deeply"),
            (b'{"root":' * 100_000, "is nested too deeply"),
            (b"\xff\xfe{}", "is no JSON"),
            (b"\0\1\2\3", "is no JSON"),
            (b"9" * 5000, "is no JSON"),  # more digits than Python reads
            (b"[]", "is no object"),
            (b"7", "is no object"),
            (b'{"asset": NaN}', "NaN is no number"),
            (b'{"asset": {"version": "1.1", "version": "1.1"}}', 'has the key "version" twice'),
            (b'{"asset": 1, "a\\nb": 2, "geometricError": 1, "root": {}}', 'has an unknown key "a\\nb"'),
        ):
            with self.subTest(text=text[:40]):
                with self.changed(TILESET, text):
                    told = self.run_main()
                self.assert_refused(told, TILESET)
                self.assertIn(line, told)
                with self.changed(CONTENT, join_glb(text, binary)):
                    self.assert_refused(self.run_main(), CONTENT)

    def test_chains_and_trees_of_a_thousand(self):
        """Neither tiles one below the other nor tilesets that name the next are as many as Python's calls may be nested; JSON may."""
        box = {"box": [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]}
        shutil.rmtree(self.good)
        self.good.mkdir()
        for k in range(1500):
            root = {"boundingVolume": box, "geometricError": 9, "refine": "REPLACE", "children": [{"boundingVolume": box, "geometricError": 8 - k / 1e4}]}
            root["geometricError"] = 9 if k == 0 else 8 - (k - 1) / 1e4
            root["children"][0]["content"] = {"uri": f"{k + 1}.json"}
            name = "tileset.json" if k == 0 else f"{k}.json"
            (self.good / name).write_text(json.dumps({"asset": {"version": "1.1", "extras": 0}, "geometricError": 9, "root": root}))
        told = self.run_main()
        self.assert_refused(told, "1499.json")
        self.assertIn('root.children[0].content.uri: "1500.json" is not there', told)

    def test_program(self):
        """As it is started: exit code, one line, and nothing on standard output."""
        program = tileset_check.__file__
        for name, data, line in ((TILESET, b"{", "tileset.json: is no JSON"), (CONTENT, b"glTF", "tiles/0/0.glb: is cut short"), (TILESET, b"[" * 100_000, "nested")):
            with self.changed(name, data):
                done = subprocess.run([sys.executable, program, "good"], cwd=self.folder, capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (1, "", 1), done.stderr)
            self.assertTrue(done.stderr.startswith("good/"), done.stderr)
            self.assertIn(line, done.stderr)
        done = subprocess.run([sys.executable, program, "missing"], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (1, 'missing/tileset.json: "tileset.json" is not there\n'))


if __name__ == "__main__":
    unittest.main(verbosity=1)
