"""What the tests of the built command `occlod` (environment variable OCCLOD) share."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

OCCLOD = os.environ["OCCLOD"]
LEVEL = 4
TRIANGLES = 8 * 4**LEVEL
VERTICES = 4 ** (LEVEL + 1) + 2


class ToolTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="occlod-tool-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"), XDG_DATA_HOME=str(self.folder / "data"))

    def run_tool(self, *arguments):
        return subprocess.run([OCCLOD, *map(str, arguments)], cwd=self.folder, env=self.environment, capture_output=True, text=True)

    def succeed(self, *arguments):
        done = self.run_tool(*arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def failure_of(self, *arguments):
        """Failed: exit 1, nothing on standard output, one line on standard error. Returns the line."""
        done = self.run_tool(*arguments)
        self.assertEqual(done.returncode, 1, f"{arguments}: {done.stderr}")
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertTrue(done.stderr.startswith("occlod: error: "), done.stderr)
        return done.stderr

    def json_of(self, *arguments):
        """The one object on standard output: json.loads refuses anything beside it."""
        result = json.loads(self.succeed(*arguments, "--json"))
        self.assertIsInstance(result, dict)
        return result

    def make_planet(self, name="planet.ply", seed=1):
        return self.json_of("generate", "rough-planet", f"level={LEVEL}", f"seed={seed}", "-o", name)

    def make_hierarchy(self):
        self.make_planet()
        return self.json_of("build", "planet.ply", "-o", "planet.olod")

    def write_scene(self, text):
        (self.folder / "scene.json").write_text(text)

    def make_planets_hlod(self):
        """Writes scene.json, three planets one behind the other, walked past, and planets.ohlod. Returns the scene."""
        self.make_planet()
        camera = {"eye": [0.2, 0.3, 3], "target": [0, 0, 0], "near": 0.1, "far": 30}
        objects = [{"mesh": "planet.ply", "position": [0.3 * i, 0, -3 * i]} for i in range(3)]
        scene = {"objects": objects, "cameras": {"default": camera},
                 "paths": {"by": {"frames": 7, "keys": [camera, dict(camera, eye=[2.5, 0.3, 2.2])]},
                           "jump": {"frames": 4, "jump": True, "keys": [camera, dict(camera, eye=[-2, 1, 2])]}}}
        self.write_scene(json.dumps(scene))
        self.succeed("hlod", "build", "scene.json", "-o", "planets.ohlod", "--node-triangles", 64)
        return scene

    def assert_has_keys(self, result, keys):
        self.assertEqual(sorted(set(keys.split()) - set(result)), [])

    def same_bytes(self, a, b):
        return (self.folder / a).read_bytes() == (self.folder / b).read_bytes()
