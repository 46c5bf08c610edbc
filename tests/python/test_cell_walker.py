"""Walking through files of view cells: what each frame has, how long it lives, what is refused."""
import gc
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import threading
import unittest

import numpy
import occlod
from support import box_of_charts, looks, planet

EYES = occlod.EyeModel(focal_length_px=100, cos_corner_angle=0.5, near=0.05)
WAY = [(-1.4 + 0.07 * i, 0.3, 2.0) for i in range(41)]


def surface_of(frame, i):
    """As a mesh with a vertex for each wedge."""
    triangles = frame.triangles(i)
    return occlod.Mesh(frame.positions(i), triangles, colors=frame.colors(i), texture_coordinates=frame.texture_coordinates(i),
                       triangle_materials=frame.wedge_materials(i)[triangles[:, 0]], materials=frame.materials(i), textures=frame.textures(i))


def words(array):
    return numpy.ascontiguousarray(array, numpy.float32).view(numpy.uint32).astype(numpy.uint64)


def hash_of(frame):
    """As `occlod cells walk --json` has it: the sum over all triangles of what their corners give, in any order."""
    total = numpy.uint64(0)
    with numpy.errstate(over="ignore"):
        for i in range(len(frame)):
            corners = words(frame.positions(i))[frame.triangles(i)].reshape(-1, 9)
            h = numpy.full(len(corners), 14695981039346656037 + i, numpy.uint64)
            for k in range(9):
                h = (h ^ corners[:, k]) * numpy.uint64(1099511628211)
            total += (h ^ (h >> numpy.uint64(32))).sum(dtype=numpy.uint64)
    return f"{int(total):016x}"


def walk_by_hand(walker, eyes=WAY, seconds=1 / 60):
    """All that is wanted is loaded after each frame, as `occlod cells walk` does."""
    for eye in eyes:
        frame = walker.step(eye, seconds)
        walker.load()
        yield frame


class Walking(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        mesh = occlod.generate("rough-planet", level=5)
        colors = numpy.full((len(mesh.positions), 4), (1, 2, 3, 255), numpy.uint8)
        cls.hierarchy = occlod.build_hierarchy(occlod.Mesh(mesh.positions, mesh.triangles, colors=colors))
        cls.objects = [occlod.Object(cls.hierarchy), occlod.Object(cls.hierarchy, transform=numpy.diag([0.5, 0.5, 0.5, 1]), two_sided=True)]
        region = occlod.CellBox((-1.5, -0.5, 1.75), (1.5, 0.5, 2.25))
        options = occlod.CellTreeOptions([region], cell=occlod.CellOptions(eyes=EYES, tolerance_px=0.5), root_cell=0.5, smallest_cell=0.5)
        cls.cells, cls.packed = cls.folder / "cells.vlod", cls.folder / "packed.vlod"
        occlod.CellBuild(cls.objects, options).write(cls.cells)
        occlod.VlodFile(cls.cells, cls.objects).pack(cls.packed)

    def test_draws_the_cut_of_each_cell(self):
        file = occlod.VlodFile(self.cells, self.objects)
        walker = occlod.CellWalker(file, loaders=0)
        crossed = 0
        for eye, frame in zip(WAY, walk_by_hand(walker)):
            self.assertEqual(frame.cell, file.leaf_of(eye))
            crossed += frame.crossed
            if frame.late:
                continue
            cut = file.cut(frame.cell)
            self.assertEqual((frame.shown, len(frame)), (frame.cell, 2))
            self.assertEqual(frame.drawn_triangles, cut.drawn_triangles)
            for i in range(2):
                self.assertEqual(sorted(map(tuple, frame.triangles(i).tolist())), sorted(map(tuple, cut.triangles(i).tolist())))
                numpy.testing.assert_array_equal(frame.positions(i), self.hierarchy.positions)
                numpy.testing.assert_array_equal(frame.transform(i), self.objects[i].transform)
        self.assertGreater(crossed, 3)

    def test_packed_files_draw_the_same_without_objects(self):
        self.assertTrue(occlod.VlodFile(self.packed).is_packed)
        self.assertFalse(occlod.VlodFile(self.cells).is_packed)
        with_hierarchies = occlod.CellWalker(self.cells, self.objects, loaders=0)
        for a, b in zip(walk_by_hand(with_hierarchies), walk_by_hand(occlod.CellWalker(self.packed, loaders=0)), strict=True):
            for name in ("cell", "shown", "outside", "crossed", "changed", "late", "missing", "drawn_triangles"):
                self.assertEqual(getattr(a, name), getattr(b, name), name)
            self.assertEqual(hash_of(a), hash_of(b))
            for i in range(2):
                self.assertLess(len(b.positions(i)), len(self.hierarchy.positions))
                self.assertEqual(b.colors(i).tolist(), [[1, 2, 3, 255]] * len(b.positions(i)))
                self.assertEqual((b.normals(i).shape, a.normals(i).shape), ((0, 3), (0, 3)))
                numpy.testing.assert_array_equal(a.transform(i), b.transform(i))

    def test_frames_have_textures_and_materials(self):
        box = box_of_charts(texture_origin=occlod.TextureOrigin.top_left).clean()[0]
        hierarchy, plain = occlod.build_hierarchy(box, base_triangles=12), self.hierarchy
        self.assertGreater(hierarchy.wedge_count, hierarchy.vertex_count)
        objects = [occlod.Object(plain, transform=numpy.diag([0.5, 0.5, 0.5, 1])), occlod.Object(hierarchy)]
        region = occlod.CellBox((1.5, -2.5, -0.5), (2.5, -1.5, 0.5))  # sees an even and an odd side
        options = occlod.CellTreeOptions([region], cell=occlod.CellOptions(eyes=EYES, tolerance_px=0.5), root_cell=0.5, smallest_cell=0.5)
        cells, packed = self.folder / "box.vlod", self.folder / "packed_box.vlod"
        occlod.CellBuild(objects, options).write(cells)
        occlod.VlodFile(cells, objects).pack(packed)
        file, there = occlod.VlodFile(cells, objects), 0
        walks = [walk_by_hand(occlod.CellWalker(*arguments, loaders=0), [(1.6 + 0.05 * i, -1.9, 0.2) for i in range(16)])
                 for arguments in ((cells, objects), (packed,))]
        for frames in zip(*walks, strict=True):
            for frame in frames:
                self.assertEqual((frame.texture_coordinates().shape, frame.wedge_materials().shape), ((0, 2), (0,)))
                self.assertEqual((frame.materials(), frame.textures()), ((), ()))
                self.assertEqual((frame.materials(1), frame.textures(1)), (box.materials, box.textures))
                self.assertEqual(frame.texture_origin(1), occlod.TextureOrigin.top_left)
                self.assertEqual(frame.texture_coordinates(1).shape, (len(frame.positions(1)), 2))
                self.assertFalse(frame.texture_coordinates(1).flags.writeable or frame.texture_coordinates(1).flags.owndata)
                self.assertEqual(frame.wedge_materials(1).dtype, numpy.uint16)
            seen = [surface_of(frame, 1) for frame in frames]
            self.assertEqual(looks(seen[1]), looks(seen[0]))
            if not frames[0].late:
                # What the cut of the cell says without a walk.
                self.assertEqual(looks(seen[0]), looks(file.cut(frames[0].cell).mesh(1)))
                self.assertEqual({"odd", "even"}, {box.materials[m].name for m in seen[0].triangle_materials})
                there += 1
        self.assertGreater(there, 3)
        with self.assertRaises(IndexError):
            frames[0].texture_coordinates(2)
        with self.assertRaises(IndexError):
            frames[0].materials(2)

    @unittest.skipUnless("OCCLOD" in os.environ, "SKIPPED: there is no command line beside the package")
    def test_draws_what_the_command_line_draws(self):
        self.hierarchy.write(self.folder / "planet.olod")
        camera = {"up": [0, 0, 1], "near": 0.05, "far": 9, "width": 64, "height": 48}
        keys = [{"eye": list(eye), "target": [eye[0] + 1, 0, 0], **camera} for eye in (WAY[0], WAY[-1])]
        scene = {"objects": [{"mesh": "planet.olod"}, {"mesh": "planet.olod", "matrix": [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1], "two_sided": True}],
                 "cameras": {"default": keys[0]}, "paths": {"along": {"frames": len(WAY), "keys": keys}}}
        (self.folder / "scene.json").write_text(json.dumps(scene), encoding="utf-8")
        eyes = [camera.eye for camera in occlod.Scene.read(self.folder / "scene.json").paths["along"]]
        for cells, walker in ((self.cells, occlod.CellWalker(self.cells, self.objects, loaders=0)), (self.packed, occlod.CellWalker(self.packed, loaders=0))):
            told = subprocess.run([os.environ["OCCLOD"], "cells", "walk", cells, self.folder / "scene.json", "--path", "along", "--json"],
                                  capture_output=True, text=True, check=True)
            frames = json.loads(told.stdout)["frame"]
            for expected, frame in zip(frames, walk_by_hand(walker, eyes), strict=True):
                self.assertEqual(hash_of(frame), expected["hash"])
                for name in ("cell", "shown", "outside", "crossed", "changed", "late", "missing", "error_px", "loads", "bytes_read", "resident_bytes"):
                    self.assertEqual(getattr(frame, name), expected[name], f"frame {expected['frame']}: {name}")
                self.assertEqual(frame.drawn_triangles, expected["triangles"])

    def test_loads_ahead_in_threads(self):
        walker = occlod.CellWalker(self.packed, loaders=2)
        late = 1
        for _ in range(10_000):
            late = walker.step(WAY[0], 1 / 60).late
            if not late:
                break
        self.assertFalse(late)
        frame = walker.step((9, 9, 9), 1 / 60)
        self.assertTrue(frame.outside and frame.crossed)
        self.assertGreater(frame.drawn_triangles, 0)
        self.assertEqual(walker.load(0), 0)

    def test_frames_stay_as_they_are(self):
        walker = occlod.CellWalker(self.packed, loaders=0)
        held = [(frame, hash_of(frame)) for frame in walk_by_hand(walker)]
        arrays = [frame.triangles() for frame, _ in held]
        copies = [array.copy() for array in arrays]
        self.assertEqual([hash_of(frame) for frame, _ in held], [text for _, text in held])
        self.assertGreater(len({text for _, text in held}), 4)
        self.assertFalse(arrays[0].flags.writeable or arrays[0].flags.owndata)
        del walker, held
        gc.collect()
        for array, copy in zip(arrays, copies):
            numpy.testing.assert_array_equal(array, copy)

    def test_memory_is_kept_and_told(self):
        with self.assertRaisesRegex(occlod.Error, r"what all cells have in common needs \d+"):
            occlod.CellWalker(self.packed, memory=1)
        whole = max(frame.resident_bytes for frame in walk_by_hand(occlod.CellWalker(self.packed, loaders=0)))
        frames = list(walk_by_hand(occlod.CellWalker(self.packed, memory=whole // 3, loaders=0)))
        self.assertLessEqual(max(frame.resident_bytes for frame in frames), whole // 3)
        notes = [line for frame in frames for line in frame.notes]
        self.assertEqual(all(not frame.missing for frame in frames), not notes, notes)

    def test_frustum_and_pictures(self):
        walker = occlod.CellWalker(self.packed, loaders=0)
        list(walk_by_hand(walker, WAY[:2]))
        frame = walker.step(WAY[1], 0)
        camera = occlod.Camera(eye=WAY[1], target=(3, 0.3, 0.5), width=64, height=64, fov_y_deg=30, near=0.05, far=9)
        ranges = frame.ranges_in_view(camera)
        self.assertTrue(0 < ranges[:, 2].sum() < frame.drawn_triangles)
        parts = [occlod.DrawObject(frame.positions(i), frame.triangles(i)[first : first + count], transform=frame.transform(i)) for i, first, count in ranges.tolist()]
        numpy.testing.assert_array_equal(occlod.draw_items(parts, camera).nearness, occlod.draw_items(frame.draw_objects(), camera).nearness)

    def test_damage_is_a_note_and_ancestors_are_drawn(self):
        good = bytearray(self.packed.read_bytes())
        good[-1] ^= 1
        bad = self.folder / "bad.vlod"
        bad.write_bytes(good)
        walker = occlod.CellWalker(bad, loaders=0)
        notes, missing = [], 0
        for eye in WAY[::3]:
            for frame in walk_by_hand(walker, [eye] * 40, 0.1):
                notes += frame.notes
                self.assertGreater(frame.drawn_triangles, 0)
            missing += frame.missing
        self.assertGreater(missing, 0)
        self.assertRegex(notes[0], r"bad.vlod: frame \d+: is damaged: its checksum is wrong.*trying again in a second")

    def test_threads_take_turns(self):
        walker = occlod.CellWalker(self.packed)
        wrong = []

        def go():
            for eye in WAY * 20:
                frame = walker.step(eye, 1 / 60)
                if frame.triangles().max() >= len(frame.positions()):
                    wrong.append(frame.cell)

        threads = [threading.Thread(target=go) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])

    def test_wrong_use_is_told(self):
        with self.assertRaisesRegex(occlod.Error, "has no objects"):
            occlod.CellWalker(self.cells)
        with self.assertRaisesRegex(occlod.Error, "has changed"):
            occlod.CellWalker(self.cells, [planet(3)[1]] * 2)
        with self.assertRaises(TypeError):
            occlod.CellWalker(occlod.VlodFile(self.packed), self.objects)
        with self.assertRaises(TypeError):
            occlod.CellWalker(7)
        with self.assertRaisesRegex(occlod.Error, "nowhere"):
            occlod.CellWalker(self.folder / "nowhere.vlod")
        with self.assertRaisesRegex(occlod.Error, "loaders"):
            occlod.CellWalker(self.packed, loaders=65)
        walker = occlod.CellWalker(self.packed)
        for eye, seconds in (((0, 0, float("nan")), 0), ((0, 0, 0), -1), ((0, 0, 0), float("inf"))):
            with self.assertRaises(ValueError):
                walker.step(eye, seconds)
        with self.assertRaises(TypeError):
            walker.step((0, 0), 0)
        with self.assertRaises(IndexError):
            walker.step((0, 0, 2), 0).triangles(2)
        with self.assertRaises(ValueError):
            occlod.VlodFile(self.cells).pack(self.folder / "x.vlod")
        self.assertFalse((self.folder / "x.vlod").exists())

    def test_ten_thousand_steps_leave_nothing(self):
        walker = occlod.CellWalker(self.packed, loaders=0)

        def run(steps):
            for step in range(steps):
                frame = walker.step(WAY[step % 40], 1 / 60)
                frame.triangles(), frame.positions(1), frame.colors(), frame.notes, frame.draw_objects()
                walker.load(1)

        run(1000)  # until all that is wanted is there
        gc.collect()
        before = sys.getallocatedblocks(), walker.step(WAY[0], 0).resident_bytes, resident_set()
        run(10_000)
        gc.collect()
        after = sys.getallocatedblocks(), walker.step(WAY[0], 0).resident_bytes, resident_set()
        self.assertLess(after[0] - before[0], 100)
        self.assertEqual(after[1], before[1])
        # One frame with its vertices lost in a hundred would be 2 MB.
        self.assertLess(after[2] - before[2], 1_000_000)

    def test_nothing_is_left_at_the_end(self):
        code = f"import occlod; w = occlod.CellWalker({str(self.packed)!r}); f = w.step((0, 0, 2), 0); t = f.triangles(); d = f.draw_objects()"
        ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=pathlib.Path(__file__).parent)
        self.assertEqual(ended.stderr, "")


def resident_set():
    return int(pathlib.Path("/proc/self/statm").read_text(encoding="utf-8").split()[1]) * os.sysconf("SC_PAGE_SIZE")


if __name__ == "__main__":
    unittest.main()
