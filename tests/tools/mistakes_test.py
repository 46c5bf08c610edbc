"""Wrong use of the built command `occlod`, bad inputs, and what its help says."""
import os
import pathlib
import subprocess
import unittest

from tool_case import OCCLOD, ToolTest

SCENES = pathlib.Path(os.environ["SCENES"])


class Mistakes(ToolTest):
    def test_bad_inputs(self):
        (self.folder / "empty.ply").write_bytes(b"")
        (self.folder / "text.olod").write_text("not a hierarchy")
        (self.folder / "nan.obj").write_text("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        (self.folder / "what.xyz").write_text("1 2 3\n")
        for subject, arguments in [
            ("none.ply", ["build", "none.ply", "-o", "a.olod"]),
            ("empty.ply", ["build", "empty.ply", "-o", "a.olod"]),
            ("nan.obj", ["build", "nan.obj", "-o", "a.olod"]),
            ("what.xyz", ["build", "what.xyz", "-o", "a.olod"]),
            ("none.olod", ["info", "none.olod"]),
            ("text.olod", ["info", "text.olod"]),
            ("text.olod", ["validate", "text.olod", "--json"]),
            ("none.json", ["render", "none.json"]),
            ("none.ply", ["render", "none.ply"]),
            ("text.olod", ["render", "text.olod"]),
            ("city", ["generate", "city", "blocks=256", "facade_cells=256", "-o", "a.ply"]),
            ("nowhere", ["generate", "rough-planet", "level=1", "-o", "nowhere/a.ply"]),
        ]:
            self.assertIn(subject, self.failure_of(*arguments))
        self.assertFalse((self.folder / "a.olod").exists())

    def test_truncated_hierarchy(self):
        self.make_hierarchy()
        data = (self.folder / "planet.olod").read_bytes()
        for size in (0, 7, len(data) // 2, len(data) - 1):
            (self.folder / "cut.olod").write_bytes(data[:size])
            self.assertIn("cut.olod", self.failure_of("info", "cut.olod"))

    def test_scene_mistakes_name_file_and_place(self):
        self.write_scene("""{"objects": [{"generator": "rough-planet", "scale": "big"}],
                             "cameras": {"default": {"eye": [0, 0, 3], "target": [0, 0, 0]}}}""")
        self.assertIn("scene.json: /objects/0/scale", self.failure_of("render", "scene.json"))

    # One line that names the file, the place and what to do.
    def test_what_is_no_scene_and_what_a_scene_lacks(self):
        self.assertIn(".: is a folder; name a scene", self.failure_of("render", "."))
        camera = """{"eye": [0, 0, 3], "target": [0, 0, 0]}"""
        self.write_scene("""{"objects": [{"mesh": "none.ply"}], "cameras": {"default": %s}}""" % camera)
        (self.folder / "scene.json").rename(self.folder / "scene.JSON")
        line = self.failure_of("render", "scene.JSON")
        for part in ("scene.JSON: /objects/0/mesh: there is no file none.ply; searched: ., ", str(self.folder / "data/occlod/meshes"), "OCCLOD_MESHES"):
            self.assertIn(part, line)
        self.write_scene("""{"objects": [{"generator": "rough-planet"}], "cameras": {"default": %s},
                             "paths": {"p": {"frames": 3, "keys": [%s, {"eye": [0, 0, -3], "target": [0, 0, 0]}]}}}""" % (camera, camera))
        line = self.failure_of("render", "scene.json", "--path", "p")
        for part in ("scene.json: /paths/p: ", "frame 1 of 3", "add a key"):
            self.assertIn(part, line)

    def test_render_mistakes(self):
        self.make_hierarchy()
        self.failure_of("render", "planet.olod", "--budget", "1")
        self.write_scene("""{"objects": [{"mesh": "planet.olod"}], "cameras": {"default": {"eye": [0, 0, 3], "target": [0, 0, 0]}}}""")
        self.assertIn("default", self.failure_of("render", "scene.json", "--camera", "other"))

    def test_output_that_cannot_be_written(self):
        self.make_planet()
        with open("/dev/full", "w") as full:
            done = subprocess.run([OCCLOD, "build", "planet.ply", "-o", "a.olod", "--json"], cwd=self.folder, stdout=full,
                                  stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 1)

    def test_wrong_use(self):
        for arguments in [[], ["paint"], ["build"], ["build", "a.ply"], ["info", "a", "b"], ["generate"], ["generate", "rough-planet"],
                          ["render"], ["render", "x", "--budget", "many"], ["render", "x", "--occlusion", "magic"],
                          ["render", "x", "--culling", "star"], ["render", "x", "--size", "0x3"], ["render", "x", "--size", "3"],
                          ["render", "x", "--repeat", "0"], ["render", "x", "--colour"], ["render", "x", "--path", "p", "--camera", "c"],
                          ["render", "x", "--path", "p", "--birdseye", "b.png"], ["render", "x", "--path", "p", "--mesh", "m.ply"],
                          ["render", "x", "--path", "p", "--reference"], ["render", "x", "--frame-to-frame"],
                          ["render", "x", "--path", "p", "--frame-to-frame", "--repeat", "2"],
                          *(["render", "x", "--path", "p", option, "0"]
                            for option in ("--max-changes", "--time-limit", "--geomorph-frames")),
                          *(["render", "x", "--path", "p", "--frame-to-frame", *option]
                            for option in (["--max-changes", "-1"],
                                           ["--time-limit", "-1"], ["--geomorph-frames", "x"]))]:
            done = self.run_tool(*arguments)
            self.assertEqual(done.returncode, 2, f"{arguments}: {done.stderr}")
            self.assertEqual(done.stdout, "")
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertIn("--help", done.stderr)

    def test_help_and_version(self):
        self.assertRegex(self.succeed("--version"), r"^\d+\.\d+\.\d+\n$")
        for command in ([], ["generate"], ["build"], ["info"], ["validate"], ["render"], ["cut"], ["hlod"],
                        ["hlod", "build"], ["hlod", "info"], ["hlod", "validate"], ["hlod", "render"], ["tiles"]):
            self.assertIn("Usage", self.succeed(*command, "--help"))

    def test_help_is_for_people(self):
        """Lines that fit, no types of the implementation, and what conservative mode promises."""
        for command in (["generate"], ["build"], ["info"], ["validate"], ["render"], ["cut"], ["compare"], ["repair"],
                        ["hlod"], ["hlod", "build"], ["hlod", "info"], ["hlod", "validate"], ["hlod", "render"], ["tiles"]):
            text = self.succeed(*command, "--help")
            self.assertLessEqual(max(map(len, text.splitlines())), 100, text)
            self.assertNotRegex(text, r"\b(U?INT|FLOAT|TEXT|ENUM|NONNEGATIVE|POSITIVE|value in)\b|->|\{")
        self.assertIn("hides nothing that the full mesh shows", " ".join(self.succeed("render", "--help").split()))

    def test_wrong_use_names_what_was_typed(self):
        for arguments, told in ((["paint"], 'no command "paint"'), (["generate", "torus", "-o", "a.ply"], '"torus" is not one of rough-planet, city'), ([], "a command is missing"),
                                (["--paint"], 'no option "--paint"'), (["render", "x", "--budge", 5, "y"], 'no option "--budge"'),
                                (["info", "a", "b", "c"], 'no further argument "b"'), (["render", "x", "--budget"], "--budget needs a value"),
                                (["render", "x", "--budget", 5, "--budget", 6], "--budget is given more than once"),
                                (["build", "a.ply"], "--output is required"), (["hlod"], "a command is missing"),
                                (["render", "x", "--device", "egl"], "--device: goes with --occlusion gl-query only"), (["hlod", "paint"], 'no command "paint"'), (["hlod", "build", "a.ply"], "--output is required"), (["cut", "a.olod", "-o", "a.ply"], "--triangles or --error is required")):
            done = self.run_tool(*arguments)
            self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), done.stderr)
            self.assertIn(told, done.stderr)

    def test_what_may_be_meant(self):
        """Of commands, and of options of the command and of the program; nothing where no word is near."""
        for arguments, meant in ((["rendre", "x"], "render"), (["hlod", "bulid", "x"], "build"), (["render", "x", "--budge", 5], "--budget"), (["build", "x", "--compression=zstd"], "--compress"),
                                 (["hlod", "render", "x", "--tolerence", 1], "--tolerance"), (["cells", "walk", "x", "y", "--thread", 1], "--threads"), (["cut", "x", "--ouput", "y"], "--output"), (["info", "x", "--jsno"], "--json"),
                                 (["paint"], None), (["info", "x", "--paint"], None), (["info", "a", "ifno"], None), (["info", "x", "--" + "a" * 5000], None)):
            done = self.run_tool(*arguments)
            self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), done.stderr)
            if meant is None:
                self.assertNotIn("did you mean", done.stderr)
            else:
                self.assertIn(f"(did you mean {meant}?); see occlod", done.stderr)

    def test_outputs_are_named_as_what_they_are(self):
        """No hierarchy under the name of a mesh, no mesh under that of a picture."""
        self.make_planet()
        nested = ["hlod", "build", "planet.ply"]
        cells = ["cells", "build", "planet.ply", "--region", "2,2,2,3,3,3"]
        for arguments, name, extension in ((["build", "planet.ply", "-o"], "e.ply", ".olod"), (["build", "planet.ply", "-o"], "e", ".olod"), ([*nested, "-o"], "e.olod", ".ohlod"),
                                           ([*cells, "-o"], "e.obj", ".vlod"), (["render", "planet.ply", "--png"], "e.jpg", ".png"), (["render", "planet.ply", "--birdseye"], "e.ply", ".png"),
                                           (["hlod", "render", "planet.ply", "--png"], "e.tga", ".png")):
            done = self.run_tool(*arguments, name)
            self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), done.stderr)
            self.assertIn(f"{name} does not end in {extension}, which is what is written; name it e{extension}", done.stderr)
            self.assertEqual("by 'occlod simplify'" in done.stderr, name.endswith((".ply", ".obj")), done.stderr)
            self.assertFalse((self.folder / name).exists())

    def test_mistakes_name_the_help_of_the_command(self):
        for command in (["build"], ["generate"], ["hlod"], ["hlod", "build"]):
            self.assertIn(f"see occlod {' '.join(command)} --help", self.run_tool(*command, "--what").stderr)

    def test_missing_mesh_of_a_scene(self):
        environment = dict(self.environment)
        environment.pop("OCCLOD_MESHES", None)
        done = subprocess.run([OCCLOD, "render", SCENES / "armadillo.json"], env=environment, capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("armadillo.off", done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=1)
