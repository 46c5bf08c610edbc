"""Coordinates with more digits than floats have, through the command line: one line says so, and every output keeps them."""
import json
import struct
import unittest

import tileset_check
from tool_case import ToolTest

SIDE = 30  # squares along each side of a patch of 3 m
TRIANGLES = 2 * SIDE * SIDE
UTM = (691607.37, 5334760.81, 519.93)
TENTH_MM = 1e-4


def points_of(at):
    return [(at[0] + 0.1 * x, at[1] + 0.1 * y, at[2] + 0.02 * ((7 * x + 3 * y) % 5)) for y in range(SIDE + 1) for x in range(SIDE + 1)]


def faces():
    for y in range(SIDE):
        for x in range(SIDE):
            v = y * (SIDE + 1) + x
            yield v, v + 1, v + SIDE + 2
            yield v, v + SIDE + 2, v + SIDE + 1


def glb_points(path):
    """Of its nodes at the top, which have translations only."""
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    gltf, blob = json.loads(data[20:20 + length]), data[28 + length:]
    for node in gltf["nodes"]:
        for primitive in gltf["meshes"][node["mesh"]]["primitives"]:
            accessor = gltf["accessors"][primitive["attributes"]["POSITION"]]
            start = gltf["bufferViews"][accessor["bufferView"]].get("byteOffset", 0) + accessor.get("byteOffset", 0)
            for i in range(accessor["count"]):
                point = struct.unpack_from("<3f", blob, start + 12 * i)
                yield [p + t for p, t in zip(point, node.get("translation", (0, 0, 0)))]


def ply_points(path):
    header, body = path.read_bytes().split(b"end_header\n", 1)
    assert b"property double x" in header
    count = int(header.split(b"element vertex ")[1].split()[0])
    return list(struct.iter_unpack("<3d", body[:24 * count]))


def text_points(path, keyword):
    lines = path.read_text().splitlines()
    if keyword:
        return [tuple(map(float, line.split()[1:4])) for line in lines if line.startswith(keyword + " ")]
    return [tuple(map(float, line.split())) for line in lines[2:2 + int(lines[1].split()[0])]]


class OriginTest(ToolTest):
    def setUp(self):
        super().setUp()
        self.points = points_of(UTM)
        self.write_obj("utm.obj", self.points)
        self.places = {self.cell(p): p for p in self.points}

    def write_obj(self, name, points):
        text = "".join("v {!r} {!r} {!r}\n".format(*p) for p in points) + "".join("f {} {} {}\n".format(*(v + 1 for v in f)) for f in faces())
        (self.folder / name).write_text(text)

    @staticmethod
    def cell(point):
        """x and y are multiples of 0.1 from the corner, and tell points apart."""
        return tuple(round(10 * (point[k] - UTM[k])) for k in range(2))

    def assert_kept(self, points, least=1):
        points = list(points)
        self.assertGreaterEqual(len(points), least)
        for point in points:
            self.assertLess(max(abs(a - b) for a, b in zip(point, self.places[self.cell(point)])), TENTH_MM)


class Origin(OriginTest):
    def test_said_in_one_line(self):
        built = self.json_of("build", "utm.obj", "-o", "utm.olod")
        self.assertEqual(built["triangles"], TRIANGLES)
        self.assertEqual((built["report"]["zero_area_triangles"], built["report"]["repeated_index_triangles"]), (0, 0))
        self.assertNotIn("advice", built)
        origin = built["origin"]
        self.assertTrue(all(abs(o - u) < 4 for o, u in zip(origin, UTM)))
        nested = ["--grouping", "nested", "--borders", "free"]
        for command in (["info", "utm.obj"], ["info", "utm.olod"], ["build", "utm.obj", "-o", "b.olod"], ["cut", "utm.olod", "--triangles", 99, "-o", "c.ply"],
                        ["hlod", "build", "utm.obj", "-o", "utm.ohlod", *nested], ["hlod", "info", "utm.ohlod"],
                        ["hlod", "build", "utm.obj", "-o", "s.ohlod", "--memory", "1G"]):
            self.assertEqual(self.json_of(*command)["origin"], origin, command)
            self.assertEqual(self.succeed(*command).count("coordinates are kept relative to it"), 1, command)
        self.assertRegex(self.succeed("info", "utm.olod"), "origin +[0-9.]+ [0-9.]+ [0-9.]+  \\(coordinates")
        box = self.json_of("info", "utm.olod")["box"]
        self.assertLess(max(abs(a - b) for a, b in zip(box["min"], UTM)), TENTH_MM)

    def test_nothing_is_said_of_near_ones(self):
        self.write_obj("near.obj", points_of((0, 0, 0)))
        self.assertNotIn("origin", self.json_of("build", "near.obj", "-o", "near.olod"))
        self.assertNotIn("relative", self.succeed("info", "near.olod"))

    def test_cuts_keep_the_digits(self):
        self.succeed("build", "utm.obj", "-o", "utm.olod")
        for triangles in (TRIANGLES, 400):
            for name in ("c.ply", "c.obj", "c.off", "c.glb"):
                self.succeed("cut", "utm.olod", "--triangles", triangles, "-o", name)
            self.assert_kept(ply_points(self.folder / "c.ply"))
            self.assert_kept(text_points(self.folder / "c.obj", "v"))
            self.assert_kept(text_points(self.folder / "c.off", ""))
            self.assert_kept(glb_points(self.folder / "c.glb"))
        self.succeed("cut", "utm.olod", "--triangles", TRIANGLES, "-o", "c.ply")
        self.assertTrue(self.json_of("validate", "utm.olod", "--input", "c.ply")["valid"])
        self.assertTrue(self.json_of("validate", "utm.olod", "--input", "utm.obj")["valid"])

    def test_stl_says_what_it_lacks(self):
        self.succeed("build", "utm.obj", "-o", "utm.olod")
        done = self.run_tool("cut", "utm.olod", "--triangles", 400, "-o", "c.stl")
        self.assertEqual((done.returncode, done.stderr.count("\n")), (0, 1), done.stderr)
        self.assertIn("c.stl: STL has floats only, so its coordinates are relative to the origin", done.stderr)

    def test_tiles_are_where_their_coordinates_are(self):
        for up, turn in (("z", lambda p: p), ("y", lambda p: (p[0], -p[2], p[1]))):
            self.json_of("hlod", "build", "utm.obj", "-o", "utm.ohlod", "--grouping", "nested", "--borders", "free", "--node-triangles", 256)
            self.succeed("tiles", "utm.ohlod", "-o", up, "--up", up)
            tileset_check.check(self.folder / up, None)
            columns = json.loads((self.folder / up / "tileset.json").read_text())["root"]["transform"]
            wanted = {self.cell(p): turn(p) for p in self.points}
            for tile in (self.folder / up / "tiles").rglob("*.glb"):
                for x, y, z in glb_points(tile):
                    x, y, z = x, -z, y  # clients turn contents from y up to z up
                    placed = [columns[k] * x + columns[4 + k] * y + columns[8 + k] * z + columns[12 + k] for k in range(3)]
                    here = wanted[self.cell(placed if up == "z" else (placed[0], placed[2]))]
                    self.assertLess(max(abs(a - b) for a, b in zip(placed, here)), TENTH_MM)

    def test_scenes_are_placed_in_doubles(self):
        """The same mesh at 0, moved there by the scene: every output is the same surface, and pictures are the same."""
        self.write_obj("near.obj", points_of((0, 0, 0)))
        eye, target = (1.2, 0.4, 4.0), (1.5, 1.5, 0.0)
        for name, mesh, place, at in (("near", "near.obj", (0, 0, 0), (0, 0, 0)), ("moved", "near.obj", UTM, UTM), ("utm", "utm.obj", (0, 0, 0), UTM)):
            camera = {"eye": [a + b for a, b in zip(eye, at)], "target": [a + b for a, b in zip(target, at)], "near": 0.1, "far": 20, "width": 120, "height": 80}
            (self.folder / f"{name}.json").write_text(json.dumps({"objects": [{"mesh": mesh, "position": place}], "cameras": {"default": camera}}))
        drawn = {}
        for name in ("near", "moved", "utm"):
            drawn[name] = self.json_of("render", f"{name}.json", "--budget", 500, "--tolerance", 0.001, "--mesh", f"{name}.ply", "--png", f"{name}.png", "--reference")
            self.assertEqual(drawn[name]["wrongly_hidden_px"], 0)
            if name != "near":
                self.assert_kept(ply_points(self.folder / f"{name}.ply"))
                self.assertEqual(self.json_of("hlod", "build", f"{name}.json", "-o", f"{name}.ohlod")["triangles"], TRIANGLES)
                self.assertTrue(self.json_of("hlod", "validate", f"{name}.ohlod", "--input", f"{name}.json")["valid"])
        self.assertEqual((self.folder / "near.png").read_bytes(), (self.folder / "moved.png").read_bytes())
        self.assertAlmostEqual(drawn["utm"]["max_error_px"], drawn["near"]["max_error_px"], delta=1e-3)


class OriginOfScenes(OriginTest):
    """Objects that are turned, scaled and moved to large coordinates, or lie there, one beside the other."""

    ASIDE = (UTM[0] + 10, UTM[1] + 3, UTM[2])  # tenths again, so that cells tell its points apart too

    def setUp(self):
        super().setUp()
        self.write_obj("near.obj", points_of((0, 0, 0)))
        self.write_obj("half.obj", [(y / 2, -x / 2, z / 2) for x, y, z in points_of((0, 0, 0))])
        turned = {"mesh": "half.obj", "position": self.ASIDE, "rotation": {"axis": [0, 0, 1], "degrees": 90}, "scale": 2}
        self.write("far.json", UTM, [{"mesh": "utm.obj"}, turned])
        self.write("moved.json", UTM, [{"mesh": "near.obj", "position": UTM}, turned])
        self.write("near.json", (0, 0, 0), [{"mesh": "near.obj"}, dict(turned, position=[10, 3, 0])])
        self.places.update((self.cell(p), p) for p in points_of(self.ASIDE))

    def write(self, name, at, objects):
        camera = {"eye": [at[0] + 1.2, at[1] + 0.4, at[2] + 4], "target": [at[0] + 1.5, at[1] + 1.5, at[2]], "near": 0.1, "far": 20, "width": 120, "height": 80}
        (self.folder / name).write_text(json.dumps({"objects": objects, "cameras": {"default": camera},
                                                    "paths": {"along": {"frames": 3, "keys": [camera, dict(camera, eye=[camera["eye"][0] + 0.5, *camera["eye"][1:]])]}}}))

    def test_meshes_and_pictures(self):
        drawn = {}
        for name in ("near", "moved", "far"):
            drawn[name] = self.json_of("render", f"{name}.json", "--budget", 2 * TRIANGLES, "--mesh", f"{name}.ply", "--reference")
            self.assertEqual(drawn[name]["wrongly_hidden_px"], 0)
        self.assertEqual(drawn["near"]["triangles"], drawn["moved"]["triangles"])
        for name in ("moved", "far"):
            self.assert_kept(ply_points(self.folder / f"{name}.ply"))

    def test_hlods_and_tiles(self):
        for name in ("moved", "far"):
            built = self.json_of("hlod", "build", f"{name}.json", "-o", f"{name}.ohlod", "--grouping", "nested", "--borders", "free")
            self.assertEqual((built["triangles"], built["report"]["zero_area_triangles"]), (2 * TRIANGLES, 0))
            self.assertTrue(self.json_of("hlod", "validate", f"{name}.ohlod", "--input", f"{name}.json")["valid"])
            self.succeed("tiles", f"{name}.json", "-o", name, "--up", "z")
            columns = json.loads((self.folder / name / "tileset.json").read_text())["root"]["transform"]
            points = [(x, -z, y) for tile in (self.folder / name / "tiles").rglob("*.glb") for x, y, z in glb_points(tile)]
            self.assert_kept([[columns[k] * x + columns[4 + k] * y + columns[8 + k] * z + columns[12 + k] for k in range(3)] for x, y, z in points],
                             2 * len(self.points))

    def test_cells(self):
        """No pixel lacks what the full mesh shows, and a walk draws as many triangles as at 0."""
        walked = {}
        for name, at in (("near", (0, 0, 0)), ("moved", UTM), ("far", UTM)):
            box = ",".join(repr(a + b) for b in (0, 3) for a, b in zip(at, (b, b, 3 if b == 0 else 5)))
            self.succeed("cells", "build", f"{name}.json", "-o", f"{name}.vlod", "--region", box)
            self.assertEqual(self.json_of("cells", "validate", f"{name}.vlod", f"{name}.json", "--eyes", 4, "--image-size", 64)["unexplained"], 0)
            walk = self.json_of("cells", "walk", f"{name}.vlod", f"{name}.json", "--path", "along", "--reference", 3)
            self.assertEqual([frame["unexplained_px"] for frame in walk["frame"]], [0, 0, 0])
            walked[name] = [frame["triangles"] for frame in walk["frame"]]
        self.assertEqual(walked["near"], walked["moved"])

    def test_gltf_nodes(self):
        """A mesh of floats whose node lies there, as converters write it."""
        self.succeed("simplify", "near.obj", "-o", "near.glb", "--triangles", TRIANGLES)
        data = (self.folder / "near.glb").read_bytes()
        length = struct.unpack_from("<I", data, 12)[0]
        gltf = json.loads(data[20:20 + length])
        gltf["nodes"][0]["translation"] = UTM
        text = json.dumps(gltf).encode()
        text += b" " * (-len(text) % 4)
        whole = data[:8] + struct.pack("<III", 20 + len(text) + len(data) - 20 - length, len(text), 0x4E4F534A) + text + data[20 + length:]
        (self.folder / "utm.glb").write_bytes(whole)
        info = self.json_of("info", "utm.glb")
        self.assertEqual((info["triangles"], info["report"]["zero_area_triangles"]), (TRIANGLES, 0))
        self.succeed("simplify", "utm.glb", "-o", "utm.ply", "--triangles", TRIANGLES)
        self.assert_kept(ply_points(self.folder / "utm.ply"), len(self.points))


class OriginCompared(OriginTest):
    def test_compared_in_world_space(self):
        self.write_obj("aside.obj", [(x + 0.25, y, z + 0.5) for x, y, z in self.points])
        self.assertNotEqual(self.json_of("info", "aside.obj")["origin"], self.json_of("info", "utm.obj")["origin"])
        self.assertLess(self.json_of("compare", "utm.obj", "utm.obj", "--samples", 1000)["max"], TENTH_MM)
        apart = self.json_of("compare", "utm.obj", "aside.obj", "--samples", 1000)
        self.assertTrue(0.4 < apart["max"] < 0.6, apart)
        self.assertLess(max(abs(a - b) for a, b in zip(apart["max_at"], UTM)), 4)

    def test_repaired_where_it_is(self):
        repaired = self.json_of("repair", "utm.obj", "-o", "r.ply")
        self.assertEqual(repaired["origin"], self.json_of("info", "utm.obj")["origin"])
        self.assert_kept(ply_points(self.folder / "r.ply"), len(self.points))


if __name__ == "__main__":
    unittest.main(verbosity=1)
