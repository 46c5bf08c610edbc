"""Files that belong together: what inputs name is not overwritten, what outputs come with appears with them or not at all, and exports remove only
what exports wrote."""
import json
import os
import struct
import subprocess
import unittest

from tool_case import OCCLOD, ToolTest

CAMERAS = {"default": {"eye": [0, 0, 3], "target": [0, 0, 0]}}
PATH = {"p": {"frames": 3, "keys": [{"eye": [0, 0, 3], "target": [0, 0, 0], "width": 16, "height": 12}]}}
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 3/2 2/3\nf 1/1 2/2 4/3\nf 1/1 4/2 3/3\nf 2/1 3/2 4/3\n"
# Three vertices, in a buffer of its own beside an image.
GLTF = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}], "textures": [{"source": 0}], "images": [{"uri": "my%20skin.png"}],
        "buffers": [{"byteLength": 60, "uri": "data.bin"}], "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
                      {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"}]}


class Belonging(ToolTest):
    def setUp(self):
        super().setUp()
        (self.folder / "a.obj").write_text("mtllib b.mtl\n" + TETRAHEDRON)
        (self.folder / "b.mtl").write_text("newmtl m\nKd 1 0 0\nmap_Kd -s 2 2 2 my skin.png\n")
        (self.folder / "my skin.png").write_bytes(b"an image")
        self.write_scene(json.dumps({"objects": [{"mesh": "a.obj"}], "cameras": CAMERAS, "paths": PATH}))
        floats = [0, 0, 0, 1, 0, 0, 0, 1, 0] + [0, 0, 1, 0, 0, 1]
        (self.folder / "data.bin").write_bytes(struct.pack("<15f", *floats))
        (self.folder / "g.gltf").write_text(json.dumps(GLTF))
        (self.folder / "p.ply").write_text("ply\nformat ascii 1.0\ncomment TextureFile my skin.png\nelement vertex 3\nproperty float x\nproperty float y\n"
                                           "property float z\nproperty float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\n"
                                           "end_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n")
        self.has_repair = "GPL" in self.succeed("repair", "--help")

    def contents(self):
        return {str(path.relative_to(self.folder)): path.read_bytes() for path in self.folder.rglob("*") if path.is_file() and "cache" not in path.parts}

    def assert_kept(self, arguments, *parts, code=2):
        """Refused in one line that has all parts, and nothing is written."""
        before = self.contents()
        done = self.run_tool(*arguments)
        told = f"{arguments}: exit {done.returncode}, {done.stderr}"
        self.assertEqual((done.returncode, done.stderr.count("\n")), (code, 1), told)
        for part in parts:
            self.assertIn(part, done.stderr, told)
        self.assertEqual(self.contents(), before)

    def test_files_that_inputs_name_are_inputs(self):
        self.succeed("build", "a.obj", "-o", "a.olod")
        self.succeed("hlod", "build", "a.obj", "-o", "a.ohlod")
        library, image, buffer = "a material library of a.obj", "an image of ", "a buffer of g.gltf"
        for command, option, output, role in (
                (["build", "a.obj"], "--output", "b.mtl", library),
                (["build", "a.obj"], "--output", "my skin.png", image + "a.obj"),
                (["build", "p.ply"], "--output", "my skin.png", image + "p.ply"),
                (["build", "g.gltf"], "--output", "data.bin", buffer),
                (["build", "g.gltf"], "--output", "my skin.png", image + "g.gltf"),
                (["hlod", "build", "scene.json"], "--output", "b.mtl", library),
                (["hlod", "build", "g.gltf"], "--output", "data.bin", buffer),
                (["hlod", "render", "a.ohlod"], "--png", "my skin.png", image + "a.ohlod"),
                (["hlod", "render", "scene.json"], "--png", "b.mtl", library),
                (["render", "scene.json", "--budget", 9], "--birdseye", "my skin.png", image + "a.obj"),
                (["render", "scene.json", "--budget", 9], "--save-calibration", "b.mtl", library),
                (["render", "a.olod", "--budget", 9], "--png", "my skin.png", image + "a.olod"),
                (["render", "a.obj", "--budget", 9], "--mesh", "b.obj", library),
                (["cells", "build", "a.obj", "--region", "2,2,2,3,3,3"], "--output", "b.mtl", library),
                *((["repair", "a.obj"], "--output", name, library) for name in ("b.obj", "./b.OBJ") if self.has_repair)):
            if output == "./b.OBJ":
                os.link(self.folder / "b.mtl", self.folder / "same.mtl")
                output = "same.obj"
            self.assert_kept([*command, option, output], f"{option}: would overwrite ", f"which is {role}", "name another file")

    def test_frames_are_outputs(self):
        (self.folder / "my skin.png").rename(self.folder / "view_00001.png")
        (self.folder / "b.mtl").write_text("newmtl m\nmap_Kd view_00001.png\n")
        for command in (["render", "scene.json", "--budget", 9], ["hlod", "render", "scene.json"]):
            self.assert_kept([*command, "--path", "p", "--png", "view.png"], "--png: would overwrite view_00001.png", "which is an image of a.obj")

    def test_parts_are_outputs(self):
        cells = ["cells", "build", "a.obj", "--region", "2,2,2,3,3,3", "--work", "work"]
        self.succeed(*cells, "-o", "a.vlod")
        part = next((self.folder / "work").iterdir())
        (self.folder / "part.vlod").symlink_to(f"work/{part.name}")
        self.assert_kept([*cells, "-o", "part.vlod"], "--work: would overwrite ", "which --output writes")
        part.unlink()
        part.symlink_to("../b.mtl")  # what is no part would be built again
        self.assert_kept([*cells, "-o", "b.vlod"], "--work: would overwrite ", "which is a material library of a.obj")

    def test_images_beside_a_mesh_are_outputs(self):
        """Their names are known only when the mesh has been read."""
        if not self.has_repair:
            self.skipTest("built without CGAL")
        gltf = dict(GLTF, buffers=[{"byteLength": 60, "uri": "x_0.png"}], images=[{"uri": "data:image/png;base64,iVBORw0KGgo="}])
        (self.folder / "data.bin").rename(self.folder / "x_0.png")
        (self.folder / "g.gltf").write_text(json.dumps(gltf))
        self.assert_kept(["repair", "g.gltf", "-o", "x.obj"], "x_0.png: would be overwritten, but is a buffer of g.gltf", code=1)
        self.assert_kept(["repair", "g.gltf", "-o", "x.ply"], "x_0.png: would be overwritten, but is a buffer of g.gltf", code=1)

    def test_other_files_are_still_replaced(self):
        for name in ("c.mtl", "c.obj", "c.olod"):
            (self.folder / name).write_text("old")
        self.succeed("build", "a.obj", "-o", "c.olod")
        self.succeed("cut", "c.olod", "--error", 0, "-o", "c.obj")
        self.assertNotIn(b"old", (self.contents()["c.mtl"], self.contents()["c.obj"], self.contents()["c.olod"]))

    def test_a_mesh_and_its_materials_appear_together(self):
        """A limit of file sizes, which ends a write as a full disk does, lets the material library through and not the mesh."""
        rows = "".join(f"v {i} {j} {i * j % 3}\n" for i in range(21) for j in range(21))
        faces = "".join(f"f {i * 21 + j + 1} {i * 21 + j + 22} {i * 21 + j + 23}\n" for i in range(20) for j in range(20))
        for color in ("red", "blue"):
            (self.folder / "g.mtl").write_text(f"newmtl {color}\nKd 1 0 0\n")
            (self.folder / "g.obj").write_text(f"mtllib g.mtl\n{rows}usemtl {color}\n{faces}")
            self.succeed("build", "g.obj", "-o", f"{color}.olod")
        self.succeed("cut", "red.olod", "--error", 0, "-o", "x.obj")
        before = self.contents()
        for output in ("x.obj", "new.obj"):
            done = subprocess.run(["bash", "-c", f"ulimit -f 1; exec {OCCLOD} cut blue.olod --error 0 -o {output}"], cwd=self.folder, capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
            self.assertEqual(self.contents(), before)

    def test_frames_appear_together(self):
        """The last frame cannot be written: what is there stays, hidden files go."""
        large = dict(PATH["p"]["keys"][0], width=64, height=48)
        self.write_scene(json.dumps({"objects": [{"mesh": "a.obj"}], "cameras": CAMERAS, "paths": {"p": {"frames": 3, "jump": True, "keys": [large, large, dict(large, eye=[0, 0, 1.5])]}}}))
        frames = ["render", "scene.json", "--budget", 9, "--path", "p", "--texture", "none", "--png"]
        self.succeed(*frames, "size.png")
        sizes = [(self.folder / f"size_0000{i}.png").stat().st_size for i in range(3)]
        (self.folder / "view_00000.png").write_text("old")
        before = self.contents()
        limit = max(sizes[:2]) // 1024 + 1
        if limit * 1024 >= sizes[2]:
            self.skipTest("the frames are alike")
        done = subprocess.run(["bash", "-c", f"ulimit -f {limit}; exec {OCCLOD} {' '.join(map(str, frames))} view.png"], cwd=self.folder, env=self.environment, capture_output=True, text=True)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("view_00002.png: cannot be written", done.stderr)
        self.assertEqual(self.contents(), before)


class Replacing(ToolTest):
    def export(self, *options):
        return ["tiles", "planet.ohlod", "-o", "tiles", *options]

    def setUp(self):
        super().setUp()
        self.make_planet()
        self.succeed("hlod", "build", "planet.ply", "-o", "planet.ohlod", "--node-triangles", 64, "--grouping", "nested", "--borders", "free")
        self.succeed(*self.export("--tiles-per-file", 8))

    def test_files_of_others_stay(self):
        for name in ("mine.txt", "tiles/mine.txt", "tiles/0/mine.glb", "tiles/0/99999.glb", "textures/0.png", "tileset-9999.json", "mine/a/b", "tiles/1000/0.glb"):
            file = self.folder / "tiles" / name
            made = [folder for folder in (file.parent, file.parent.parent) if not folder.exists()]
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text("mine")
            line = self.failure_of(*self.export("--replace"))
            self.assertRegex(line, r"tiles: holds [^ ]*, which is no part of the tileset of occlod there; move it elsewhere")
            self.assertEqual(file.read_text(), "mine")
            file.unlink()
            for folder in made:
                folder.rmdir()
        (self.folder / "tiles/empty").mkdir()
        self.assertIn("holds empty, which", self.failure_of(*self.export("--replace")))
        (self.folder / "tiles/empty").rmdir()
        tile = self.folder / "tiles/tiles/0/0.glb"
        tile.rename(self.folder / "elsewhere.glb")
        tile.symlink_to(self.folder / "elsewhere.glb")
        self.assertIn("holds tiles/0/0.glb, which", self.failure_of(*self.export("--replace")))
        tile.unlink()
        self.succeed(*self.export("--replace"))  # a file that is missing does no harm
        self.assertFalse(list((self.folder / "tiles").glob("tileset-*.json")))

    def test_mount_points(self):
        if subprocess.run(["unshare", "-rm", "true"], capture_output=True, check=False).returncode != 0:
            self.skipTest("SKIPPED: nothing can be mounted here")
        (self.folder / "mounted").mkdir()
        done = subprocess.run(["unshare", "-rm", "bash", "-c", f"mount -t tmpfs none mounted && exec {OCCLOD} tiles planet.ohlod -o mounted"],
                              cwd=self.folder, capture_output=True, text=True)
        if "mount:" in done.stderr:
            self.skipTest(f"SKIPPED: {done.stderr}")
        self.assertEqual((done.returncode, done.stderr), (1, "occlod: error: mounted: is a mount point, which cannot be replaced by a new folder; name a folder in it\n"))


if __name__ == "__main__":
    unittest.main(verbosity=1)
