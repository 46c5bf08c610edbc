"""Drives the built command `occlod` from generating a mesh to rendering it."""
import json
import math
import re
import struct
import unittest

from tool_case import LEVEL, TRIANGLES, VERTICES, ToolTest


class GenerateBuildValidate(ToolTest):
    def test_generate_counts(self):
        result = self.make_planet()
        self.assertEqual((result["vertices"], result["triangles"]), (VERTICES, TRIANGLES))

    def test_generate_every_kind_in_every_format(self):
        for kind, options in [("rough-planet", ["level=1"]), ("city", ["blocks=1", "facade_cells=1"]),
                              ("pipes", ["pipes=1"]),
                              ("plant", ["storeys=1", "bays=1", "pipes=1", "bends=2", "sides=3"]),
                              ("spheres-behind-wall", ["spheres=1", "level=0"])]:
            for extension in ("ply", "obj", "off", "stl"):
                made = self.json_of("generate", kind, *options, "-o", f"m.{extension}")
                built = self.json_of("build", f"m.{extension}", "-o", "m.olod")
                self.assertEqual(built["triangles"], made["triangles"], f"{kind} {extension}")

    def test_generate_streams_the_same_file(self):
        for kind, options in [("rough-planet", ["level=8"]), ("plant", ["storeys=1", "bays=2"])]:
            for extension in ("ply", "obj"):
                whole = self.json_of("generate", kind, *options, "-o", f"whole.{extension}")
                streamed = self.json_of("generate", kind, *options, "-o", f"streamed.{extension}", "--stream")
                self.assertTrue(self.same_bytes(f"whole.{extension}", f"streamed.{extension}"), f"{kind} {extension}")
                for key in ("vertices", "triangles"):
                    self.assertEqual(whole[key], streamed[key])
        (self.folder / "m.off").write_text("old")
        self.assertIn("only PLY and OBJ files are written in parts", self.failure_of("generate", "city", "-o", "m.off", "--stream"))
        self.assertEqual((self.folder / "m.off").read_text(), "old")

    def test_a_mesh_that_is_streamed_is_never_whole(self):
        plant = ("generate", "plant", "storeys=2", "bays=4", "-o", "plant.ply")
        self.assertLess(2 * self.json_of(*plant, "--stream")["peak_bytes"], self.json_of(*plant)["peak_bytes"])

    def test_generate_takes_percents(self):
        """Of ratios: 8 % is 0.08; of nothing else."""
        for name, value in (("a.ply", "0.2"), ("b.ply", "20%")):
            self.succeed("generate", "rough-planet", "level=2", f"amplitude={value}", "-o", name)
        self.assertTrue(self.same_bytes("a.ply", "b.ply"))
        for setting in ("frequency=400%", "level=200%", "amplitude=100%", "amplitude=-1%"):
            self.assertEqual(self.run_tool("generate", "rough-planet", setting, "-o", "a.ply").returncode, 2, setting)

    def test_generate_is_reproducible_and_seeded(self):
        for name, seed in [("a.ply", 1), ("b.ply", 1), ("c.ply", 2)]:
            self.make_planet(name, seed)
        self.assertTrue(self.same_bytes("a.ply", "b.ply"))
        self.assertFalse(self.same_bytes("a.ply", "c.ply"))

    def test_build_reports(self):
        result = self.make_hierarchy()
        self.assert_has_keys(result, "vertices triangles base_triangles splits faces read_ms build_ms write_ms triangles_per_s "
                                     "peak_bytes bytes_per_vertex error_bound report")
        self.assertEqual((result["vertices"], result["triangles"]), (VERTICES, TRIANGLES))
        self.assertLessEqual(result["base_triangles"], 64)
        # On a closed surface each split adds exactly two triangles and one vertex.
        self.assertEqual(result["triangles"], result["base_triangles"] + 2 * result["splits"])
        self.assertEqual(result["report"]["triangles_read"], TRIANGLES)
        self.assertEqual(result["report"]["components"], 1)
        self.assertEqual(result["report"]["boundary_edges"], 0)

    def test_build_is_reproducible(self):
        self.make_planet()
        for name in ("a.olod", "b.olod"):
            self.succeed("build", "planet.ply", "-o", name)
        self.assertTrue(self.same_bytes("a.olod", "b.olod"))

    def test_build_options_are_used(self):
        self.make_planet()
        coarse = self.json_of("build", "planet.ply", "-o", "a.olod", "--base-triangles", 200)
        self.assertTrue(64 < coarse["base_triangles"] <= 200)

    def test_info_agrees_with_build(self):
        built = self.make_hierarchy()
        info = self.json_of("info", "planet.olod")
        for key in ("vertices", "triangles", "base_triangles", "splits", "faces", "bytes_per_vertex", "error_bound", "report"):
            self.assertEqual(info[key], built[key], key)
        # The planet's radius is 1, and its hills are at most 0.08 of it.
        for low, high in zip(info["box"]["min"], info["box"]["max"]):
            self.assertTrue(-1.08 <= low < -0.5 and 0.5 < high <= 1.08)

    def test_validate_accepts(self):
        self.make_hierarchy()
        self.assertEqual(self.json_of("validate", "planet.olod", "--input", "planet.ply"),
                         {"file": "planet.olod", "valid": True, "violations": [],
                          "left_out": {}})

    # Two vt lines, one vn line that no face uses, materials m and n; hierarchies have no room for the group of the object.
    def test_what_a_mesh_holds_beside_its_surface_is_counted(self):
        (self.folder / "a.obj").write_text("o a\ng b\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvn 0 0 1\n"
                                           "usemtl m\nf 1 2 3\nusemtl n\nf 2 4 3\n")
        of_file = {"undefined materials (usemtl)": 2, "unused normals (vn)": 1, "unused texture coordinates (vt)": 2}
        of_hierarchy = {"features (groups, objects, nodes)": 1, **of_file}
        in_words = lambda counts: ", ".join(f"{count} {name}" for name, count in counts.items())
        build = ["build", "a.obj", "-o", "a.olod"]
        for command, counts in ((build, of_hierarchy), (["info", "a.obj"], of_file), (["info", "a.olod"], of_hierarchy)):
            self.assertEqual(self.json_of(*command)["report"]["left_out"], counts, command)
            self.assertRegex(self.run_tool(*command).stdout, f"(?m)^left_out +{re.escape(in_words(counts))}$")
        hlod = ["hlod", "build", "a.obj", "-o", "a.ohlod", "--grouping", "nested", "--borders", "free"]
        for command in (hlod, [*hlod, "--memory", "64M"], ["hlod", "info", "a.ohlod"]):
            self.assertEqual(self.json_of(*command)["report"]["left_out"], of_file, command)
            self.assertIn(in_words(of_file), self.run_tool(*command).stdout)
        for command, counts in ((["validate", "a.olod"], of_hierarchy), (["cut", "a.olod", "--error", 0, "-o", "b.ply"], of_hierarchy),
                                (["hlod", "validate", "a.ohlod"], of_file), (["tiles", "a.ohlod", "-o", "tiles", "--replace"], of_file)):
            self.assertEqual(self.json_of(*command)["left_out"], counts, command)
            self.assertIn(in_words(counts), self.run_tool(*command).stdout)

    def test_validate_tells_another_mesh_apart(self):
        self.make_hierarchy()
        self.make_planet("other.ply", seed=2)
        done = self.run_tool("validate", "planet.olod", "--input", "other.ply", "--json")
        self.assertEqual(done.returncode, 1)
        self.assertEqual(len(json.loads(done.stdout)["violations"]), 1)

    def write_painted_grid(self):
        """A bent square of 6 x 6 cells with three materials, each with texture coordinates of its own, colours and hard normals, all with odd digits."""
        points = [(i, j) for i in range(7) for j in range(7)]
        lines = ["mtllib a.mtl"] + [f"v {i / 7} {j / 7} {(i * j) % 5 / 31} {i * 36 / 255:.4f} {j * 36 / 255:.4f} 0.2" for i, j in points]
        lines += [f"vt {i / 7 + material / 3} {j / 7}" for material in range(3) for i, j in points]
        lines += [f"vn {(i % 3 - 1) * x} {(j % 3 - 1) * x} {math.sqrt(1 - ((i % 3 - 1) ** 2 + (j % 3 - 1) ** 2) * x * x)}" for x in (0.1, 0.3) for i, j in points]
        for i in range(6):
            lines += [f"usemtl m{i // 2}"]
            for j in range(6):
                corners = [7 * x + y + 1 for x, y in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))]
                lines += ["f " + " ".join(f"{v}/{v + 49 * (i // 2)}/{v + 49 * (j // 3)}" for v in (corners[0], corners[k], corners[k + 1])) for k in (1, 2)]
        (self.folder / "a.obj").write_text("\n".join(lines))
        (self.folder / "a.mtl").write_text("".join(f"newmtl m{i}\nKd 0.{i + 3} 0.5 1\n" for i in range(3)))

    def test_what_is_cut_in_full_is_the_mesh(self):
        """Whatever the format, and whatever attributes it has: GLB turns v over, PLY has no materials, OBJ and PLY name wedges in ways of their own."""
        self.write_painted_grid()
        self.assertEqual(self.json_of("build", "a.obj", "-o", "a.olod")["report"]["seam_vertices"], 19)  # three lines of 7 which cross twice
        self.succeed("hlod", "build", "a.obj", "-o", "a.ohlod", "--node-triangles", 32)
        for name in ("b.glb", "b.obj", "b.ply"):
            with self.subTest(name=name):
                self.succeed("cut", "a.olod", "--error", 0, "-o", name)
                self.succeed("validate", "a.olod", "--input", name)
                self.succeed("hlod", "validate", "a.ohlod", "--input", name)
                self.succeed("build", name, "-o", "b.olod")
                if name != "b.ply":
                    self.succeed("validate", "b.olod", "--input", "a.obj")
                self.succeed("cut", "b.olod", "--error", 0, "-o", f"c{name[1:]}")
                self.succeed("validate", "b.olod", "--input", f"c{name[1:]}")

    def test_text_output(self):
        self.make_hierarchy()
        for command in (["info", "planet.olod"], ["validate", "planet.olod"], ["build", "planet.ply", "-o", "a.olod"]):
            self.assertNotEqual(self.succeed(*command), "")


class Render(ToolTest):
    BUDGET = 1000

    def setUp(self):
        super().setUp()
        self.make_hierarchy()

    def render(self, *arguments, budget=BUDGET):
        return self.json_of("render", "--budget", budget, "--size", "320x240", "planet.olod", *arguments)

    def test_threads_do_not_change_the_mesh(self):
        one = self.render("--threads", 1)
        for threads in (0, 2, 7):
            self.assertEqual(self.render("--threads", threads)["hash"], one["hash"])

    def test_report(self):
        result = self.render()
        self.assert_has_keys(result, "scene method occlusion budget triangles visible_triangles visible_share splits forced_splits "
                                     "queries refine_ms occlusion_ms draw_ms max_error_px hash camera objects")
        self.assert_has_keys(result["camera"], "eye target up fov_y_deg width height near far")
        self.assertEqual((result["scene"], result["method"], result["occlusion"]), ("planet", "occlod", "software"))
        # Two triangles a split on a closed surface: a budget that is used up is missed by a few forced ones at most.
        self.assertTrue(0.9 * self.BUDGET < result["triangles"] <= self.BUDGET, result["triangles"])
        self.assertEqual(result["visible_share"], result["visible_triangles"] / result["triangles"])
        self.assertEqual(result["objects"][0]["triangles"], result["triangles"])
        self.assertEqual(result["objects"][0]["full_triangles"], TRIANGLES)
        self.assertEqual((result["camera"]["width"], result["camera"]["height"]), (320, 240))
        self.assertRegex(result["hash"], "^[0-9a-f]{16}$")

    def test_text_tells_the_errors_apart(self):
        """What the picture shows comes first, then its bound, which is many times as large: two numbers that must not be taken for each other."""
        lines = self.succeed("render", "--budget", self.BUDGET, "planet.olod").splitlines()
        errors = [line for line in lines if "error" in line]
        self.assertEqual([line.split()[0] for line in errors], ["max_quadric_error_px", "max_error_px"])
        self.assertIn("RMS distance", errors[0])
        self.assertIn("guaranteed bound", errors[1])
        self.assertLess(float(errors[0].split()[1]), float(errors[1].split()[1]))

    def test_is_reproducible(self):
        hashes = {self.render("--repeat", repeat)["hash"] for repeat in (1, 1, 3)}
        self.assertEqual(len(hashes), 1)

    def test_options_change_the_refinement(self):
        hashes = [self.render(*options)["hash"] for options in ([], ["--paper"], ["--conservative"])]
        hashes.append(self.render(budget=500)["hash"])
        # Whole subtrees are hidden only once there is more budget than they can do without.
        hashes += [self.render("--paper", "--occlusion", backend, budget=1500)["hash"] for backend in ("none", "software")]
        self.assertEqual(len(set(hashes)), len(hashes), hashes)

    def test_without_occlusion_nothing_is_asked(self):
        self.assertEqual(self.render("--occlusion", "none")["queries"], 0)
        self.assertGreater(self.render("--occlusion", "software")["queries"], 0)

    def test_tolerance_stops_early(self):
        self.assertLess(self.render("--tolerance", 50)["triangles"], self.BUDGET)

    def test_whole_budget_is_the_full_mesh(self):
        """Everything that is seen is refined, so that the picture is the full mesh's own."""
        result = self.render("--paper", "--occlusion", "none", "--reference", budget=TRIANGLES)
        self.assertEqual((result["depth_rms_px"], result["silhouette_mismatch"]), (0, 0))
        self.assertEqual((result["psnr_y"], result["psnr_cb"], result["psnr_cr"]), (None, None, None))  # infinite

    def test_coarse_pictures_differ_from_the_full_mesh(self):
        result = self.render("--reference", budget=200)
        self.assertGreater(result["depth_rms_px"], 0)
        self.assertGreater(result["silhouette_mismatch"], 0)
        for psnr in ("psnr_y", "psnr_cb", "psnr_cr"):
            self.assertTrue(0 < result[psnr] < 60, psnr)

    def test_pictures(self):
        self.render("--png", "view.png", "--birdseye", "top.png")
        for name in ("view.png", "top.png"):
            data = (self.folder / name).read_bytes()
            self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n")
        width, height = struct.unpack(">II", (self.folder / "view.png").read_bytes()[16:24])
        self.assertEqual((width, height), (320, 240))

    def test_textures(self):
        """The planet has no texture coordinates: nothing changes by default, and asking for a texture is a mistake."""
        pictures = []
        for choice in ([], ["--texture", "auto"], ["--texture", "none"]):
            self.render("--png", "view.png", *choice)
            pictures.append((self.folder / "view.png").read_bytes())
        self.assertEqual(pictures[0], pictures[1])
        self.assertEqual(pictures[0], pictures[2])
        for choice in ("checker", "file"):
            self.assertIn("--texture", self.failure_of("render", "planet.olod", "--texture", choice, "--png", "other.png"))
        self.assertFalse((self.folder / "other.png").exists())

    def test_textures_of_two_charts(self):
        """All triangles are there, so the picture is that of the full mesh, on both sides of the seam; without its texture it is another."""
        places = ((0, 0), (1, 0), (1, 1), (0, 1), (2, 0), (2, 1))
        charts = ((0, 0), (0.2, 0), (0.2, 0.2), (0, 0.2), (0.7, 0.7), (0.9, 0.7), (0.9, 0.9), (0.7, 0.9))
        (self.folder / "strip.obj").write_text(
            "".join(f"v {x} {y} 0\n" for x, y in places) + "".join(f"vt {s} {t}\n" for s, t in charts)
            + "f 1/1 2/2 3/3 4/4\nf 2/5 5/6 6/7 3/8\n")
        pictures = {}
        for choice in ("checker", "none"):
            result = self.json_of("render", "strip.obj", "--no-cache", "--texture", choice, "--reference", "--png", "view.png")
            self.assertEqual((result["psnr_y"], result["psnr_cb"], result["psnr_cr"]), (None, None, None))  # infinite
            self.assertEqual(result["texture_slip_px"], 0)
            pictures[choice] = (self.folder / "view.png").read_bytes()
        self.assertNotEqual(pictures["checker"], pictures["none"])

    def write_bent_strip(self):
        """OBJ: a flat strip of 40 x 4 squares whose texture is bent along it, so that fewer triangles show it elsewhere."""
        places = [(x, y) for x in range(41) for y in range(5)]
        def corner(x, y):
            return f"{5 * x + y + 1}/{5 * x + y + 1}"
        (self.folder / "skin.mtl").write_text("newmtl skin\nKd 0.5 0.5 0.5\nnewmtl bare\nKd 1 0 0\n")
        (self.folder / "strip.obj").write_text(
            "mtllib skin.mtl\n" + "".join(f"v {x / 4} {y / 4} 0\n" for x, y in places)
            + "".join(f"vt {(x / 40) ** 3} {y / 4}\n" for x, y in places)
            + "".join(("usemtl skin\n" if x == 0 else "usemtl bare\n" if x == 20 else "")
                      + "".join(f"f {corner(x, y)} {corner(x + 1, y)} {corner(x + 1, y + 1)} {corner(x, y + 1)}\n" for y in range(4)) for x in range(40)))

    def test_textures_slip(self):
        """A flat surface has no other error. Where textures may slip, triangles do not go there; without coordinates there is nothing to slip."""
        self.write_bent_strip()
        def slip(budget, **keys):
            scene = {"objects": [{"mesh": "strip.obj", **keys}], "cameras": {"default": {"eye": [5, 0.5, 8], "target": [5, 0.5, 0], "width": 400, "height": 160}}}
            self.write_scene(json.dumps(scene))
            result = self.json_of("render", "scene.json", "--no-cache", "--budget", budget, "--reference")
            self.assertEqual(result["depth_rms_px"], 0)
            return result["texture_slip_px"]
        slips = [slip(budget) for budget in (64, 100, 320)]
        self.assertEqual(slips, sorted(slips, reverse=True))
        self.assertTrue(0.01 < slips[0] <= 10)
        self.assertEqual(slips[-1], 0)
        self.assertGreaterEqual(slip(100, attributes=False), slips[1])
        self.assertNotIn("texture_slip_px", self.render("--reference", budget=200))

    def triangles_of_obj(self, name):
        """By corner: position, texture coordinate and material; triangles start at their least corner."""
        places, coordinates, triangles, material = [], [], [], None
        for line in (self.folder / name).read_text().splitlines():
            kind, *words = line.split()
            if kind in ("v", "vt"):
                (places if kind == "v" else coordinates).append(tuple(round(float(word), 4) + 0.0 for word in words[:3]))
            elif kind == "usemtl":
                material = words[0]
            elif kind == "f":
                corners = [word.split("/") for word in words]
                corners = [(places[int(v) - 1], coordinates[int(t) - 1], material) for v, t in corners]
                for i in range(1, len(corners) - 1):
                    triangle = [corners[0], corners[i], corners[i + 1]]
                    first = triangle.index(min(triangle))
                    triangles.append(tuple(triangle[first:] + triangle[:first]))
        return sorted(triangles)

    def test_mesh_of_textured_objects(self):
        """Each object keeps its seams and materials to the corner, also as GLB, which is read and written again here. The second one is mirrored and turned."""
        self.write_bent_strip()
        self.write_scene("""{"objects": [{"mesh": "strip.obj", "two_sided": true}, {"mesh": "strip.obj", "two_sided": true, "scale": -1, "position": [0, 0, 5]}],
                             "cameras": {"default": {"eye": [0, 0, 30], "target": [0, 0, 0]}}}""")
        for name in ("all.obj", "all.glb"):
            self.succeed("render", "scene.json", "--no-cache", "--budget", 640, "--mesh", name)
        self.succeed("build", "all.glb", "-o", "all.olod")
        self.succeed("cut", "all.olod", "--triangles", 640, "-o", "from_glb.obj")
        strip = self.triangles_of_obj("strip.obj")
        mirrored = [[((-x, -y, 5 - z), at, material) for (x, y, z), at, material in (a, c, b)] for a, b, c in strip]
        mirrored = [[(tuple(coordinate + 0.0 for coordinate in place), at, material) for place, at, material in triangle] for triangle in mirrored]
        wanted = sorted(strip + [tuple(t[t.index(min(t)):] + t[:t.index(min(t))]) for t in mirrored])
        self.assertEqual(self.triangles_of_obj("all.obj"), wanted)
        self.assertEqual(self.triangles_of_obj("from_glb.obj"), wanted)
        text = (self.folder / "all.mtl").read_text()
        self.assertEqual(text.count("newmtl"), 2)
        self.assertIn("newmtl bare\nKd 1 0 0\n", text)

    def test_images_of_meshes_are_not_overwritten(self):
        (self.folder / "skin.mtl").write_text("newmtl skin\nmap_Kd skin.png\n")
        (self.folder / "one.obj").write_text("mtllib skin.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl skin\nf 1/1 2/1 3/1\n")
        (self.folder / "skin.png").write_text("kept")
        done = self.run_tool("render", "one.obj", "--no-cache", "--png", "skin.png")
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn("--png: would overwrite skin.png, which is an image of one.obj", done.stderr)
        self.assertEqual((self.folder / "skin.png").read_text(), "kept")

    def test_mesh_in_world_space(self):
        """The second object is mirrored and moved by 10: its half of the mesh lies there, and its outside stays outside."""
        self.write_scene("""{"objects": [{"mesh": "planet.olod"}, {"mesh": "planet.olod", "scale": -1, "position": [10, 0, 0]}],
                             "cameras": {"default": {"eye": [5, 0, 30], "target": [5, 0, 0]}}}""")
        result = self.json_of("render", "scene.json", "--budget", 1000, "--mesh", "refined.off")
        lines = (self.folder / "refined.off").read_text().split("\n")
        vertex_count, triangle_count = map(int, lines[1].split()[:2])
        self.assertEqual(triangle_count, result["triangles"])
        points = [tuple(map(float, line.split()[:3])) for line in lines[2:2 + vertex_count]]
        triangles = [tuple(map(int, line.split()[1:4])) for line in lines[2 + vertex_count:2 + vertex_count + triangle_count]]
        used = {corner for triangle in triangles for corner in triangle}
        self.assertEqual(len(used), vertex_count)
        volumes = {0: 0.0, 10: 0.0}
        for triangle in triangles:
            center = 0 if points[triangle[0]][0] < 5 else 10
            (ax, ay, az), (bx, by, bz), (cx, cy, cz) = [(points[i][0] - center, points[i][1], points[i][2]) for i in triangle]
            volumes[center] += (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6
        # A ball of radius 1 has 4.19; hills and a coarse far side take some of it.
        for center, volume in volumes.items():
            self.assertTrue(2.5 < volume < 5.3, (center, volume))

    def test_scene_by_generator_is_cached(self):
        self.write_scene("""{"objects": [{"generator": "rough-planet", "options": {"level": 3}}],
                             "cameras": {"default": {"eye": [0, 0, 3], "target": [0, 0, 0]}, "low": {"eye": [0, 1.2, 0], "target": [0, 0.8, -1]}}}""")
        first = self.json_of("render", "scene.json", "--occlusion", "software", "--budget", 300)
        cache = list((self.folder / "cache/occlod").iterdir())
        self.assertEqual(len(cache), 1)
        self.assertEqual(self.json_of("render", "scene.json", "--occlusion", "software", "--budget", 300)["hash"], first["hash"])
        self.assertEqual(self.json_of("render", "scene.json", "--occlusion", "software", "--budget", 300, "--no-cache")["hash"], first["hash"])
        low = self.json_of("render", "scene.json", "--occlusion", "software", "--budget", 300, "--camera", "low")
        self.assertEqual(low["camera"]["eye"], [0, 1.2, 0])
        cache[0].write_bytes(b"not a hierarchy")
        done = self.run_tool("render", "scene.json", "--occlusion", "software", "--budget", 300, "--json")
        self.assertEqual(json.loads(done.stdout)["hash"], first["hash"])
        self.assertTrue(done.stderr.startswith("occlod: note: "), done.stderr)

    # Opening the file does not look at the bytes that are changed: those of a split.
    def test_scene_whose_cache_is_damaged_is_rendered_as_without(self):
        self.write_scene("""{"objects": [{"generator": "rough-planet", "options": {"level": 4}}],
                             "cameras": {"default": {"eye": [0, 0, 3], "target": [0, 0, 0]}}}""")
        render = ("render", "scene.json", "--occlusion", "software", "--budget", 1000)
        expected = self.json_of(*render, "--no-cache")["hash"]
        self.assertEqual(self.json_of(*render)["hash"], expected)
        entry = next((self.folder / "cache/occlod").iterdir())
        whole = entry.read_bytes()
        entry.write_bytes(whole[:5000] + b"ABCDEFGH" + whole[5008:])
        done = self.run_tool(*render, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout)["hash"], expected)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn("built again", done.stderr)
        self.assertEqual(entry.read_bytes(), whole)

    def write_scene_with_paths(self):
        """A path that jumps from the default camera to one close by, and one that moves from the first to the second."""
        keys = """[{"eye": [0, 0, 3], "target": [0, 0, 0], "width": 160, "height": 120}, {"eye": [0, 1.3, 0], "target": [0, 0.8, -1]}]"""
        self.write_scene("""{"objects": [{"mesh": "planet.olod"}],
                             "cameras": {"default": {"eye": [0, 0, 3], "target": [0, 0, 0], "width": 160, "height": 120}},
                             "paths": {"jump": {"frames": 4, "jump": true, "keys": %s}, "move": {"frames": 3, "keys": %s}}}""" % (keys, keys))

    def test_path(self):
        """Frames 0 and 1 hold the default camera: the Refiner that is used again must give what a fresh one gives, at once and after the jump."""
        self.write_scene_with_paths()
        alone = self.json_of("render", "scene.json", "--occlusion", "software", "--budget", 500)
        result = self.json_of("render", "scene.json", "--occlusion", "software", "--budget", 500, "--path", "jump")
        self.assertEqual(result["path"], "jump")
        self.assertNotIn("path", alone)
        frames = result["frames"]
        self.assertEqual([frame["frame"] for frame in frames], [0, 1, 2, 3])
        self.assertEqual([frame["hash"] for frame in frames[:2]], [alone["hash"]] * 2)
        self.assertEqual(frames[0]["camera"], alone["camera"])
        self.assertEqual(frames[2]["camera"]["eye"], [0, 1.3, 0])
        self.assertEqual(frames[2]["hash"], frames[3]["hash"])
        self.assertNotEqual(frames[2]["hash"], alone["hash"])
        for frame in frames:
            self.assert_has_keys(frame, "triangles visible_triangles hash refine_ms occlusion_ms draw_ms camera")
            self.assertLessEqual(frame["triangles"], 500)

    def test_orthographic(self):
        """At 45 degrees and 3 units from its target a camera shows 6 tan(22.5 degrees) units there. A ball of radius 1 hides half of itself; from farther away, where
        near and far move along, parallel rays show the same."""
        camera = '{"eye": [0, 0, %d], "target": [0, 0, 0], "near": %d, "far": %d, "width": 320, "height": 240%s}'
        self.write_scene('{"objects": [{"mesh": "planet.olod"}], "cameras": {"default": %s, "flat": %s, "away": %s}}' % (
            camera % (3, 1, 5, ""), camera % (3, 1, 5, ', "orthographic_height": 2.4'), camera % (1003, 1001, 1005, ', "orthographic_height": 2.4')))
        arguments = ("--occlusion", "software", "--budget", 1000)
        result = self.json_of("render", "scene.json", *arguments, "--orthographic", "--reference")
        self.assertAlmostEqual(result["camera"]["orthographic_height"], 6 * math.tan(math.pi / 8))
        self.assertNotIn("fov_y_deg", result["camera"])
        self.assertEqual(result["wrongly_hidden_px"], 0)
        self.assertNotEqual(result["hash"], self.json_of("render", "scene.json", *arguments)["hash"])
        flat = self.json_of("render", "scene.json", *arguments, "--camera", "flat")
        self.assertEqual(flat["camera"]["orthographic_height"], 2.4)
        self.assertEqual(self.json_of("render", "scene.json", *arguments, "--camera", "flat", "--orthographic")["hash"], flat["hash"])
        away = self.json_of("render", "scene.json", *arguments, "--camera", "away")
        self.assertAlmostEqual(away["visible_triangles"] / flat["visible_triangles"], 1.0, delta=0.02)
        self.assertAlmostEqual(away["max_quadric_error_px"] / flat["max_quadric_error_px"], 1.0, delta=0.02)

    def test_pictures_in_place_of_occluders(self):
        """The first frame has no picture yet and is that of software; later ones ask as well, and may hide more or less than an occluder."""
        self.write_scene_with_paths()
        arguments = ("render", "scene.json", "--budget", 500, "--path", "move", "--frame-to-frame", "--occlusion")
        pictured, drawn = (self.json_of(*arguments, way) for way in ("picture", "software"))
        self.assertEqual(pictured["occlusion"], "picture")
        self.assertEqual(pictured["frames"][0]["hash"], drawn["frames"][0]["hash"])
        for frame in pictured["frames"]:
            self.assertGreater(frame["queries"], 0)
            self.assertGreater(frame["show_ms"], 0)
            self.assertLessEqual(frame["triangles"], 500)
        self.assertNotIn("show_ms", drawn["frames"][1])
        self.assertIn("needs the picture of a frame before", self.failure_of("render", "scene.json", "--occlusion", "picture"))

    def test_path_as_table_and_pictures(self):
        self.write_scene_with_paths()
        lines = self.succeed("render", "scene.json", "--occlusion", "software", "--budget", 500, "--path", "move", "--size", "64x48", "--png", "view.png").splitlines()
        hashes = [frame["hash"] for frame in self.json_of("render", "scene.json", "--occlusion", "software", "--budget", 500, "--path", "move", "--size", "64x48")["frames"]]
        self.assertEqual([line.split()[-1] for line in lines[1:]], hashes)
        self.assertEqual(len(set(hashes)), 3)
        self.assertEqual(sorted(path.name for path in self.folder.glob("*.png")), [f"view_{i:05}.png" for i in range(3)])
        self.assertEqual(struct.unpack(">II", (self.folder / "view_00002.png").read_bytes()[16:24]), (64, 48))

    def frames_of(self, *arguments):
        return self.json_of("render", "scene.json", "--budget", 500, "--path", "orbit", "--frame-to-frame", *arguments)["frames"]

    def write_scene_with_orbit(self):
        """Twelve steps around a quarter of the planet: most of what is seen in one frame is seen in the next."""
        keys = [{"eye": [3 * math.sin(a), 0.4, 3 * math.cos(a)], "target": [0, 0, 0], "width": 160, "height": 120}
                for a in (0, math.pi / 4, math.pi / 2)]
        self.write_scene(json.dumps({"objects": [{"mesh": "planet.olod"}], "cameras": {"default": keys[0]},
                                     "paths": {"orbit": {"frames": 12, "keys": keys}}}))

    def test_frame_to_frame(self):
        self.write_scene_with_orbit()
        result = self.json_of("render", "scene.json", "--budget", 500, "--path", "orbit", "--frame-to-frame")
        self.assertTrue(result["frame_to_frame"])
        self.assert_has_keys(result, "max_changes time_limit_ms geomorph_frames")
        frames = result["frames"]
        scratch = self.json_of("render", "scene.json", "--budget", 500, "--path", "orbit")
        self.assertFalse(scratch["frame_to_frame"])
        self.assertEqual(len(frames), 12)
        for frame in frames:
            self.assertTrue(0.9 * 500 < frame["triangles"] <= 500, frame["triangles"])
        # The first frame has nothing to go on from. A later one changes what it must: refining anew would change all.
        self.assertEqual(frames[0]["new_splits"], frames[0]["splits"])
        self.assertEqual(frames[0]["changed_triangles"], frames[0]["triangles"])
        for before, frame in zip(frames, frames[1:]):
            self.assertEqual(frame["splits"], before["splits"] + frame["new_splits"] - frame["merged_splits"])
            self.assertLess(frame["changed_triangles"], frame["triangles"])
        self.assertNotEqual([frame["hash"] for frame in frames], [frame["hash"] for frame in scratch["frames"]])
        self.assertNotIn("new_splits", scratch["frames"][0])

    def test_frame_to_frame_is_reproducible(self):
        self.write_scene_with_orbit()
        first, second = [[frame["hash"] for frame in self.frames_of("--max-changes", 20)] for _ in range(2)]
        self.assertEqual(first, second)
        self.assertGreater(len(set(first)), 6)
        lines = self.succeed("render", "scene.json", "--budget", 500, "--path", "orbit", "--frame-to-frame", "--max-changes", 20).splitlines()
        self.assertEqual([line.split()[-1] for line in lines[1:]], first)
        for column in ("new splits", "merged splits", "changed triangles", "pending"):
            self.assertIn(column, lines[0])

    def test_work_of_a_frame_is_limited(self):
        """One step may force a few splits beyond the limit and make room for them; what is left over is told."""
        self.write_scene_with_orbit()
        free, limited = self.frames_of()[1:], self.frames_of("--max-changes", 4)[1:]
        changes = lambda frames: sum(frame["new_splits"] + frame["merged_splits"] for frame in frames)
        self.assertLess(changes(limited), changes(free))
        self.assertTrue(any(frame["pending"] for frame in limited))
        self.assertFalse(any(frame["pending"] for frame in free))

    def test_geomorphs_are_drawn(self):
        """The same triangles, in the first frame, which nothing precedes, at the same places: later vertices lag behind."""
        self.write_scene_with_orbit()
        frames, sliding = self.frames_of("--png", "a.png"), self.frames_of("--png", "b.png", "--geomorph-frames", 6)
        self.assertEqual([frame["hash"] for frame in frames], [frame["hash"] for frame in sliding])
        self.assertTrue(self.same_bytes("a_00000.png", "b_00000.png"))
        self.assertFalse(self.same_bytes("a_00005.png", "b_00005.png"))

    def test_path_mistakes(self):
        self.write_scene_with_paths()
        self.assertIn("jump, move", self.failure_of("render", "scene.json", "--path", "other"))
        self.assertIn("--path", self.failure_of("render", "planet.olod", "--path", "jump"))

    def test_mesh_directly(self):
        result = self.json_of("render", "planet.ply", "--budget", 500)
        self.assertEqual(result["scene"], "planet")
        self.assertGreater(result["visible_triangles"], 100)


if __name__ == "__main__":
    unittest.main(verbosity=1)
