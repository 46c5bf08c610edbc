"""Files that commands read and write: nothing that is read is overwritten and nothing is written twice, by whatever names; what cannot be written is
told before any work."""
import json
import os
import subprocess
import unittest

from tool_case import OCCLOD, ToolTest

GARBAGE = b"no mesh, no hierarchy and no scene"
NOBODY = 65534


class Files(ToolTest):
    def setUp(self):
        super().setUp()
        self.make_hierarchy()
        self.write_scene(json.dumps({"objects": [{"mesh": "planet.olod"}], "cameras": {"default": {"eye": [0, 0, 3], "target": [0, 0, 0]}},
                                     "paths": {"p": {"frames": 3, "keys": [{"eye": [0, 0, 3], "target": [0, 0, 0], "width": 16, "height": 12}]}}}))
        self.json_of("render", "scene.json", "--budget", 100, "--save-calibration", "calibration.json")
        (self.folder / "sub").mkdir()

    def names_and_bytes(self):
        return {path.relative_to(self.folder): path.read_bytes() for path in self.folder.rglob("*") if path.is_file() and "cache" not in path.parts}

    def assert_refused(self, arguments, code, *parts):
        """Nothing is written; one line that has all parts and says what to do."""
        before = self.names_and_bytes()
        done = self.run_tool(*arguments)
        told = f"{arguments}: exit {done.returncode}, {done.stderr}"
        self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (code, "", 1), told)
        for part in (*parts, "; "):
            self.assertIn(part, done.stderr, told)
        self.assertEqual(self.names_and_bytes(), before)

    def other_names(self, name):
        """Of the same file: by another way, through a link, through a link to a link's folder, by a hard link."""
        extension = name.split(".")[-1]
        os.symlink(name, self.folder / f"link.{extension}")
        os.symlink("..", self.folder / "sub" / "up")
        os.link(self.folder / name, self.folder / f"hard.{extension}")
        names = [name, f"./{name}", f"sub/../{name}", str(self.folder / name), f"link.{extension}", f"sub/up/{name}", f"hard.{extension}"]
        yield from names
        for link in (f"link.{extension}", "sub/up", f"hard.{extension}"):
            (self.folder / link).unlink()

    def test_what_is_read_is_not_overwritten(self):
        render = ["render", "--budget", 100]
        for name, command, option in (
                ("planet.ply", ["build", "planet.ply"], "--output"),
                ("planet.ply", ["hlod", "build", "planet.ply"], "--output"),
                ("scene.json", ["hlod", "build", "planet.ply", "scene.json"], "--output"),
                ("planet.olod", ["hlod", "build", "scene.json"], "--output"),
                ("planet.ply", ["hlod", "render", "planet.ply"], "--png"),
                ("scene.json", ["hlod", "render", "planet.ply", "--scene", "scene.json"], "--png"),
                ("planet.ply", [*render, "planet.ply"], "--png"),
                ("planet.ply", [*render, "planet.ply"], "--mesh"),
                ("planet.olod", [*render, "planet.olod"], "--png"),
                ("planet.olod", [*render, "scene.json"], "--png"),
                ("planet.olod", [*render, "scene.json"], "--save-calibration"),
                ("scene.json", [*render, "scene.json"], "--birdseye"),
                ("scene.json", [*render, "scene.json"], "--save-calibration"),
                ("calibration.json", [*render, "scene.json", "--calibration", "calibration.json"], "--save-calibration")):
            for other in self.other_names(name):
                self.assert_refused([*command, option, other], 2, f"{option}: would overwrite {other}, which is ", "name another file")

    def test_meshes_are_not_written_onto_themselves(self):
        """An extension decides what is read and written, so the hierarchy has a mesh's name through a link."""
        os.symlink("planet.olod", self.folder / "planet.off")
        self.assert_refused(["cut", "planet.olod", "--triangles", 500, "-o", "planet.off"], 2, "--output: would overwrite planet.off, which is ")
        if "GPL" in self.succeed("repair", "--help"):
            self.assert_refused(["repair", "planet.ply", "-o", "./planet.ply"], 2, "--output: would overwrite ./planet.ply, which is ")

    def test_nothing_is_written_twice(self):
        render = ["render", "planet.olod", "--budget", 100, "--png"]
        os.symlink("new.png", self.folder / "link.png")  # leads to nothing yet
        for other in ("new.png", "./new.png", "sub/../new.png", "link.png", str(self.folder / "new.png")):
            self.assert_refused([*render, "new.png", "--birdseye", other], 2, f"--birdseye: would overwrite {other}, which --png writes")
        os.symlink("new.png", self.folder / "link.ply")
        self.assert_refused([*render, "new.png", "--mesh", "link.ply"], 2, "--mesh: would overwrite link.ply, which --png writes")
        self.assert_refused(["render", "scene.json", "--budget", 100, "--path", "p", "--png", "a.png", "--save-calibration", "a_00002.png"], 2,
                            "--png: would overwrite a_00002.png, which --save-calibration writes")

    def test_other_files_are_replaced(self):
        """As before: what is neither read nor written by another option."""
        for name in ("old.olod", "old.png", "old.ply"):
            (self.folder / name).write_bytes(GARBAGE)
        self.succeed("build", "planet.ply", "-o", "old.olod")
        self.assertTrue(self.same_bytes("old.olod", "planet.olod"))
        self.succeed("render", "planet.olod", "--budget", 100, "--png", "old.png", "--mesh", "old.ply")
        self.assertNotIn(GARBAGE, ((self.folder / "old.png").read_bytes(), (self.folder / "old.ply").read_bytes()))

    def outputs(self):
        """Each command reads garbage: had it begun its work, it would complain about that."""
        for name in ("bad.ply", "bad.olod", "bad.ohlod"):
            (self.folder / name).write_bytes(GARBAGE)
        yield from ((["build", "bad.ply"], "--output", "olod"), (["cut", "bad.olod", "--error", 0], "--output", "ply"),
                    (["generate", "rough-planet", "level=11"], "--output", "ply"), (["render", "bad.olod"], "--png", "png"),
                    (["render", "bad.olod"], "--birdseye", "png"), (["render", "bad.ply"], "--mesh", "obj"),
                    (["render", "bad.ply"], "--save-calibration", "json"), (["hlod", "render", "bad.ohlod"], "--png", "png"))
        if "GPL" in self.succeed("repair", "--help"):
            yield ["repair", "bad.ply"], "--output", "off"

    def test_what_cannot_be_written_is_told_first(self):
        for command, option, extension in self.outputs():
            (self.folder / f"folder.{extension}").mkdir(exist_ok=True)
            os.symlink(f"circle.{extension}", self.folder / f"circle.{extension}")
            os.symlink(f"nowhere/a.{extension}", self.folder / f"astray.{extension}")
            for name, problem in ((f"nowhere/a.{extension}", "the folder nowhere does not exist"), (f"folder.{extension}", "is a folder"),
                                  (f"circle.{extension}", "is a symbolic link that leads back to itself"), (f"astray.{extension}", "the folder nowhere does not exist"),
                                  ("a" * 252 + "." + extension, "the name is too long")):
                self.assert_refused([*command, option, name], 1, f"occlod: error: {name}: {problem}")
            self.assert_refused([*command, option, ""], 2, f'{option}: "" is not a name')
            for link in ("circle", "astray"):
                (self.folder / f"{link}.{extension}").unlink()

    def test_formats_that_are_not_written_are_told_first(self):
        for command, option, extension in self.outputs():
            if extension in ("ply", "obj", "off"):
                for name in ("a.xyz", "a", "a.gltf"):
                    self.assert_refused([*command, option, name], 1, f"occlod: error: {name}: ")

    def test_folders_that_cannot_be_written_are_told_first(self):
        def drop():
            if os.getuid() == 0:
                os.setgroups([])
                os.setgid(NOBODY)
                os.setuid(NOBODY)
        self.folder.chmod(0o755)
        for command, option, extension in self.outputs():
            try:
                done = subprocess.run([OCCLOD, *map(str, command), option, f"sub/a.{extension}"], cwd=self.folder, capture_output=True, text=True, preexec_fn=drop)
            except (PermissionError, subprocess.SubprocessError) as error:
                self.skipTest(f"SKIPPED: cannot run {OCCLOD} as another user: {error}")
            self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
            self.assertIn(f"sub/a.{extension}: cannot be written: Permission denied", done.stderr)

    def test_links_are_followed(self):
        """As by redirections of the shell: what the link leads to is written, and made where it does not exist."""
        os.symlink("sub/new.olod", self.folder / "link.olod")
        for _ in range(2):
            self.succeed("build", "planet.ply", "-o", "link.olod")
            self.assertTrue((self.folder / "link.olod").is_symlink())
            self.assertFalse((self.folder / "sub" / "new.olod").is_symlink())
            self.assertTrue(self.same_bytes("sub/new.olod", "planet.olod"))

    def test_long_names(self):
        """As long as file systems take."""
        name = "a" * 250 + ".olod"
        self.succeed("build", "planet.ply", "-o", name)
        self.assertTrue(self.same_bytes(name, "planet.olod"))


if __name__ == "__main__":
    unittest.main(verbosity=1)
