#!/usr/bin/env python3
"""tileset_check.py FOLDER [--json]: checks a tileset of `occlod hlod export` against every rule of 3D Tiles 1.1 and glTF 2.0 that it makes use of, and
against what docs/guide/tiles.md promises. Independent of our own code: it reads the bytes with Python's library. Prints what is wrong; exit 1 then.

Compressed contents (EXT_meshopt_compression) are checked as far as that is possible without decoding; positions then come from the accessors' bounds."""
import json
import math
import pathlib
import struct
import sys
import urllib.parse

COMPONENTS = {5120: ("b", 1), 5121: ("B", 1), 5122: ("h", 2), 5123: ("H", 2), 5125: ("I", 4), 5126: ("f", 4)}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
TILE_KEYS = {"boundingVolume", "geometricError", "refine", "transform", "content", "children"}
SLACK = 1e-9  # of the largest coordinate, for sums of centres and half axes


class Wrong(Exception):
    pass


def require(condition, message):
    if not condition:
        raise Wrong(message)


def only_keys(value, what, required, allowed=()):
    require(isinstance(value, dict), f"{what} is not an object")
    for key in required:
        require(key in value, f"{what} has no {key}")
    for key in value:
        require(key in {*required, *allowed}, f"{what} has an unknown key {key}")


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def box_of(volume, what):
    """(min, max) of a boundingVolume: our boxes are aligned with the axes."""
    only_keys(volume, what, ["box"])
    box = volume["box"]
    require(isinstance(box, list) and len(box) == 12 and all(map(is_number, box)), f"{what}.box is not 12 numbers")
    for axis in range(3):
        for row in range(3):
            value = box[3 + 3 * axis + row]
            require(value > 0 if axis == row else value == 0, f"{what}.box has a half axis that is flat, mirrored or not along an axis")
    return tuple(box[k] - box[3 + 4 * k] for k in range(3)), tuple(box[k] + box[3 + 4 * k] for k in range(3))


def is_inside(inner, outer):
    slack = SLACK * max(map(abs, (*outer[0], *outer[1], 1e-300)))
    return all(inner[0][k] >= outer[0][k] - slack and inner[1][k] <= outer[1][k] + slack for k in range(3))


class Glb:
    """A content: its triangles are counted, and its vertices are read where they are not compressed."""

    def __init__(self, path):
        data = path.read_bytes()
        require(len(data) >= 20, "is cut short")
        magic, version, length = struct.unpack_from("<4sII", data)
        require(magic == b"glTF" and version == 2, "is no binary glTF 2.0")
        require(length == len(data) and length % 4 == 0, "has another length than its header says")
        json_length, kind = struct.unpack_from("<I4s", data, 12)
        require(kind == b"JSON" and json_length % 4 == 0 and 20 + json_length <= length, "has no JSON chunk first")
        self.gltf = json.loads(data[20:20 + json_length])
        binary = 20 + json_length
        require(binary + 8 <= length, "has no binary chunk")
        size, kind = struct.unpack_from("<I4s", data, binary)
        require(kind == b"BIN\0" and binary + 8 + size == length, "has a binary chunk of another size")
        self.bytes = data[binary + 8:]
        self.triangles = 0
        self.low, self.high = [math.inf] * 3, [-math.inf] * 3
        self.folder = path.parent
        self.check()

    def check(self):
        gltf = self.gltf
        require(gltf["asset"]["version"] == "2.0" and gltf["asset"]["generator"].startswith("occlod"), "asset is not ours")
        used, needed = gltf.get("extensionsUsed", []), gltf.get("extensionsRequired", [])
        require(sorted(used) == sorted(needed), "an extension is used and not required")
        require(set(used) <= {"EXT_meshopt_compression", "KHR_mesh_quantization"}, "an extension is unknown")
        self.is_compressed, self.is_quantised = "EXT_meshopt_compression" in used, "KHR_mesh_quantization" in used
        self.check_buffers()
        require(len(gltf["nodes"]) == 1 and len(gltf["meshes"]) == 1 and gltf["scenes"] == [{"nodes": [0]}], "is not one node of one mesh")
        for view in gltf["bufferViews"]:
            self.check_view(view)
        for accessor in gltf["accessors"]:
            self.check_accessor(accessor)
        for primitive in gltf["meshes"][0]["primitives"]:
            self.check_primitive(primitive)
        for image in gltf.get("images", []):
            require((self.folder / urllib.parse.unquote(image["uri"])).is_file(), f"image {image['uri']} is not there")
        for material in gltf["materials"]:
            require(material["pbrMetallicRoughness"].get("metallicFactor") == 0, "a material is metallic")
            texture = material["pbrMetallicRoughness"].get("baseColorTexture")
            require(texture is None or texture["index"] < len(gltf["textures"]), "a material names a texture that is not there")

    def check_buffers(self):
        buffers = self.gltf["buffers"]
        require(0 <= len(self.bytes) - buffers[0]["byteLength"] < 4, "the buffer has another size than the chunk")
        require(len(buffers) == (2 if self.is_compressed else 1), "there are too many or too few buffers")
        for buffer in buffers[1:]:
            require("uri" not in buffer and buffer["extensions"] == {"EXT_meshopt_compression": {"fallback": True}}, "the second buffer is no fallback")

    def check_view(self, view):
        buffer = self.gltf["buffers"][view["buffer"]]
        require(view["byteOffset"] % 4 == 0, "a buffer view is not aligned")
        require(view["byteOffset"] + view["byteLength"] <= buffer["byteLength"], "a buffer view leaves its buffer")
        require(view["target"] in (34962, 34963), "a buffer view has no target")
        if not self.is_compressed:
            return require(view["buffer"] == 0, "a buffer view has no bytes")
        packed = view["extensions"]["EXT_meshopt_compression"]
        require(view["buffer"] == 1 and packed["buffer"] == 0, "compressed bytes are in the wrong buffer")
        require(packed["byteOffset"] + packed["byteLength"] <= self.gltf["buffers"][0]["byteLength"], "compressed bytes leave their buffer")
        require(packed["count"] * packed["byteStride"] == view["byteLength"], "a compressed view decodes to another size")
        first = self.bytes[packed["byteOffset"]]
        if packed["mode"] == "ATTRIBUTES":
            require(first == 0xa0 and packed["byteStride"] % 4 == 0 and packed["byteStride"] <= 256, "vertices are not of codec version 0")
        else:
            require(packed["mode"] == "TRIANGLES" and first == 0xe1 and packed["byteStride"] in (2, 4), "indices are not of codec version 1")

    def check_accessor(self, accessor):
        view = self.gltf["bufferViews"][accessor["bufferView"]]
        letter, size = COMPONENTS[accessor["componentType"]]
        width = size * WIDTHS[accessor["type"]]
        stride = view.get("byteStride", width)
        require(view["target"] == 34963 or stride % 4 == 0, "vertices are not aligned")
        require(accessor["count"] > 0 and stride * (accessor["count"] - 1) + width <= view["byteLength"], "an accessor leaves its view")

    def values(self, index):
        accessor = self.gltf["accessors"][index]
        view = self.gltf["bufferViews"][accessor["bufferView"]]
        letter, size = COMPONENTS[accessor["componentType"]]
        count = WIDTHS[accessor["type"]]
        stride = view.get("byteStride", size * count)
        for i in range(accessor["count"]):
            yield struct.unpack_from(f"<{count}{letter}", self.bytes, view["byteOffset"] + i * stride)

    def check_primitive(self, primitive):
        accessors = self.gltf["accessors"]
        only_keys(primitive, "a primitive", ["attributes", "indices", "material"])
        require(primitive["material"] < len(self.gltf["materials"]), "a primitive names a material that is not there")
        attributes = primitive["attributes"]
        only_keys(attributes, "attributes", ["POSITION", "NORMAL"], ["COLOR_0", "TEXCOORD_0"])
        counts = {accessors[index]["count"] for index in attributes.values()}
        require(len(counts) == 1, "attributes have different counts")
        vertices = counts.pop()
        kinds = {"POSITION": [("VEC3", 5123)] if self.is_quantised else [("VEC3", 5126)],
                 "NORMAL": [("VEC3", 5120)] if self.is_quantised else [("VEC3", 5126)],
                 "COLOR_0": [("VEC4", 5123)],
                 "TEXCOORD_0": [("VEC2", 5126), ("VEC2", 5123)]}
        for name, index in attributes.items():
            accessor = accessors[index]
            require((accessor["type"], accessor["componentType"]) in kinds[name], f"{name} has an unexpected type")
            is_integer = accessor["componentType"] != 5126
            require(accessor.get("normalized", False) == (is_integer and name != "POSITION"), f"{name} is normalized and should not be, or the other way")
        indices = accessors[primitive["indices"]]
        require(indices["type"] == "SCALAR" and indices["count"] % 3 == 0, "indices are no triangles")
        require(indices["componentType"] == (5123 if vertices < 65535 else 5125), "indices are wider or narrower than they need be")
        self.triangles += indices["count"] // 3
        self.check_bounds(accessors[attributes["POSITION"]], attributes["POSITION"])
        if self.is_compressed:
            return
        used = [value for value, in self.values(primitive["indices"])]
        require(set(used) == set(range(vertices)), "indices leave the vertices, or vertices are not used")
        for normal in self.values(attributes["NORMAL"]):
            length = math.hypot(*normal) / (127 if self.is_quantised else 1)
            require(abs(length - 1) < (0.02 if self.is_quantised else 1e-3), "a normal has another length than 1")

    def check_bounds(self, accessor, index):
        """Of the vertices, in the tile's axes: z up."""
        low, high = accessor["min"], accessor["max"]
        if not self.is_compressed:
            values = list(self.values(index))
            require(low == [min(v[k] for v in values) for k in range(3)] and high == [max(v[k] for v in values) for k in range(3)], "min and max are not those of the positions")
        node = self.gltf["nodes"][0]
        scale, move = node.get("scale", [1, 1, 1]), node["translation"]
        low, high = ([scale[k] * v[k] + move[k] for k in range(3)] for v in (low, high))
        for k, (a, b) in enumerate(((low[0], high[0]), (-high[2], -low[2]), (low[1], high[1]))):
            self.low[k], self.high[k] = min(self.low[k], a), max(self.high[k], b)


class Checker:
    def __init__(self, folder, most_tiles=None):
        self.folder = pathlib.Path(folder).resolve()
        self.most_tiles = most_tiles
        self.found = {"tilesets": 0, "tiles": 0, "contents": 0, "leaves": 0, "triangles": 0, "leaf_triangles": 0, "content_bytes": 0, "depth": 0}
        self.seen = set()

    def run(self):
        root = self.tileset("tileset.json", None, None, 0)
        require(root, "there are no tiles")
        files = {path.relative_to(self.folder).as_posix() for path in self.folder.rglob("*") if path.is_file()}
        left = sorted(name for name in files - self.seen if not name.startswith("textures/"))
        require(not left, f"{left[:1]} is not part of the tileset")
        return self.found

    def open(self, uri, base):
        require(isinstance(uri, str) and uri, "a uri is empty")
        require("://" not in uri and not uri.startswith("/") and "\\" not in uri, f"{uri} is no relative uri")
        path = (base / urllib.parse.unquote(uri)).resolve()
        require(path.is_relative_to(self.folder), f"{uri} leaves the folder")
        require(path.is_file(), f"{uri} is not there")
        name = path.relative_to(self.folder).as_posix()
        require(name not in self.seen, f"{uri} is used twice")
        self.seen.add(name)
        return path

    def tileset(self, uri, parent, parent_error, depth):
        path = self.open(uri, self.folder)
        try:
            tileset = json.loads(path.read_text(encoding="utf-8"), parse_constant=lambda text: require(False, f"{text} is no number"))
        except json.JSONDecodeError as error:
            raise Wrong(f"{uri} is no JSON: {error}") from error
        only_keys(tileset, uri, ["asset", "geometricError", "root"])
        only_keys(tileset["asset"], "asset", ["version", "extras"])
        require(tileset["asset"]["version"] == "1.1", "asset.version is not 1.1")
        self.found["tilesets"] += 1
        root = tileset["root"]
        require(isinstance(root, dict) and root.get("refine") == "REPLACE", f"{uri}: the root does not say refine: REPLACE")
        self.in_file = 0
        is_error = is_number(tileset["geometricError"]) and tileset["geometricError"] >= root.get("geometricError", math.inf)
        require(is_error, f"{uri}: geometricError is not above the root's")
        if parent is not None:  # repeats the tile that refers to it
            require(root["geometricError"] == parent_error and box_of(root["boundingVolume"], "root") == parent, f"{uri}: the root is not the tile that refers to it")
        externals = []
        self.tile(root, None, None, depth, path.parent, externals, is_root=True)
        require(self.most_tiles is None or self.in_file <= self.most_tiles, f"{uri} holds {self.in_file} tiles")
        for next_uri, box, error, at in externals:
            self.tileset(next_uri, box, error, at)
        return root

    def tile(self, tile, parent_box, parent_error, depth, base, externals, is_root=False):
        only_keys(tile, "a tile", ["boundingVolume", "geometricError"], TILE_KEYS)
        self.in_file += 1
        self.found["depth"] = max(self.found["depth"], depth)
        require(is_root or "refine" not in tile and "transform" not in tile, "a tile below the root has refine or transform")
        if "transform" in tile:
            self.transform(tile["transform"])
        box = box_of(tile["boundingVolume"], "boundingVolume")
        error = tile["geometricError"]
        require(is_number(error) and error >= 0, "geometricError is no number of at least 0")
        require(parent_error is None or error < parent_error, "geometricError is not less than the parent's")
        require(parent_box is None or is_inside(box, parent_box), "boundingVolume leaves the parent's")
        require("children" not in tile or (isinstance(tile["children"], list) and tile["children"]), "children are no list, or an empty one")
        children = tile.get("children", [])
        require("content" in tile or children, "a leaf has no content")
        if "content" in tile:
            uri = tile["content"].get("uri")
            if isinstance(uri, str) and uri.endswith(".json"):
                only_keys(tile["content"], "content", ["uri"])
                require(not children, "a tile with an external tileset has children")
                return externals.append((uri, box, error, depth))
            self.content(tile["content"], box, base, is_leaf=not children)
        require(bool(children) == (error > 0), "geometricError is 0 above children, or not 0 at a leaf")
        self.found["tiles"] += 1
        for child in children:
            self.tile(child, box, error, depth + 1, base, externals)

    def content(self, content, tile_box, base, is_leaf):
        only_keys(content, "content", ["uri", "boundingVolume"])
        box = box_of(content["boundingVolume"], "content.boundingVolume")
        require(is_inside(box, tile_box), "content.boundingVolume leaves the tile's")
        path = self.open(content["uri"], base)
        try:
            glb = Glb(path)
        except (Wrong, KeyError, IndexError, TypeError, ValueError, struct.error) as error:
            raise Wrong(f"{content['uri']}: {type(error).__name__} {error}") from error
        low, high = glb.low, glb.high
        require(is_inside((low, high), box), f"{content['uri']}: vertices leave content.boundingVolume")
        thickness = 2e-6 * max(*(high[k] - low[k] for k in range(3)), 1e-6 * max(map(abs, (*low, *high)))) + 1e-6 * (low == high)
        for k in range(3):
            slack = thickness + SLACK * max(abs(low[k]), abs(high[k]))
            require(box[0][k] >= low[k] - slack and box[1][k] <= high[k] + slack, f"{content['uri']}: content.boundingVolume is not tight")
        self.found["contents"] += 1
        self.found["leaves"] += is_leaf
        self.found["triangles"] += glb.triangles
        self.found["leaf_triangles"] += glb.triangles * is_leaf
        self.found["content_bytes"] += path.stat().st_size

    @staticmethod
    def transform(matrix):
        require(isinstance(matrix, list) and len(matrix) == 16 and all(map(is_number, matrix)), "transform is not 16 numbers")
        columns = [matrix[4 * k:4 * k + 4] for k in range(4)]
        require([column[3] for column in columns] == [0, 0, 0, 1], "transform is not affine")
        x, y, z = (column[:3] for column in columns[:3])
        for a, b, dot in ((x, x, 1), (y, y, 1), (z, z, 1), (x, y, 0), (y, z, 0), (x, z, 0)):
            require(abs(sum(p * q for p, q in zip(a, b)) - dot) < 1e-12, "transform does more than rotate and move")
        cross = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]]
        require(sum(p * q for p, q in zip(cross, z)) > 0, "transform mirrors")


def check(folder, most_tiles=None):
    """What was found, as a dictionary; raises Wrong."""
    return Checker(folder, most_tiles).run()


def main():
    folders = [argument for argument in sys.argv[1:] if not argument.startswith("--")]
    if len(folders) != 1:
        sys.exit("usage: tileset_check.py FOLDER [--json]")
    try:
        found = check(folders[0])
    except Wrong as error:
        sys.exit(f"{folders[0]}: {error}")
    print(json.dumps(found) if "--json" in sys.argv else "\n".join(f"{key:16} {value}" for key, value in found.items()))


if __name__ == "__main__":
    main()
