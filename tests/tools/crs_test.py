"""`occlod tiles --crs`: where the vertices of tiles are on Earth, against cs2cs, PROJ's own program, and a reader of tiles of its own."""
import itertools
import json
import math
import pathlib
import shutil
import struct
import subprocess
import unittest

import tileset_check
from tool_case import ToolTest

SIDE = 100  # squares along each side of the mesh
STEP = 20.13  # metres: 2 km
UTM = (499_017.37, 5_398_988.81, 340.0)
FEET = 1200 / 3937


def height(x, y):
    return 60 * math.sin(x / 9) * math.cos(y / 7)


def grid(at=UTM, step=STEP, side=SIDE):
    return [(at[0] + step * x, at[1] + step * y, at[2] + height(x, y)) for y in range(side + 1) for x in range(side + 1)]


def faces(side=SIDE, base=0):
    for y in range(side):
        for x in range(side):
            v = base + y * (side + 1) + x
            yield v, v + 1, v + side + 2
            yield v, v + side + 2, v + side + 1


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def minus(a, b):
    return [p - q for p, q in zip(a, b)]


def unit(a):
    length = math.hypot(*a)
    return [p / length for p in a]


def angle(a, b):
    return math.atan2(math.hypot(*cross(a, b)), sum(p * q for p, q in zip(a, b)))


def times(matrix, vector, w):
    return [sum(matrix[4 * k + row] * vector[k] for k in range(3)) + w * matrix[12 + row] for row in range(3)]


def leaf_contents(folder, name="tileset.json"):
    todo = [json.loads((folder / name).read_text())["root"]]
    while todo:
        tile = todo.pop()
        todo += tile.get("children", [])
        uri = tile.get("content", {}).get("uri", "")
        if uri.endswith(".json"):
            yield from leaf_contents(folder, uri)
        elif uri and "children" not in tile:
            yield folder / uri


def leaves(folder):
    """Earth-centred (positions, normals, triangles) of each primitive of the finest tiles; normals are empty if it has none."""
    transform = json.loads((folder / "tileset.json").read_text())["root"]["transform"]
    for path in leaf_contents(folder):
        data = path.read_bytes()
        length = struct.unpack_from("<I", data, 12)[0]
        gltf, blob = json.loads(data[20:20 + length]), data[28 + length:]

        def values(index, form):
            accessor = gltf["accessors"][index]
            start = gltf["bufferViews"][accessor["bufferView"]].get("byteOffset", 0) + accessor.get("byteOffset", 0)
            return list(struct.iter_unpack("<" + form, blob[start:start + accessor["count"] * struct.calcsize(form)]))

        node = gltf["nodes"][0]
        for primitive in gltf["meshes"][node["mesh"]]["primitives"]:
            move = node["translation"]
            at = [[p + t for p, t in zip(point, move)] for point in values(primitive["attributes"]["POSITION"], "3f")]
            normals = values(primitive["attributes"]["NORMAL"], "3f") if "NORMAL" in primitive["attributes"] else []
            wide = gltf["accessors"][primitive["indices"]]["componentType"] == 5125
            corners = [i for i, in values(primitive["indices"], "I" if wide else "H")]
            yield ([times(transform, (x, -z, y), 1) for x, y, z in at], [times(transform, (x, -z, y), 0) for x, y, z in normals],
                   list(zip(*[iter(corners)] * 3)))


def on_earth(crs, points):
    """Earth-centred, by PROJ's own program; `points` have the system's order of axes."""
    text = "".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in points)
    done = subprocess.run(["cs2cs", "-f", "%.9f", crs, "EPSG:4978"], input=text, capture_output=True, text=True, check=True)
    return [tuple(map(float, line.split())) for line in done.stdout.splitlines()]


class Places:
    """Finds the nearest of some places that are metres apart."""

    def __init__(self, places):
        self.places, self.cells = places, {}
        for i, place in enumerate(places):
            self.cells.setdefault(tuple(math.floor(p) for p in place), []).append(i)

    def nearest(self, point):
        cell = [math.floor(p) for p in point]
        near = [i for d in itertools.product((-1, 0, 1), repeat=3) for i in self.cells.get(tuple(c + k for c, k in zip(cell, d)), [])]
        return min(((math.dist(point, self.places[i]), i) for i in near), default=(math.inf, None))


class Crs(ToolTest):
    def write_ply(self, name, points, triangles=None, form="d", normals=()):
        triangles = list(faces() if triangles is None else triangles)
        kind = {"d": "double", "f": "float"}[form]
        header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n" + "".join(f"property {kind} {axis}\n" for axis in "xyz")
        header += "".join(f"property float n{axis}\n" for axis in "xyz") if normals else ""
        header += f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
        body = b"".join(struct.pack(f"<3{form}", *p) + (struct.pack("<3f", *normals[i]) if normals else b"") for i, p in enumerate(points))
        (self.folder / name).write_bytes(header.encode() + body + b"".join(struct.pack("<B3i", 3, *t) for t in triangles))

    def tiles(self, *arguments, folder="tiles"):
        told = self.json_of("tiles", *arguments, "-o", folder, "--replace", "--node-triangles", 512)
        tileset_check.check(self.folder / folder)
        return told

    def assert_places(self, expected, folder="tiles", most=1e-3):
        """Each place has a vertex, and each vertex a place, within a millimetre."""
        places, found, farthest = Places(expected), set(), 0.0
        for positions, _, _ in leaves(self.folder / folder):
            for point in positions:
                distance, i = places.nearest(point)
                farthest = max(farthest, distance)
                found.add(i)
        self.assertLess(farthest, most)
        self.assertEqual(len(found), len(expected))
        return farthest

    def assert_upright(self, folder="tiles"):
        """All triangles of a terrain face away from the centre of the Earth."""
        for positions, _, triangles in leaves(self.folder / folder):
            for a, b, c in triangles:
                normal = cross(minus(positions[b], positions[a]), minus(positions[c], positions[a]))
                self.assertGreater(sum(p * q for p, q in zip(normal, positions[a])), 0)

    def files_of(self, folder):
        return {str(path.relative_to(self.folder / folder)): path.read_bytes() for path in (self.folder / folder).rglob("*") if path.is_file()}

    def assert_refused(self, words, *arguments, code=2):
        done = self.run_tool("tiles", *arguments, "-o", "bad")
        self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (code, "", 1), done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)
        self.assertFalse((self.folder / "bad").exists())

    def test_within_a_millimetre(self):
        points = grid()
        self.write_ply("utm.ply", points)
        told = self.tiles("utm.ply", "--crs", "EPSG:32633")
        self.assert_places(on_earth("EPSG:32633", points), most=2.5e-4)
        self.assert_upright()
        self.assertEqual((told["up"], told["crs"], told["heights"]), ("z", "WGS 84 / UTM zone 33N", "above the WGS84 ellipsoid"))
        self.assertAlmostEqual(told["longitude_deg"], 15, delta=0.001)
        self.assertAlmostEqual(told["height_m"], UTM[2], delta=1)

    def test_the_same_bytes(self):
        """Whatever the number of threads, the memory, and the axis of heights."""
        points = grid()
        normals = [unit((math.sin(i), math.cos(i), 3)) for i in range(len(points))]
        self.write_ply("utm.ply", points, normals=normals)
        self.tiles("utm.ply", "--crs", "EPSG:32633", "--threads", 1)
        files = self.files_of("tiles")
        for options in (["--threads", 5], ["--memory", "64M", "--threads", 3]):
            self.tiles("utm.ply", "--crs", "EPSG:32633", *options, folder="again")
            self.assertEqual(self.files_of("again"), files, options)
        self.write_ply("y.ply", [(x, z, -y) for x, y, z in points], normals=[(x, z, -y) for x, y, z in normals])
        for options in ([], ["--memory", "64M"]):
            self.assertEqual(self.tiles("y.ply", "--crs", "EPSG:32633", "--up", "y", *options, folder="again")["up"], "y")
            self.assertEqual(self.files_of("again"), files, options)

    def test_whole_coordinates(self):
        """Floats hold them exactly, so that they are read without an origin."""
        points = [(499_000 + 20 * x, 5_399_000 + 20 * y, (x * y) % 7) for y in range(SIDE + 1) for x in range(SIDE + 1)]
        self.write_ply("utm.ply", points, form="f")
        for options in ([], ["--memory", "64M"]):
            self.tiles("utm.ply", "--crs", "EPSG:32633", *options)
            self.assert_places(on_earth("EPSG:32633", points), most=2.5e-4)

    def test_two_meshes(self):
        west, east = grid(side=20), grid((UTM[0] + 20 * STEP, UTM[1], UTM[2]), side=20)
        self.write_ply("west.ply", west, faces(20))
        self.write_ply("east.ply", east, faces(20))
        self.tiles("west.ply", "east.ply", "--crs", "EPSG:32633")
        self.assert_places(on_earth("EPSG:32633", west + east))
        files = self.files_of("tiles")
        self.tiles("west.ply", "east.ply", "--crs", "EPSG:32633", "--memory", "64M", folder="again")
        self.assertEqual(self.files_of("again"), files)

    def test_normals(self):
        """At the rim of the zone, where north of the map is 2.3 degrees off: they stand on the surface as on the map."""
        at, side = (722_000.0, 5_400_000.0, 500.0), 30
        points = grid(at, side=side)
        normals = [unit((math.sin(i), math.cos(3 * i), 1.5)) for i in range(len(points))]
        self.write_ply("utm.ply", points, faces(side), normals=normals)
        self.tiles("utm.ply", "--crs", "EPSG:32633")
        around = []
        for point, normal in zip(points, normals):
            u = unit(cross(normal, (0, 0, 1)))
            around += [point, [p + d for p, d in zip(point, u)], [p + d for p, d in zip(point, cross(normal, u))]]
        placed = on_earth("EPSG:32633", around)
        expected = [unit(cross(minus(u, at), minus(v, at))) for at, u, v in zip(placed[::3], placed[1::3], placed[2::3])]
        self.assertGreater(max(angle(*pair) for pair in zip(expected, expected[1:])), 0.5)
        places, count = Places(placed[::3]), 0
        for positions, turned, _ in leaves(self.folder / "tiles"):
            for position, normal in zip(positions, turned, strict=True):
                self.assertLess(angle(normal, expected[places.nearest(position)[1]]), 1e-5)
                count += 1
        self.assertGreaterEqual(count, len(points))

    def test_heights_above_the_sea(self):
        points = grid(side=20)
        self.write_ply("utm.ply", points, faces(20))
        told = self.tiles("utm.ply", "--crs", "EPSG:32633+5773")
        self.assertEqual(told["heights"], "EGM96 height")
        self.assert_places(on_earth("EPSG:32633+5773", points))
        self.assertGreater(told["height_m"], UTM[2] + 40)  # the geoid there
        # Without the grid of the geoid it says so.
        for folder in subprocess.run(["projinfo", "--searchpaths"], capture_output=True, text=True, check=True).stdout.split("\n"):
            if (pathlib.Path(folder) / "proj.db").exists():
                (self.folder / "proj").mkdir()
                shutil.copy(pathlib.Path(folder) / "proj.db", self.folder / "proj")
                break
        self.environment.update(PROJ_DATA=str(self.folder / "proj"), PROJ_LIB=str(self.folder / "proj"))
        self.assert_refused(["--crs", "needs the grid us_nga_egm96_15.tif", "projsync"], "utm.ply", "--crs", "EPSG:32633+5773")
        self.tiles("utm.ply", "--crs", "EPSG:32633")
        self.environment.update(PROJ_DATA=str(self.folder), PROJ_LIB=str(self.folder))
        self.assert_refused(["proj.db", "install proj-data"], "utm.ply", "--crs", "EPSG:32633")

    def test_feet(self):
        """Heights have the unit of x and y."""
        points = [(x, y, 3 * z) for x, y, z in grid((1_000_010.3, 200_020.7, 30), 60.3, 20)]
        self.write_ply("feet.ply", points, faces(20))
        told = self.tiles("feet.ply", "--crs", "EPSG:2263")
        self.assert_places(on_earth("EPSG:2263", [(x, y, z * FEET) for x, y, z in points]))
        self.assertAlmostEqual(told["height_m"], 90 * FEET, delta=5)

    def test_other_axes(self):
        """North first by its code, but x points east in meshes; then axes to the south and west, a mirror image."""
        points = grid((3_500_000.3, 5_400_000.7, 400), side=20)
        self.write_ply("north.ply", points, faces(20))
        self.tiles("north.ply", "--crs", "EPSG:31467")
        self.assert_places(on_earth("EPSG:31467", [(y, x, z) for x, y, z in points]))
        self.assert_upright()
        points = grid((1_043_000.3, 743_000.7, 300), side=20)
        normals = [(0, 0, 1)] * len(points)
        self.write_ply("south.ply", points, faces(20), normals=normals)
        self.tiles("south.ply", "--crs", "EPSG:5513")
        self.assert_places(on_earth("EPSG:5513", points))
        self.assert_upright()
        for positions, turned, _ in leaves(self.folder / "tiles"):
            self.assertLess(max(angle(*pair) for pair in zip(positions, turned)), 0.01)

    def test_axes_the_other_way_round(self):
        points = grid(side=10)
        self.write_ply("utm.ply", points, faces(10))
        done = self.run_tool("tiles", "utm.ply", "-o", "tiles", "--crs", "EPSG:25833")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.write_ply("turned.ply", [(y, x, z) for x, y, z in points], faces(10))
        done = self.run_tool("tiles", "turned.ply", "-o", "turned", "--crs", "EPSG:32633")
        self.assertEqual((done.returncode, done.stderr.count("\n")), (0, 1), done.stderr)
        self.assertIn("outside the area of WGS 84 / UTM zone 33N", done.stderr)

    def test_mistakes(self):
        for code, word in (("EPSG:999999", "is no coordinate system"), ("nonsense", "is no coordinate system"),
                           ("EPSG:4326", "is geographic, in degrees"), ("EPSG:4979", "is geographic"), ("EPSG:4978", "is earth-centred"),
                           ("EPSG:4326+5773", "is geographic"), ("EPSG:5773", "is no projected system")):
            self.assert_refused(["--crs", code, word], "none.ply", "--crs", code)
        self.assert_refused(["--crs"], "none.ply", "--crs", "")
        self.assert_refused(["--crs", "--origin"], "none.ply", "--crs", "EPSG:32633", "--origin", "11.5,48.1,520")
        points = grid(side=4)
        self.write_ply("far.ply", points[:-1] + [(9e8, 5e6, 0)], faces(4))
        for options in ([], ["--memory", "64M"]):
            self.assert_refused(["far.ply", "lies beyond what WGS 84 / UTM zone 33N can reach", "check --crs"], "far.ply", "--crs", "EPSG:32633", *options, code=1)
        self.write_ply("utm.ply", points, faces(4))
        self.succeed("hlod", "build", "utm.ply", "-o", "utm.ohlod", "--grouping", "nested", "--borders", "free")
        self.assert_refused(["--crs: goes with meshes only"], "utm.ohlod", "--crs", "EPSG:32633")


class WithoutProj(ToolTest):
    def test_says_what_to_install(self):
        done = self.run_tool("tiles", "none.ply", "-o", "bad", "--crs", "EPSG:32633")
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
        self.assertIn("install libproj-dev", done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=1)
