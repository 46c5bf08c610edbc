"""What glTF files hold comes out again, of the hierarchy, of GLB files and of tiles, or is counted by its name. The files are made and read here, by
gltf_files.py, so that the readers and writers of occlod do not check each other."""
import base64
import json
import math
import unittest

from gltf_files import KTX2, PNG, SQUARE, WEBP, Model, Read
from tool_case import ToolTest


class GltfCase(ToolTest):
    def setUp(self):
        super().setUp()
        self.model = Model()

    def left_out(self, name="a.glb"):
        return self.json_of("build", name, "-o", "a.olod")["report"]["left_out"]

    def round_trip(self, out="out.glb"):
        """The model as `cut` writes it; sets what was left out."""
        self.model.write_glb(self.folder / "a.glb")
        self.counted = self.left_out()
        done = self.run_tool("cut", "a.olod", "--error", 0, "-o", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.notes = done.stderr
        return Read(self.folder / out)

    def tile(self, *options):
        """The root of the tileset that the model makes."""
        self.model.write_glb(self.folder / "a.glb")
        self.succeed("hlod", "build", "a.glb", "-o", "a.ohlod", "--grouping", "nested", "--borders", "free")
        self.told = self.json_of("tiles", "a.ohlod", "-o", "tiles", "--replace", *options)
        return Read(self.folder / "tiles/tiles/0/0.glb")

    def complaint(self):
        self.model.write_glb(self.folder / "a.glb")
        return self.failure_of("build", "a.glb", "-o", "a.olod")


class Places(GltfCase):
    """Where vertices are."""

    def test_instances(self):
        """Five squares, the third turned by a quarter about z and twice as large, whether the extension is required or not. Integers are fractions."""
        model = self.model
        half = math.sqrt(0.5)
        turns = [(0, 0, 0, 1), (0, 0, 0, 1), (0, 0, half, half), (0, 0, 0, 1), (0, 0, 0, 1)]
        attributes = {"TRANSLATION": model.accessor([(2 * i, 0, 0) for i in range(5)]), "SCALE": model.accessor([(1 + (i == 2),) * 3 for i in range(5)]),
                      "_ID": model.accessor([(i,) for i in range(5)], 5126, "SCALAR")}
        model.json["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
        expected = {(2 * i + x, y, 0) for i in (0, 1, 3, 4) for x, y, _ in SQUARE} | {(4 - 2 * y, 2 * x, 0) for x, y, _ in SQUARE}
        for component, unit in ((5126, 1), (5122, 32767), (5120, 127)):
            rounded = [tuple(round(x * unit) if unit > 1 else x for x in turn) for turn in turns]
            attributes["ROTATION"] = model.accessor(rounded, component, "VEC4", **({"normalized": True} if unit > 1 else {}))
            for required in (False, True):
                model.json.pop("extensionsUsed", 0), model.json.pop("extensionsRequired", 0)
                model.use("EXT_mesh_gpu_instancing", required=required)
                read = self.round_trip()
                self.assertEqual(len(read.triangles), 10)
                self.assertEqual(read.corner_set(), expected)
                self.assertEqual(self.counted, {"_ID of instances": 5})
        attributes["SCALE"] = model.accessor([(1, 1, 1)] * 4)
        self.assertIn("instances where others have", self.complaint())

    def test_skin(self):
        """Joints place a mesh, and its node does not. The first vertex follows a joint at x + 10, the second one at y + 4, both halfway; weights are
        bytes, and those of the last are not normalised."""
        model = self.model
        model.json["nodes"] = [{"mesh": 0, "skin": 0, "translation": [0, 100, 0]}, {"translation": [4, 0, 0], "children": [2]}, {"translation": [8, 4, 0]}]
        model.json["scenes"] = [{"nodes": [0, 1]}]
        shift = lambda x: (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, 0, 0, 1)  # column by column
        model.json["skins"] = [{"joints": [1, 2], "inverseBindMatrices": model.accessor([shift(6), shift(-12)], 5126, "MAT4")}]
        model.primitive["attributes"].update(JOINTS_0=model.accessor([(0, 1, 0, 0)] * 4, 5121, "VEC4"),
                                             WEIGHTS_0=model.accessor([(255, 0, 0, 0), (0, 255, 0, 0), (127, 127, 0, 0), (0, 0, 0, 0)], 5121, "VEC4", normalized=True))
        read = self.round_trip()
        self.assertEqual(read.corner_set(), {(10, 0, 0), (1, 4, 0), (6, 3, 0), (10, 1, 0)})
        self.assertEqual(self.counted, {"skins (as the joints are placed)": 1})
        model.primitive["attributes"]["JOINTS_0"] = model.accessor([(0, 2, 0, 0)] * 4, 5121, "VEC4")
        self.assertIn("joint 2, but the skin has 2", self.complaint())

    def test_skin_without_matrices(self):
        """Inverse bind matrices that are not there are identities."""
        model = self.model
        model.json["nodes"] = [{"mesh": 0, "skin": 0, "translation": [0, 100, 0]}, {"translation": [10, 0, 0]}]
        model.json["skins"] = [{"joints": [1]}]
        model.primitive["attributes"].update(JOINTS_0=model.accessor([(0, 0, 0, 0)] * 4, 5123, "VEC4"), WEIGHTS_0=model.accessor([(1, 0, 0, 0)] * 4, 5126, "VEC4"))
        self.assertEqual(self.round_trip().corner_set(), {(10 + x, y, 0) for x, y, _ in SQUARE})

    def test_morphs(self):
        """Half of the first target, which lifts all vertices by 4, and 2 of the second, sparse, which moves one; those of a node come first."""
        model = self.model
        sparse = {"count": 1, "indices": {"bufferView": model.view(b"\2"), "componentType": 5121}, "values": {"bufferView": model.view(bytes(4) + b"\0\0\x80\x3f" + bytes(4))}}
        model.json["accessors"].append({"componentType": 5126, "count": 4, "type": "VEC3", "sparse": sparse, "min": [0, 0, 0], "max": [0, 1, 0]})
        model.primitive["targets"] = [{"POSITION": model.accessor([(0, 0, 4)] * 4)}, {"POSITION": len(model.json["accessors"]) - 2}]
        model.json["meshes"][0]["weights"] = [0.5, 2]
        read = self.round_trip()
        self.assertEqual(read.corner_set(), {(0, 0, 2), (1, 0, 2), (1, 3, 2), (0, 1, 2)})
        self.assertEqual(self.counted, {"morph targets (at their default weights)": 2})
        model.json["accessors"].append({"componentType": 5126, "count": 4, "type": "VEC3", "min": [0] * 3, "max": [0] * 3})  # zeros, as it has no view
        model.primitive["targets"].append({"POSITION": len(model.json["accessors"]) - 1})
        model.json["nodes"][0]["weights"] = [0.25, 0, 5]
        self.assertEqual(self.round_trip().corner_set(), {(x, y, 1) for x, y, _ in SQUARE})

    def test_up(self):
        """glTF has y up, and so have its tiles: what is at y in the input stays there. A scene that turns its meshes to z up has z."""
        self.assertEqual(self.tile().corner_set(), {(x, 0, -y) for x, y, _ in SQUARE})  # of contents, whose z is up before the transform
        root = lambda: json.loads((self.folder / "tiles/tileset.json").read_text())["root"]
        upright = [1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1]  # y becomes z
        self.assertEqual((root()["transform"], self.told["up"]), (upright, "y"))
        self.tile("--up", "z")
        self.assertNotIn("transform", root())
        for objects, up in (([{}], "y"), ([{}, {"position": [3, 0, 0]}], "y"), ([{"rotation": {"axis": [1, 0, 0], "degrees": 90}}], "z"), ([{}, {"mesh": "b.obj"}], "z")):
            (self.folder / "b.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
            self.write_scene(json.dumps({"objects": [dict({"mesh": "a.glb"}, **it) for it in objects], "cameras": {"default": {"eye": [0, 0, 9], "target": [0, 0, 0]}}}))
            for options in ([], ["--memory", "64M"]):
                self.succeed("hlod", "build", "scene.json", "-o", "a.ohlod", "--grouping", "nested", "--borders", "free", *options)
                self.assertEqual(self.json_of("tiles", "a.ohlod", "-o", "tiles", "--replace")["up"], up, objects)


class Looks(GltfCase):
    """Materials, textures and images."""

    def look(self, read):
        """The only material, with textures as images instead of numbers, and without what is as the specification has it."""
        material = read.json["materials"][-1]
        texture = lambda index: read.json["textures"][index]
        pbr = material.get("pbrMetallicRoughness", {})
        for owner in (pbr, material):
            for key, value in owner.items():
                if key.endswith("Texture"):
                    extensions = texture(value["index"]).get("extensions", {})
                    source = next((it["source"] for it in extensions.values()), texture(value["index"]).get("source"))
                    value["index"] = [sorted(extensions), read.image(source)]
        for owner, key, usual in ((pbr, "baseColorFactor", [1, 1, 1, 1]), (pbr, "metallicFactor", 1), (pbr, "roughnessFactor", 1), (material, "doubleSided", False),
                                  (material, "pbrMetallicRoughness", {}), (material, "alphaCutoff", 0.5)):
            if owner.get(key) == usual:
                del owner[key]
        return material

    def assert_same(self, a, b, what):
        """Floats have 24 bits."""
        if isinstance(a, dict):
            self.assertEqual(sorted(a), sorted(b), what)
            for key in a:
                self.assert_same(a[key], b[key], (what, key))
        elif isinstance(a, list):
            self.assertEqual(len(a), len(b), what)
            for x, y in zip(a, b):
                self.assert_same(x, y, what)
        elif isinstance(a, float):
            self.assertAlmostEqual(a, b, 6, what)
        else:
            self.assertEqual(a, b, what)

    # What a material may have. `image` stands for a texture.
    MATERIALS = [
        {}, {"name": "leaf", "alphaMode": "MASK", "alphaCutoff": 0.3, "doubleSided": True}, {"alphaMode": "MASK"}, {"alphaMode": "BLEND"},
        {"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 1, 0.125]}},
        {"pbrMetallicRoughness": {"metallicFactor": 0.25, "roughnessFactor": 0.75}}, {"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0}},
        {"emissiveFactor": [0.5, 0.25, 0.75]}, {"extensions": {"KHR_materials_unlit": {}}}, {"doubleSided": True},
        {"pbrMetallicRoughness": {"baseColorTexture": "image"}}, {"pbrMetallicRoughness": {"metallicRoughnessTexture": "image"}}, {"normalTexture": "image"},
        {"normalTexture": ("image", {"scale": 0.5})}, {"occlusionTexture": "image"}, {"occlusionTexture": ("image", {"strength": 0.25})},
        {"emissiveTexture": "image", "emissiveFactor": [1, 1, 1]},
        {"pbrMetallicRoughness": {"baseColorTexture": "image", "metallicRoughnessTexture": "image"}, "normalTexture": "image", "occlusionTexture": "image", "emissiveTexture": "image"},
        {"pbrMetallicRoughness": {"baseColorTexture": "image"},
         "normalTexture": ("image", {"extensions": {"KHR_texture_transform": {"offset": [0.5, 0.25], "rotation": 0.5, "scale": [4, 8]}}})},
    ]

    def test_materials(self):
        """Each comes out as it went in, of GLB files and of tiles."""
        for material in self.MATERIALS:
            self.model = Model()

            def filled(value):
                if isinstance(value, tuple):
                    return dict(filled(value[0]), **value[1])
                if value == "image":
                    return {"index": self.model.texture(PNG + bytes(len(self.model.json.get("images", []))))}
                return {key: filled(inner) for key, inner in value.items()} if isinstance(value, dict) else value

            described = filled(material)
            self.model.material(**described)
            used = [name for name in ("KHR_materials_unlit", "KHR_texture_transform") if name in str(described)]
            self.model.use(*used) if used else None
            self.model.write_glb(self.folder / "a.glb")
            expected = self.look(Read(self.folder / "a.glb"))
            read = self.round_trip()
            self.assertEqual(self.counted, {}, material)
            self.assertEqual(read.json.get("extensionsUsed", []), used)
            self.assert_same(self.look(read), expected, material)
            tile = self.look(self.tile())
            self.assertTrue(tile.pop("doubleSided"))
            expected.pop("doubleSided", None)
            self.assert_same(tile, expected, material)

    def test_formats_that_have_less(self):
        """What OBJ and PLY cannot say of materials one note counts."""
        self.model.material(alphaMode="MASK")
        self.model.material(pbrMetallicRoughness={"metallicFactor": 0.5})
        self.round_trip()
        for name, told in (("a.obj", ".obj has what .mtl has words for only: 1 of 2 "), ("a.ply", ".ply has textures of base colours only: 1 of 2 ")):
            done = self.run_tool("cut", "a.olod", "--error", 0, "-o", name)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (0, 1), done.stderr)
            self.assertIn(told, done.stderr)

    def test_obj_has_what_mtl_says(self):
        """Emission, normals and gloss come out of an OBJ file as they went into it."""
        image = lambda: {"index": self.model.texture(PNG + bytes(len(self.model.json.get("images", []))))}
        self.model.material(name="m", pbrMetallicRoughness={"baseColorTexture": image(), "metallicFactor": 0.25, "roughnessFactor": 0.75}, normalTexture=image(),
                            emissiveTexture=dict(image(), extensions={"KHR_texture_transform": {"offset": [0.5, 0.25], "scale": [4, 8]}}), emissiveFactor=[0.5, 0.25, 0.75])
        self.model.use("KHR_texture_transform")
        expected = self.look(self.round_trip())
        self.succeed("cut", "a.olod", "--error", 0, "-o", "a.obj")
        self.assertEqual(self.left_out("a.obj"), {})
        self.succeed("cut", "a.olod", "--error", 0, "-o", "b.glb")
        self.assert_same(self.look(Read(self.folder / "b.glb")), expected, "")

    def test_opaque_ignores_alpha(self):
        self.model.material(pbrMetallicRoughness={"baseColorFactor": [1, 0, 0, 0]})
        for read in (self.round_trip(), self.tile()):
            self.assertEqual(read.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"], [1, 0, 0, 1])
            self.assertNotIn("alphaMode", read.json["materials"][0])

    def test_specular_glossiness(self):
        """The diffuse colour and its texture are kept, and how glossy it is; that it has a specular colour is counted."""
        name = "KHR_materials_pbrSpecularGlossiness"
        self.model.material(extensions={name: {"diffuseFactor": [0.5, 0.25, 0.125, 0.5], "diffuseTexture": {"index": self.model.texture()}, "glossinessFactor": 0.25,
                                               "specularFactor": [1, 0, 0]}}, alphaMode="BLEND")
        for required in (False, True):
            self.model.use(name, required=required)
            read = self.round_trip()
            pbr = read.json["materials"][0]["pbrMetallicRoughness"]
            self.assertEqual((pbr["baseColorFactor"], pbr["metallicFactor"], pbr["roughnessFactor"]), ([0.5, 0.25, 0.125, 0.5], 0, 0.75))
            self.assertEqual(read.image(read.json["textures"][pbr["baseColorTexture"]["index"]]["source"]), PNG)
            self.assertEqual(self.counted, {name: 1})

    def test_other_coordinates(self):
        """A map with other coordinates than the base colour is left out, by its name; without a base colour the first map decides."""
        self.model.primitive["attributes"]["TEXCOORD_1"] = self.model.primitive["attributes"]["TEXCOORD_0"]
        other = {"index": self.model.texture(), "texCoord": 1}
        self.model.material(pbrMetallicRoughness={"baseColorTexture": {"index": self.model.texture()}}, normalTexture=dict(other), emissiveTexture=dict(other))
        material = self.round_trip().json["materials"][0]
        self.assertFalse({"normalTexture", "emissiveTexture"} & set(material))
        self.assertEqual(self.counted, {"TEXCOORD_1": 4, "emissiveTexture (TEXCOORD_1)": 1, "normalTexture (TEXCOORD_1)": 1})
        del self.model.json["materials"][0]["pbrMetallicRoughness"]
        material = self.round_trip().json["materials"][0]
        self.assertTrue({"normalTexture", "emissiveTexture"} <= set(material))
        self.assertEqual(self.counted, {"TEXCOORD_0": 4})

    def test_transforms(self):
        """The base colour's transform is applied to coordinates, and maps are placed relative to it: all show what they showed."""
        base = {"offset": [0.25, 0.5], "scale": [2, 4]}
        other = {"offset": [0.5, 0], "rotation": 1, "scale": [4, 3]}
        textures = [{"index": self.model.texture(), "extensions": {"KHR_texture_transform": transform}} for transform in (base, other)]
        self.model.material(pbrMetallicRoughness={"baseColorTexture": textures[0]}, normalTexture=textures[1])

        def placed(uv, transform):
            s, c = math.sin(transform.get("rotation", 0)), math.cos(transform.get("rotation", 0))
            (u, v), (su, sv), (x, y) = uv, transform.get("scale", (1, 1)), transform.get("offset", (0, 0))
            return c * su * u + s * sv * v + x, -s * su * u + c * sv * v + y

        read = self.round_trip()
        normal = read.json["materials"][0]["normalTexture"]["extensions"]["KHR_texture_transform"]
        at = read.json["meshes"][0]["primitives"][0]["attributes"]
        for (x, y, _), uv in zip(read.values(at["POSITION"]), read.values(at["TEXCOORD_0"])):
            before = (x, 1 - y)
            for found, expected in ((uv, placed(before, base)), (placed(uv, normal), placed(before, other))):
                for a, b in zip(found, expected):
                    self.assertAlmostEqual(a, b, 5)
        base["rotation"] = 0.25  # what undoes it would shear the other
        self.assertNotIn("normalTexture", self.round_trip().json["materials"][0])
        self.assertEqual(self.counted, {"normalTexture (KHR_texture_transform)": 1})

    def test_samplers(self):
        self.model.json["samplers"] = [{"magFilter": 9728, "minFilter": 9984, "wrapS": 33071, "wrapT": 33648}]
        self.model.material(pbrMetallicRoughness={"baseColorTexture": {"index": self.model.texture(source=0, sampler=0)}})
        for read in (self.round_trip(), self.tile()):
            self.assertEqual(read.json["samplers"], self.model.json["samplers"])

    def test_image_formats(self):
        """Images of other formats go on with their extensions. Where a texture has two, the one that all readers know stays, and the other is counted."""
        for name, mime, data in (("EXT_texture_webp", "image/webp", WEBP), ("KHR_texture_basisu", "image/ktx2", KTX2), ("MSFT_texture_dds", "image/vnd-ms.dds", b"DDS " + bytes(124)),
                                 ("EXT_texture_avif", "image/avif", b"\0\0\0\x1cftypavif" + bytes(20))):
            self.model = Model()
            self.model.material(pbrMetallicRoughness={"baseColorTexture": {"index": self.model.texture(data, mime, extensions={name: {"source": 0}})}})
            self.model.use(name, required=True)
            for read in (self.round_trip(), self.tile()):
                self.assertEqual(read.json["textures"], [{"sampler": 0, "extensions": {name: {"source": 0}}}])
                self.assertEqual((read.json["images"][0]["mimeType"], read.image(0)), (mime, data))
                self.assertEqual((read.json["extensionsUsed"], read.json["extensionsRequired"]), ([name], [name]))
            self.assertEqual(self.counted, {})
            self.model.texture()
            self.model.json["textures"][0]["source"] = 1
            for read in (self.round_trip(), self.tile()):
                self.assertEqual((read.json["textures"], read.image(0)), ([{"source": 0, "sampler": 0}], PNG))
            self.assertEqual(self.counted, {name: 1})

    def write_obj(self, image):
        """A textured triangle in a folder of its own."""
        (self.folder / "model").mkdir(exist_ok=True)
        (self.folder / "model/m.obj").write_text("mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n")
        (self.folder / "model/m.mtl").write_text(f"newmtl m\nmap_Kd {image}\n")

    def test_images_follow(self):
        """From an image beside the input: GLB files hold it, OBJ and PLY files lead to it, wherever they are."""
        self.write_obj("my tex #1.png")
        (self.folder / "model/my tex #1.png").write_bytes(PNG)
        (self.folder / "out/deep").mkdir(parents=True)
        self.succeed("build", "model/m.obj", "-o", "out/a.olod")
        for out in ("out/deep/a.glb", "a.glb"):
            done = self.run_tool("cut", "out/a.olod", "--error", 0, "-o", out)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            read = Read(self.folder / out)
            self.assertEqual((read.image(0), read.json["images"][0]["mimeType"]), (PNG, "image/png"))
            self.assertNotIn("uri", read.json["images"][0])
        self.succeed("cut", "out/a.olod", "--error", 0, "-o", "out/deep/b.obj")
        self.assertIn("map_Kd ../../model/my tex #1.png\n", (self.folder / "out/deep/b.mtl").read_text())
        self.succeed("cut", "out/a.olod", "--error", 0, "-o", "model/b.ply")
        self.assertIn(b"comment TextureFile my tex #1.png\n", (self.folder / "model/b.ply").read_bytes())
        self.succeed("hlod", "build", "model/m.obj", "-o", "out/a.ohlod", "--grouping", "nested", "--borders", "free")
        told = self.json_of("tiles", "out/a.ohlod", "-o", "tiles")
        self.assertEqual((told["images_left_out"], (self.folder / "tiles/textures/0.png").read_bytes()), ([], PNG))
        (self.folder / "model").rename(self.folder / "moved")
        self.assertEqual(self.json_of("tiles", "out/a.ohlod", "-o", "tiles", "--replace", "--images", "moved")["images_left_out"], [])
        done = self.run_tool("cut", "out/a.olod", "--error", 0, "-o", "a.glb")
        self.assertEqual(done.returncode, 0)
        self.assertEqual(done.stderr, 'occlod: note: the image "../model/my tex #1.png" is not in "out"\n'.replace('"', "'"))

    def test_images_that_gltf_lacks(self):
        for name, data in (("a.tga", bytes(18)), ("a.bmp", b"BM" + bytes(52)), ("a.TGA", b"")):
            self.write_obj(name)
            (self.folder / "model" / name).write_bytes(data)
            self.succeed("build", "model/m.obj", "-o", "a.olod")
            done = self.run_tool("cut", "a.olod", "--error", 0, "-o", "a.glb")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("is left out: glTF has PNG, JPEG", done.stderr)
            self.assertFalse({"images", "textures"} & set(Read(self.folder / "a.glb").json))

    def test_without_coordinates(self):
        """Nothing could show a texture."""
        del self.model.primitive["attributes"]["TEXCOORD_0"]
        self.model.material(pbrMetallicRoughness={"baseColorTexture": {"index": self.model.texture()}})
        read = self.round_trip()
        self.assertFalse({"images", "textures"} & set(read.json))
        self.assertIn("without texture coordinates", self.notes)
        self.assertFalse({"images", "textures"} & set(self.tile().json))


class GltfNames(GltfCase):
    """What is not carried is counted by its name, or refused where the file requires it."""

    # Extensions of the Khronos registry and where they may be; those that are carried are tested above.
    EXTENSIONS = {
        "material": """KHR_materials_anisotropy KHR_materials_clearcoat KHR_materials_diffuse_transmission KHR_materials_dispersion KHR_materials_emissive_strength
            KHR_materials_ior KHR_materials_iridescence KHR_materials_sheen KHR_materials_specular KHR_materials_transmission KHR_materials_volume KHR_materials_volume_scatter
            KHR_materials_subsurface ADOBE_materials_clearcoat_specular ADOBE_materials_clearcoat_tint ADOBE_materials_thin_transparency AGI_stk_metadata EXT_materials_bump FB_geometry_metadata
            MPEG_texture_video NV_materials_mdl MSFT_packing_normalRoughnessMetallic MSFT_packing_occlusionRoughnessMetallic""",
        "primitive": "KHR_materials_variants KHR_gaussian_splatting CESIUM_primitive_outline EXT_primitive_voxels GRIFFEL_bim_data BENTLEY_materials_line_style",
        "node": "KHR_lights_punctual KHR_node_visibility KHR_node_hoverability KHR_node_selectability KHR_audio_emitter KHR_physics_rigid_bodies MSFT_lod EXT_instance_features AGI_articulations "
                "EXT_lights_ies OMI_collider MPEG_node_avatar",
        "mesh": "KHR_xmp EXT_mesh_manifold MPEG_mesh_linking",
        "root": "KHR_animation_pointer KHR_interactivity KHR_implicit_shapes KHR_xmp_json_ld KHR_techniques_webgl EXT_lights_image_based CESIUM_RTC MSFT_audio_emitter MPEG_media EXT_animation_bezier",
        "texture": "GODOT_single_root MPEG_texture_sampler MSFT_texture_of_tomorrow",
    }

    def owner(self, model, place):
        model.material(pbrMetallicRoughness={"baseColorTexture": {"index": model.texture()}})
        return {"material": model.json["materials"][0], "primitive": model.primitive, "node": model.json["nodes"][0], "mesh": model.json["meshes"][0], "root": model.json,
                "texture": model.json["textures"][0]}[place]

    def test_extensions(self):
        counted, expected = {}, {}
        for place, names in self.EXTENSIONS.items():
            model = Model()
            self.owner(model, place)["extensions"] = {name: {} for name in names.split()}
            model.use(*names.split())
            model.write_glb(self.folder / "a.glb")
            counted.update(self.left_out())
            expected.update({name: 1 for name in names.split()})
        self.assertEqual(counted, expected)

    def test_unknown_extension(self):
        """Counted as often as it is there, at least once where the file only says that it uses it."""
        self.owner(self.model, "material")["extensions"] = {"EXT_of_tomorrow": {"extensions": "EXT_inside"}}
        self.model.json["nodes"][0]["extensions"] = {"EXT_of_tomorrow": [{"extensions": {"EXT_below": {}}}]}
        self.model.use("EXT_unseen")
        self.round_trip()
        self.assertEqual(self.counted, {"EXT_below": 1, "EXT_of_tomorrow": 2, "EXT_unseen": 1})

    def test_required(self):
        for name in " ".join(self.EXTENSIONS.values()).split():
            self.model = Model()
            self.model.use(name, required=True)
            self.assertIn(f"needs the extension '{name}', which is not supported", self.complaint())
        self.model = Model()
        self.model.use("KHR_draco_mesh_compression", required=True)
        self.assertIn("Draco", self.complaint())

    def test_attributes(self):
        """All that the specification names, and some of a program's own."""
        model = self.model
        for name, component, kind, value in (("TANGENT", 5126, "VEC4", (1, 0, 0, 1)), ("TEXCOORD_1", 5126, "VEC2", (0, 0)), ("COLOR_1", 5126, "VEC3", (0, 0, 0)),
                                             ("JOINTS_0", 5121, "VEC4", (0, 0, 0, 0)), ("WEIGHTS_0", 5126, "VEC4", (1, 0, 0, 0)), ("_FEATURE_ID_0", 5126, "SCALAR", (0,))):
            model.primitive["attributes"][name] = model.accessor([value] * 4, component, kind)
        model.primitive["attributes"]["NORMAL"] = model.accessor([(0, 0, 1)] * 4)
        model.primitive["attributes"]["COLOR_0"] = model.accessor([(1, 0.5, 0, 1)] * 4, kind="VEC4")
        read = self.round_trip()
        self.assertEqual(read.attributes, {"POSITION", "NORMAL", "TEXCOORD_0", "COLOR_0"})
        self.assertEqual(self.counted, {"COLOR_1": 4, "JOINTS_0": 4, "TANGENT": 4, "TEXCOORD_1": 4, "WEIGHTS_0": 4, "_FEATURE_ID_0": 4})

    def test_everything_else(self):
        model = self.model
        model.json["meshes"][0]["primitives"] += [dict(model.primitive, mode=mode) for mode in (0, 0, 1, 2, 3)] + [{"attributes": {"NORMAL": model.accessor([(0, 0, 1)] * 3)}}]
        model.json["meshes"].append({"primitives": [model.primitive]})
        model.json["scenes"].append({"nodes": []})
        model.json["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1, "znear": 1}}]
        times = model.accessor([(0,), (1,)], 5126, "SCALAR", min=[0], max=[1])
        model.json["animations"] = [{"samplers": [{"input": times, "output": model.accessor([(0, 0, 0), (1, 0, 0)])}],
                                     "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}]
        model.json["asset"]["copyright"] = "2026 somebody"
        model.json["nodes"][0]["extras"] = {"extras": "of a program"}
        self.assertEqual(len(self.round_trip().triangles), 2)
        self.assertEqual(self.counted, {"animations": 1, "cameras": 1, "copyright": 1, "extras": 2, "meshes that the scene does not place": 1, "other scenes": 1,
                                        "primitives of line loops": 1, "primitives of line strips": 1, "primitives of lines": 1, "primitives of points": 2, "primitives without POSITION": 1})


class Text(GltfCase):
    """Names and nesting of the JSON."""

    def test_data_uris(self):
        """Base64 is read whatever the media type is, which does not distinguish case."""
        for head in ("data:application/binary;base64,", "data:;base64,", "data:application/octet-stream;charset=utf-8;base64,", "data:Application/Octet-Stream;BASE64,",
                     "DATA:application/gltf-buffer;base64,", "data:model/gltf-buffer;base64,", "data:base64;base64,"):
            self.model.write_text(self.folder / "a.gltf", head)
            self.assertEqual(self.json_of("build", "a.gltf", "-o", "a.olod")["triangles"], 2, head)
        for head, word in (("data:text/csv,", "'text/csv'"), ("data:text/csv;base64,!", "'text/csv'"), ("data:,", "text/plain")):
            self.model.write_text(self.folder / "a.gltf", head)
            line = self.failure_of("build", "a.gltf", "-o", "a.olod")
            self.assertIn(f"data URI of media type {word}, which is not base64", line)

    def test_image_data_uris(self):
        for mime, expected in (("image/webp", "image/webp"), ("IMAGE/PNG", "image/png"), ("", "image/webp")):
            self.model = Model()
            data = PNG if "PNG" in mime else WEBP
            self.model.material(pbrMetallicRoughness={"baseColorTexture": {"index": self.model.texture(data)}})
            self.model.json["images"] = [{"uri": f"data:{mime};base64,{base64.b64encode(data).decode()}"}]
            read = self.round_trip()
            self.assertEqual((read.json["images"][0]["mimeType"], read.image(0)), (expected, data))

    def test_names_of_buffers(self):
        """Escaped, with plus signs and blanks."""
        for uri, name in (("my%20data%231.bin", "my data#1.bin"), ("a+b.bin", "a+b.bin"), ("a%2Bb.bin", "a+b.bin"), ("b c.bin", "b c.bin")):
            (self.folder / name).write_bytes(self.model.bytes)
            (self.folder / "a.gltf").write_text(json.dumps(dict(self.model.json, buffers=[{"byteLength": len(self.model.bytes), "uri": uri}])))
            self.assertEqual(self.json_of("build", "a.gltf", "-o", "a.olod")["triangles"], 2, uri)

    def test_nesting(self):
        """In every JSON that is read; what nests as deep as files of people do is read."""
        deep = lambda levels: "[" * levels + "]" * levels
        text = json.dumps(dict(self.model.json, extras="DEEP", buffers=[{"byteLength": len(self.model.bytes)}]))
        for levels in (300, 20_000, 1_000_000):
            self.model.write_glb(self.folder / "a.glb", text.replace('"DEEP"', deep(levels)))
            (self.folder / "a.gltf").write_text('{"asset": {"version": "2.0"}, "extras": ' + deep(levels) + "}")
            (self.folder / "scene.json").write_text('{"objects": ' + deep(levels) + "}")
            for arguments in (("info", "a.glb"), ("build", "a.glb", "-o", "a.olod"), ("build", "a.gltf", "-o", "a.olod"), ("render", "scene.json", "--png", "a.png"), ("hlod", "build", "scene.json", "-o", "a.ohlod")):
                self.assertIn("more than 200 nested arrays and objects", self.failure_of(*arguments))
        self.model.write_glb(self.folder / "a.glb", text.replace('"DEEP"', deep(150)))
        self.assertEqual(self.left_out(), {"extras": 1})
        self.model.write_glb(self.folder / "a.glb", text.replace('"DEEP"', json.dumps("[" * 999 + '\\"' + "[" * 999)))
        self.assertEqual(self.left_out(), {"extras": 1})


if __name__ == "__main__":
    unittest.main()
