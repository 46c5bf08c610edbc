"""Makes and reads glTF files with nothing but JSON and struct, to check what occlod makes of them."""
import base64
import json
import pathlib
import struct
import urllib.parse

LETTERS = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
PNG = base64.b64decode("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==")
WEBP = b"RIFF\x1a\0\0\0WEBPVP8L\x0d\0\0\0\x2f\0\0\0\x10\x07\x10\x11\x11\x88\x88\xfe\x07\0"
KTX2 = b"\xabKTX 20\xbb\r\n\x1a\n" + bytes(68)
SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
CORNERS = [(0,), (1,), (2,), (0,), (2,), (3,)]


class Model:
    """A file with one square of two triangles; tests change `json` before it is written."""

    def __init__(self):
        self.bytes = b""
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "accessors": [], "bufferViews": []}
        self.primitive = {"attributes": {"POSITION": self.accessor(SQUARE), "TEXCOORD_0": self.accessor([(0, 1), (1, 1), (1, 0), (0, 0)], kind="VEC2")},
                          "indices": self.accessor(CORNERS, 5123, "SCALAR")}
        self.json["meshes"] = [{"primitives": [self.primitive]}]

    def view(self, data):
        self.bytes += bytes(-len(self.bytes) % 4)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(data)})
        self.bytes += data
        return len(self.json["bufferViews"]) - 1

    def accessor(self, values, component=5126, kind="VEC3", **more):
        data = b"".join(struct.pack(f"<{len(value)}{LETTERS[component]}", *value) for value in values)
        described = {"bufferView": self.view(data), "componentType": component, "count": len(values), "type": kind, **more}
        if component == 5126 and kind == "VEC3":
            described.update(min=[min(column) for column in zip(*values)], max=[max(column) for column in zip(*values)])
        self.json["accessors"].append(described)
        return len(self.json["accessors"]) - 1

    def texture(self, data=PNG, mime="image/png", **texture):
        """Adds an image with a texture, or with what else names it; returns the number of the texture."""
        images, textures = (self.json.setdefault(key, []) for key in ("images", "textures"))
        images.append({"bufferView": self.view(data), "mimeType": mime})
        textures.append(texture or {"source": len(images) - 1})
        return len(textures) - 1

    def material(self, **material):
        self.json.setdefault("materials", []).append(material)
        self.primitive["material"] = len(self.json["materials"]) - 1

    def use(self, *extensions, required=False):
        self.json.setdefault("extensionsUsed", []).extend(extensions)
        if required:
            self.json.setdefault("extensionsRequired", []).extend(extensions)

    def write_glb(self, path, text=None):
        text = (text or json.dumps(dict(self.json, buffers=[{"byteLength": len(self.bytes)}]))).encode()
        text += b" " * (-len(text) % 4)
        data = self.bytes + bytes(-len(self.bytes) % 4)
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data)) + struct.pack("<I4s", len(text), b"JSON") + text
                         + struct.pack("<I4s", len(data), b"BIN\0") + data)

    def write_text(self, path, head="data:application/octet-stream;base64,"):
        path.write_text(json.dumps(dict(self.json, buffers=[{"byteLength": len(self.bytes), "uri": head + base64.b64encode(self.bytes).decode()}])))


class Read:
    """A GLB file of one node: its JSON, the corners of its triangles in world space, and its images."""

    def __init__(self, path):
        data = pathlib.Path(path).read_bytes()
        size, = struct.unpack_from("<I", data, 12)
        self.json, self.buffer, self.folder = json.loads(data[20:20 + size]), data[28 + size:], pathlib.Path(path).parent
        node = self.json["nodes"][0]
        move, scale = node.get("translation", [0, 0, 0]), node.get("scale", [1, 1, 1])
        self.triangles, self.attributes = [], set()
        for primitive in self.json["meshes"][0]["primitives"]:
            at = primitive["attributes"]
            self.attributes |= set(at)
            places = [tuple(m + s * x for m, s, x in zip(move, scale, value)) for value in self.values(at["POSITION"])]
            corners = [places[i] for i, in self.values(primitive["indices"])]
            self.triangles += [tuple(corners[k:k + 3]) for k in range(0, len(corners), 3)]

    def values(self, index):
        accessor = self.json["accessors"][index]
        view, letter, count = self.json["bufferViews"][accessor["bufferView"]], LETTERS[accessor["componentType"]], WIDTHS[accessor["type"]]
        stride = view.get("byteStride", struct.calcsize(letter) * count)
        return [struct.unpack_from(f"<{count}{letter}", self.buffer, view.get("byteOffset", 0) + i * stride) for i in range(accessor["count"])]

    def image(self, index):
        image = self.json["images"][index]
        if "uri" in image:
            return (self.folder / urllib.parse.unquote(image["uri"])).read_bytes()
        view = self.json["bufferViews"][image["bufferView"]]
        return self.buffer[view["byteOffset"]:view["byteOffset"] + view["byteLength"]]

    def corner_set(self):
        return {tuple(round(x, 4) + 0.0 for x in corner) for triangle in self.triangles for corner in triangle}
