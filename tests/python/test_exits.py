"""Names of any bytes, and how processes end: interpreters that exit while threads work, and what a child of fork() has of its parent."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import occlod

POINTS = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\n"
FACES = b"f 1/1 3/1 2/1\nf 1/1 2/1 4/1\nf 1/1 4/1 3/1\nf 2/1 3/1 4/1\n"
PACKED = """
import occlod
mesh = occlod.generate("rough-planet", level=4)
eyes = occlod.EyeModel(focal_length_px=100, cos_corner_angle=0.5, near=0.05)
tree = occlod.CellTreeOptions([occlod.CellBox((1.5, 0, 1.5), (2.5, 1, 2.5))], cell=occlod.CellOptions(eyes=eyes, tolerance_px=2), root_cell=1,
                              smallest_cell=0.5)
hierarchy = occlod.build_hierarchy(mesh)
occlod.CellBuild(hierarchy, tree).write("cells.vlod")
occlod.VlodFile("cells.vlod", hierarchy).pack("packed.vlod")
"""


class Exits(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_python(self, text):
        # Python 3.12 and later warn of any fork() beside threads.
        command = [sys.executable, "-W", "ignore:This process:DeprecationWarning", "-c", text]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, timeout=120, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stderr, "")
        return done.stdout

    def test_an_interpreter_may_exit_while_daemon_threads_work(self):
        for work in ("occlod.build_hierarchy(mesh)", "occlod.build_hierarchy(mesh, progress=lambda share: None)",
                     "occlod.build_hlod(mesh, progress=lambda share: time.sleep(0.001))", "[occlod.build_hierarchy(small) for _ in range(10000)]"):
            for wait in (0.02, 0.2):
                self.run_python("import occlod, threading, time\n"
                                "mesh, small = occlod.generate('rough-planet', level=7), occlod.generate('rough-planet', level=2)\n"
                                f"for _ in range(3): threading.Thread(target=lambda: {work}, daemon=True).start()\ntime.sleep({wait})")

    def test_threads_that_are_no_daemons_finish(self):
        told = self.run_python("import occlod, threading\nmesh = occlod.generate('rough-planet', level=5)\n"
                               "threading.Thread(target=lambda: print(occlod.build_hierarchy(mesh).input_triangle_count)).start()")
        self.assertEqual(told.strip(), str(8 * 4**5))

    def test_exit_handlers_may_call(self):
        told = self.run_python("import atexit\natexit.register(lambda: print(occlod.build_hierarchy(mesh, progress=lambda share: None).input_triangle_count))\n"
                               "import occlod\nmesh = occlod.generate('rough-planet', level=3)")
        self.assertEqual(told.strip(), str(8 * 4**3))

    def in_child(self, before, after):
        """Runs `after` in a child that is forked after `before`; it prints what it tells and must end within 20 s."""
        return self.run_python(PACKED + before + "\nimport os, signal, sys\nif os.fork() == 0:\n    signal.alarm(20)\n" +
                               "".join(f"    {line}\n" for line in after.splitlines()) + "    sys.stdout.flush()\n    os._exit(0)\n"
                               "status = os.wait()[1]\nassert status == 0, status\n")

    def test_a_walker_is_refused_in_a_child(self):
        refused = "try: walker.step((2, 0.5, 2), 1 / 60)\nexcept occlod.Error as error: print(error.problem)\n"
        told = self.in_child("walker = occlod.CellWalker('packed.vlod')\nwalker.step((2, 0.5, 2), 1 / 60)",
                             refused + "try: walker.load()\nexcept occlod.Error: print('no')\ndel walker\n"
                             "other = occlod.CellWalker('packed.vlod')\nfor _ in range(3): frame = other.step((2, 0.5, 2), 1 / 60)\nprint(len(frame))")
        self.assertEqual(told.splitlines(), ["was made before this process was forked, and its loaders are not here", "no", "1"])

    def test_other_objects_work_in_a_child(self):
        """Refiners have a thread beside the calling one, which the child begins anew."""
        told = self.in_child("refiner = occlod.Refiner(hierarchy)\noptions = occlod.RefineOptions(budget=400, threads=2)\n"
                             "before = refiner.refine(occlod.Camera(eye=(0, 0, 3)), options=options).stats.triangles\n",
                             "after = refiner.refine(occlod.Camera(eye=(0, 0, 3)), options=options).stats.triangles\nprint(before == after)\n"
                             "print(occlod.build_hierarchy(mesh, threads=2).input_triangle_count)")
        self.assertEqual(told.splitlines(), ["True", str(8 * 4**4)])


class Names(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = os.fsencode(folder.name)

    def path(self, name):
        return os.path.join(self.folder, name)

    def test_files(self):
        """As bytes and as os.fsdecode() has them, in and out."""
        mesh = occlod.generate("rough-planet", level=2)
        for as_given in (lambda path: path, os.fsdecode, lambda path: pathlib.Path(os.fsdecode(path))):
            mesh.write(as_given(self.path(b"m\xff.ply")))
            self.assertEqual(len(occlod.read_mesh(as_given(self.path(b"m\xff.ply"))).triangles), 128)
            occlod.build_hierarchy(mesh).write(as_given(self.path(b"\xfe.olod")))
            self.assertEqual(occlod.read_hierarchy(as_given(self.path(b"\xfe.olod"))).input_triangle_count, 128)
            with self.assertRaises(occlod.Error) as caught:
                occlod.read_mesh(as_given(self.path(b"none\xff.ply")))
            self.assertEqual(os.fsencode(caught.exception.subject), self.path(b"none\xff.ply"))

    def test_materials_and_textures(self):
        with open(self.path(b"a.obj"), "wb") as file:
            file.write(b"mtllib a.mtl\n" + POINTS + b"usemtl Stra\xdfe\n" + FACES)
        with open(self.path(b"a.mtl"), "wb") as file:
            file.write(b"newmtl Stra\xdfe\nmap_Kd Stra\xdfe.png\n")
        hierarchy = occlod.build_hierarchy(occlod.read_mesh(self.path(b"a.obj")))
        hierarchy.write(self.path(b"a.olod"))
        for holder in (occlod.read_mesh(self.path(b"a.obj")), hierarchy, occlod.read_hierarchy(self.path(b"a.olod"))):
            for name in (holder.materials[0].name, os.path.splitext(holder.textures[0].file)[0]):
                self.assertIn(name, ("Stra\udcdfe", "Straße"))
            self.assertIn("Stra", repr(holder.materials[0]) + repr(holder.textures[0]))

    def test_values_go_round(self):
        for name in ("Straße", "\udcff", "a\udc80b", "\U0010ff41", "\n\x01"):
            self.assertEqual(occlod.Material(name).name, name)
            self.assertEqual(occlod.Texture(name).file, name)
            mesh = occlod.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], materials=[occlod.Material(name)], triangle_materials=[0])
            hierarchy = occlod.build_hierarchy(mesh)
            hierarchy.write(self.path(b"m.olod"))
            self.assertEqual(occlod.read_hierarchy(self.path(b"m.olod")).materials[0].name, name)

    def test_texts_in_errors(self):
        for name, content in ((b"s.json", b'{"\xff":1}'), (b"t.json", b"\x89PNG\r\n")):
            with open(self.path(name), "wb") as file:
                file.write(content)
            with self.assertRaises(occlod.Error) as caught:
                occlod.Scene.read(self.path(name))
            self.assertNotIn("\ufffd", str(caught.exception))


if __name__ == "__main__":
    unittest.main()
