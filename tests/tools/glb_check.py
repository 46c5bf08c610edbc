"""Contents of tilesets: binary glTF 2.0 as `occlod tiles` writes it. Of compressed ones (EXT_meshopt_compression) all is checked that can be
without decoding; positions then come from the bounds of accessors."""
import math
import struct
import urllib.parse

import json_place

COMPONENTS = {5120: ("b", 1), 5121: ("B", 1), 5122: ("h", 2), 5123: ("H", 2), 5125: ("I", 4), 5126: ("f", 4)}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
WRAPS = {33071, 33648, 10497}  # of textures: clamp, mirror, repeat
MESHOPT = "EXT_meshopt_compression"
FEATURES = {"EXT_mesh_features", "EXT_structural_metadata"}
OPTIONAL = {"KHR_texture_transform", "KHR_materials_unlit"} | FEATURES
IMAGES = {"image/webp": "EXT_texture_webp", "image/ktx2": "KHR_texture_basisu", "image/vnd-ms.dds": "MSFT_texture_dds", "image/avif": "EXT_texture_avif"}


def require_used(items, names, once=False):
    """Each item is what some of the names, which are indices, name; where said, one."""
    names = [name.value for name in names]
    for k, item in enumerate(items):
        item.require(k in names, "is not used")
        item.require(not once or names.count(k) == 1, "is used twice")


class Glb:
    """Reads and checks; Wrong names `file`. `triangles` are counted; `low` and `high` bound the vertices in the tile's axes, z up."""

    def __init__(self, path, file):
        self.folder, self.triangles, self.names = path.parent, 0, None
        self.low, self.high = [math.inf] * 3, [-math.inf] * 3
        self.read(path, file)
        self.check()

    def read(self, path, file):
        whole = json_place.Place(None, file)
        try:
            data = path.read_bytes()
        except OSError as error:
            whole.fail(f"cannot be read: {error.strerror}")
        whole.require(len(data) >= 20, "is cut short")
        magic, version, length = struct.unpack_from("<4sII", data)
        whole.require(magic == b"glTF" and version == 2, "is no binary glTF 2.0")
        whole.require(length == len(data) and length % 4 == 0, "has another length than its header says")
        json_length, kind = struct.unpack_from("<I4s", data, 12)
        binary = 20 + json_length
        whole.require(kind == b"JSON" and json_length % 4 == 0 and binary <= length, "has no JSON chunk first")
        whole.require(binary + 8 <= length, "has no binary chunk")
        size, kind = struct.unpack_from("<I4s", data, binary)
        whole.require(kind == b"BIN\0" and binary + 8 + size == length, "has a binary chunk of another size")
        self.gltf = json_place.parse(data[20:binary], file)
        self.bytes = data[binary + 8:]

    def check(self):
        gltf = self.gltf
        gltf.object(["asset", "nodes", "meshes", "scenes", "buffers", "bufferViews", "accessors", "materials"])
        gltf["asset"].require(gltf["asset"]["version"].value == "2.0" and gltf["asset"]["generator"].text().startswith("occlod"), "is not ours")
        used, needed = (sorted(item.text() for item in gltf[key].list()) if key in gltf else [] for key in ("extensionsUsed", "extensionsRequired"))
        gltf.require([name for name in used if name not in OPTIONAL] == needed, "an extension is used and not required")
        gltf.require(len(used) == len(set(used)) and set(used) <= {MESHOPT, "KHR_mesh_quantization"} | OPTIONAL | set(IMAGES.values()), "an extension is unknown")
        self.is_compressed, self.is_quantised = MESHOPT in used, "KHR_mesh_quantization" in used
        self.buffers, self.views, self.accessors, self.materials = (gltf[key].list() for key in ("buffers", "bufferViews", "accessors", "materials"))
        nodes, meshes = gltf["nodes"].list(), gltf["meshes"].list()
        is_one = len(nodes) == 1 and len(meshes) == 1 and nodes[0]["mesh"].integer() == 0 and gltf["scenes"].value == [{"nodes": [0]}]
        gltf.require(is_one, "is not one node of one mesh")
        self.node = nodes[0].object(["mesh", "translation"], ["scale"])
        self.check_buffers()
        for view in self.views:
            self.check_view(view)
        for accessor in self.accessors:
            self.check_accessor(accessor)
        tables = self.check_table() if FEATURES & set(used) else []
        primitives = meshes[0]["primitives"].list()
        meshes[0].require(primitives, "has no primitives")
        for primitive in primitives:
            self.check_primitive(primitive)
        self.check_materials()
        named = [name for primitive in primitives for name in (primitive["indices"], *(primitive["attributes"][key] for key in primitive["attributes"].value))]
        require_used(self.accessors, named, once=True)
        images = self.gltf["images"].list() if "images" in self.gltf else []
        views = [owner["bufferView"] for owner in (*self.accessors, *images) if "bufferView" in owner] + tables
        require_used(self.views, views, once=True)
        require_used(self.materials, (primitive["material"] for primitive in primitives))

    def check_table(self):
        """The table of features: their ids and names. Returns what names its buffer views."""
        metadata = self.gltf["extensions"].object(["EXT_structural_metadata"], [])["EXT_structural_metadata"].object(["schema", "propertyTables"], [])
        classes = metadata["schema"].object(["id", "classes"], [])["classes"].object(["feature"], [])
        properties = classes["feature"].object(["properties"], [])["properties"].object(["id", "name"], [])
        is_ours = properties["id"].value == {"type": "SCALAR", "componentType": "UINT32", "required": True} \
            and properties["name"].value == {"type": "STRING", "required": True, "semantic": "NAME"}
        properties.require(is_ours, "are not those of features")
        tables = metadata["propertyTables"].list()
        metadata["propertyTables"].require(len(tables) == 1, "are not one")
        table = tables[0].object(["class", "count", "properties"], [])
        table["class"].require(table["class"].value == "feature", "is unknown")
        count = table["count"].integer(1)
        columns = table["properties"].object(["id", "name"], [])
        ids, names = columns["id"].object(["values"], [])["values"], columns["name"].object(["values", "stringOffsets", "stringOffsetType"], [])
        names["stringOffsetType"].require(names["stringOffsetType"].value == "UINT32", "is not that of our offsets")
        numbers, offsets = (struct.unpack(f"<{length}I", self.bytes_of(place, 4 * length)) for place, length in ((ids, count), (names["stringOffsets"], count + 1)))
        ids.require(sorted(set(numbers)) == list(numbers), "are not ascending")
        text = self.bytes_of(names["values"])
        names.require(offsets[0] == 0 and sorted(offsets) == list(offsets) and offsets[-1] in (len(text), len(text) - (len(text) == 1)), "are not divided by their offsets")
        try:
            self.names = [text[a:b].decode() for a, b in zip(offsets, offsets[1:])]
        except UnicodeDecodeError:
            names.fail("are no UTF-8")
        return [ids, names["values"], names["stringOffsets"]]

    def bytes_of(self, place, size=None):
        """What the buffer view has that a place names; of that size, if any is given."""
        view = place.index_in(self.views, "a buffer view")
        first, length = view["byteOffset"].value, view["byteLength"].value
        place.require("target" not in view and first % 8 == 0 and size in (None, length), "names no view of its size for itself alone")
        return self.bytes[first:first + length]

    def check_features(self, primitive, accessor):
        ids = primitive["extensions"].object(["EXT_mesh_features"], [])["EXT_mesh_features"].object(["featureIds"], [])["featureIds"].list()
        primitive.require(len(ids) == 1 and self.names is not None, "has not one set of features, with a table")
        described = ids[0].object(["featureCount", "attribute", "propertyTable"], [])
        described.require(described["attribute"].value == 0 and described["propertyTable"].value == 0, "names another attribute or table")
        count = described["featureCount"].integer(1)
        described.require(count <= len(self.names), "counts more features than the table has")
        if self.is_compressed:
            return
        rows = {row for row, in self.values(accessor)}
        described.require(len(rows) == count and max(rows) < len(self.names), "counts other features than vertices have")

    def check_materials(self):
        gltf = self.gltf
        images, textures, samplers = (gltf[key].list() if key in gltf else [] for key in ("images", "textures", "samplers"))
        for image in images:
            if "bufferView" in image:
                self.check_own_image(image.object(["bufferView", "mimeType"], []))
                continue
            uri = image.object(["uri"], ["mimeType"])["uri"]
            image.require("mimeType" not in image or image["mimeType"].value in IMAGES, "has a type that needs no extension")
            try:
                is_there = (self.folder / urllib.parse.unquote(uri.text())).is_file()
            except (OSError, ValueError):  # too long, or bytes that no path may have
                is_there = False
            uri.require(is_there, f"{json_place.quoted(uri.value)} is not there")
        for sampler in samplers:
            sampler.object(["wrapS", "wrapT"], ["minFilter", "magFilter"])
            for key in ("wrapS", "wrapT"):
                sampler[key].require(type(sampler[key].value) is int and sampler[key].value in WRAPS, "is no way to wrap")
        for texture in textures:
            texture.object(["sampler"], ["source", "extensions"])["sampler"].index_in(samplers, "a sampler")
            texture.require(("source" in texture) != ("extensions" in texture), "has no image, or two")
            image = self.source_of(texture).index_in(images, "an image")
            needed = [IMAGES[image["mimeType"].value]] if "mimeType" in image and image["mimeType"].value in IMAGES else []
            texture.require(list(texture["extensions"].value if "extensions" in texture else []) == needed, "has not the extension of its image")
        for material in self.materials:
            self.check_material(material, textures)
        require_used(images, (self.source_of(texture) for texture in textures))
        require_used(samplers, (texture["sampler"] for texture in textures))
        owners = [owner for material in self.materials for owner in (material, material["pbrMetallicRoughness"])]
        require_used(textures, (owner[key]["index"] for owner in owners for key in owner.value if key.endswith("Texture")))

    def check_own_image(self, image):
        view = image["bufferView"].index_in(self.views, "a buffer view")
        image.require("target" not in view, "lies in a view of vertices or indices")
        begin = self.bytes[view["byteOffset"].value:][:48]
        kinds = {"image/png": b"\x89PNG\r\n\x1a\n", "image/jpeg": b"\xff\xd8", "image/ktx2": b"\xabKTX 20\xbb\r\n\x1a\n"}
        image["mimeType"].require(image["mimeType"].value in kinds, "is neither PNG nor JPEG nor KTX2")
        image.require(begin.startswith(kinds[image["mimeType"].value]), "has bytes of another type")
        if image["mimeType"].value == "image/ktx2":
            width, height, _, _, _, sizes, supercompression = struct.unpack("<7I", begin[20:48])
            is_whole = width % 4 == 0 and height % 4 == 0 and sizes == max(width, height).bit_length()
            image.require(is_whole and supercompression == 1, "has not whole blocks, all sizes and BasisLZ")

    @staticmethod
    def source_of(texture):
        """The number of its image."""
        return texture["source"] if "source" in texture else texture["extensions"][next(iter(texture["extensions"].value))]["source"]

    def check_material(self, material, textures):
        maps = ["normalTexture", "occlusionTexture", "emissiveTexture"]
        material.object(["pbrMetallicRoughness", "doubleSided"], ["name", "alphaMode", "alphaCutoff", "emissiveFactor", "extensions", *maps])
        material["doubleSided"].require(material["doubleSided"].value is True, "is not true")
        if "name" in material:
            material["name"].text()
        look = material["pbrMetallicRoughness"].object(["baseColorFactor", "metallicFactor"], ["roughnessFactor", "baseColorTexture", "metallicRoughnessTexture"])
        for key in ("metallicFactor", "roughnessFactor"):
            look.require(key not in look or 0 <= look[key].number() <= 1, "has a factor outside [0, 1]")
        color = look["baseColorFactor"].numbers(4)
        look["baseColorFactor"].require(all(0 <= c <= 1 for c in color), "is no color")
        mode = material["alphaMode"].value if "alphaMode" in material else "OPAQUE"
        material.require(mode in ("BLEND", "MASK") or (mode == "OPAQUE" and color[3] == 1), "is opaque and has an alpha below 1")
        material.require("alphaCutoff" not in material or mode == "MASK", "cuts alpha that it does not mask")
        for owner, keys in ((look, ("baseColorTexture", "metallicRoughnessTexture")), (material, maps)):
            for key in keys:
                if key in owner:
                    owner[key].object(["index"], ["scale", "strength", "extensions"])["index"].index_in(textures, "a texture")

    def check_buffers(self):
        buffers = self.gltf["buffers"]
        buffers.require(len(self.buffers) == (2 if self.is_compressed else 1), "are too many or too few")
        self.sizes = [buffer.object(["byteLength"], ["extensions"])["byteLength"].integer(1) for buffer in self.buffers]
        self.buffers[0].require(0 <= len(self.bytes) - self.sizes[0] < 4, "has another size than the chunk")
        for buffer in self.buffers[1:]:
            buffer.require(buffer["extensions"].value == {MESHOPT: {"fallback": True}}, "is no fallback")

    def check_range(self, view, alignment):
        """Where the view's bytes begin; they stay in its buffer."""
        size = view["buffer"].index_in(self.sizes, "a buffer")
        first, length = view["byteOffset"].integer(), view["byteLength"].integer(1)
        view.require(first % alignment == 0, "is not aligned")
        view.require(first + length <= size, "leaves its buffer")
        return first

    def check_view(self, view):
        self.check_range(view, 4)
        if "target" not in view:  # an image, or a column of a table
            view.object(["buffer", "byteOffset", "byteLength"], [])
            return view["buffer"].require(view["buffer"].value == 0, "has no bytes")
        view.object(["buffer", "byteOffset", "byteLength", "target"], ["byteStride", "extensions"])
        view["target"].require(view["target"].value in (34962, 34963), "is neither of vertices nor of indices")
        if not self.is_compressed:
            return view["buffer"].require(view["buffer"].value == 0, "has no bytes")
        packed = view["extensions"][MESHOPT].object(["buffer", "byteOffset", "byteLength", "byteStride", "mode", "count"], [])
        view.require(view["buffer"].value == 1 and packed["buffer"].value == 0, "has its compressed bytes in the wrong buffer")
        first = self.bytes[self.check_range(packed, 1)]
        stride = packed["byteStride"].integer(1)
        packed.require(packed["count"].integer(1) * stride == view["byteLength"].value, "decodes to another size")
        if packed["mode"].value == "ATTRIBUTES":
            packed.require(first == 0xa0 and stride % 4 == 0 and stride <= 256, "is not of version 0 of the codec of vertices")
        else:
            packed.require(packed["mode"].value == "TRIANGLES" and first == 0xe1 and stride in (2, 4), "is not of version 1 of the codec of indices")
        return None

    def layout(self, accessor):
        """Its view, letter of struct, components, bytes of an element and from one to the next."""
        view = accessor["bufferView"].index_in(self.views, "a buffer view")
        component, kind = accessor["componentType"], accessor["type"]
        component.require(type(component.value) is int and component.value in COMPONENTS, "is no type of components")
        kind.require(kind.text() in WIDTHS, "is no type of elements")
        letter, size = COMPONENTS[component.value]
        width = size * WIDTHS[kind.value]
        return view, letter, WIDTHS[kind.value], width, view["byteStride"].integer(1) if "byteStride" in view else width

    def check_accessor(self, accessor):
        accessor.object(["bufferView", "componentType", "count", "type"], ["min", "max", "normalized"])
        view, _, _, width, stride = self.layout(accessor)
        accessor.require(view["target"].value == 34963 or stride % 4 == 0, "is of vertices that are not aligned")
        accessor.require(stride >= width, "has elements that overlap")
        accessor.require(stride * (accessor["count"].integer(1) - 1) + width <= view["byteLength"].value, "leaves its view")

    def values(self, accessor):
        view, letter, count, _, stride = self.layout(accessor)
        first = view["byteOffset"].value
        for i in range(accessor["count"].value):
            yield struct.unpack_from(f"<{count}{letter}", self.bytes, first + i * stride)

    def check_primitive(self, primitive):
        primitive.object(["attributes", "indices", "material"], ["extensions"])
        primitive["material"].index_in(self.materials, "a material")
        attributes = primitive["attributes"].object(["POSITION", "NORMAL"], ["COLOR_0", "TEXCOORD_0", "_FEATURE_ID_0"])
        accessors = {name: attributes[name].index_in(self.accessors, "an accessor") for name in attributes.value}
        counts = {accessor["count"].value for accessor in accessors.values()}
        attributes.require(len(counts) == 1, "have different counts")
        vertices = counts.pop()
        kinds = {"POSITION": [("VEC3", 5123)] if self.is_quantised else [("VEC3", 5126)],
                 "NORMAL": [("VEC3", 5120)] if self.is_quantised else [("VEC3", 5126)],
                 "COLOR_0": [("VEC4", 5123)],
                 "TEXCOORD_0": [("VEC2", 5126), ("VEC2", 5123)],
                 "_FEATURE_ID_0": [("SCALAR", 5123)]}
        for name, accessor in accessors.items():
            accessor.require((accessor["type"].value, accessor["componentType"].value) in kinds[name], f"has an unexpected type for {name}")
            should_be = accessor["componentType"].value != 5126 and name not in ("POSITION", "_FEATURE_ID_0")
            is_normalized = accessor["normalized"].value if "normalized" in accessor else False
            accessor.require(is_normalized is should_be, "is normalized and should not be, or the other way")
        primitive.require(("extensions" in primitive) == ("_FEATURE_ID_0" in accessors) == (self.names is not None), "has features without a table, or the other way")
        if "_FEATURE_ID_0" in accessors:
            self.check_features(primitive, accessors["_FEATURE_ID_0"])
        indices = primitive["indices"].index_in(self.accessors, "an accessor")
        indices.require(indices["type"].value == "SCALAR" and indices["count"].value % 3 == 0, "holds no triangles")
        indices.require(indices["componentType"].value == (5123 if vertices < 65535 else 5125), "is wider or narrower than it need be")
        self.triangles += indices["count"].value // 3
        self.check_bounds(accessors["POSITION"])
        if not self.is_compressed:
            self.check_values(accessors["NORMAL"], indices, vertices)

    def check_values(self, normals, indices, vertices):
        used = {value for value, in self.values(indices)}
        indices.require(used == set(range(vertices)), "has indices that leave the vertices, or vertices are not used")
        for normal in self.values(normals):
            length = math.hypot(*normal) / (127 if self.is_quantised else 1)
            normals.require(abs(length - 1) < (0.02 if self.is_quantised else 1e-3), "has a normal of another length than 1")

    def check_bounds(self, positions):
        low, high = positions["min"].numbers(3), positions["max"].numbers(3)
        if not self.is_compressed:
            values = list(self.values(positions))
            positions.require(all(map(math.isfinite, (x for value in values for x in value))), "has coordinates that are not finite")
            is_exact = all(low[k] == min(v[k] for v in values) and high[k] == max(v[k] for v in values) for k in range(3))
            positions.require(is_exact, "has a min and max that are not those of the positions")
        scale = self.node["scale"].numbers(3) if "scale" in self.node else [1, 1, 1]
        move = self.node["translation"].numbers(3)
        low, high = ([scale[k] * v[k] + move[k] for k in range(3)] for v in (low, high))
        for k, (a, b) in enumerate(((low[0], high[0]), (-high[2], -low[2]), (low[1], high[1]))):
            self.low[k], self.high[k] = min(self.low[k], a), max(self.high[k], b)
