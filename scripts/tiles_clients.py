#!/usr/bin/env python3
"""Tilesets in other people's programs; called by scripts/check_tiles.sh, which says what it does.
tiles_clients.py --occlod FILE --modules FOLDER --out FOLDER SCENE.json [--paths NAME,...] [--frames N] [--error PX] [--size WxH]"""
import argparse
import base64
import json
import math
import pathlib
import shutil
import struct
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
CLIENTS = ROOT / "tests/clients"
EXPORTS = {"plain": [], "quantised": ["--quantise", "14", "--skirts"], "meshopt": ["--compress", "meshopt"],
           "earth": ["--compress", "meshopt", "--origin", "11.575,48.137,519", "--tiles-per-file", "50"]}
OURS = [("nested", "vfc"), ("shifted", "vfc"), ("shifted", "coh")]
LONGEST_S = 1200  # of one client


def say(text):
    print(text, flush=True)


class Run:
    def __init__(self, options):
        self.options, self.out = options, pathlib.Path(options.out).resolve()
        self.out.mkdir(parents=True, exist_ok=True)
        self.failures = []
        self.table = {"scene": options.scene, "error_px": options.error, "exports": {}, "clients": {}, "ours": {}, "ratios": {}}

    def occlod(self, *arguments):
        return self.told(self.options.occlod, *arguments)

    def hlod_compare(self, *arguments):
        """bench_hlod_compare, which is built beside it."""
        return self.told(pathlib.Path(self.options.occlod).parent.parent / "bench/papers/bench_hlod_compare", *arguments)

    @staticmethod
    def told(program, *arguments):
        done = subprocess.run([program, *map(str, arguments)], stdout=subprocess.PIPE, text=True, check=True)
        return json.loads(done.stdout)

    def node(self, program, *arguments):
        """What a program of tests/clients prints; it runs where its packages are."""
        command = ["node", str(self.out / "clients" / program), *map(str, arguments)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as running:
            try:
                told = running.communicate(timeout=LONGEST_S)[0].strip()
            except subprocess.TimeoutExpired:
                self.failures.append(f"{program}: has not ended after {LONGEST_S} s")
                return ""
            finally:
                running.terminate()  # it ends its browser first
                running.wait()
        if running.returncode != 0:
            self.failures.append(f"{program}: exit {running.returncode}: {told[-500:]}")
        return told

    def install_programs(self):
        folder = self.out / "clients"
        folder.mkdir(exist_ok=True)
        for source in [*CLIENTS.glob("*.js"), *CLIENTS.glob("*.html"), CLIENTS / "package.json"]:
            (folder / source.name).write_text(source.read_text())
        shutil.copytree(ROOT / "packaging/npm/occlod/bin", folder / "bin", dirs_exist_ok=True)
        if not (folder / "node_modules").exists():
            (folder / "node_modules").symlink_to(pathlib.Path(self.options.modules).resolve())

    def cameras(self):
        """The keys of the paths, and a scene that jumps from one to the next."""
        scene = json.loads(pathlib.Path(self.options.scene).read_text())
        keys = [key for path in self.options.paths.split(",") for key in scene["paths"][path]["keys"]][: self.options.frames]
        # Clients draw to any distance: so far that nothing of ours is cut off.
        keys = [{"up": [0, 1, 0], "fov_y_deg": 60, "far": 100 * math.dist(key["eye"], key["target"]), **key} for key in keys]
        (self.out / "cameras.json").write_text(json.dumps({"cameras": keys}))
        jumps = {**scene, "paths": {"keys": {"frames": len(keys), "jump": True, "keys": keys}}}
        beside = pathlib.Path(self.options.scene).resolve().parent
        for item in jumps["objects"]:  # the scene of jumps lies elsewhere
            mesh = item.get("mesh")
            if isinstance(mesh, str) and (beside / mesh).exists():
                item["mesh"] = str(beside / mesh)
        (self.out / "jumps.json").write_text(json.dumps(jumps))
        return len(keys)

    def build(self):
        for name, options in (("nested", ["--grouping", "nested", "--borders", "free"]), ("shifted", [])):
            if not (self.out / f"{name}.ohlod").exists():
                self.occlod("hlod", "build", self.options.scene, "-o", self.out / f"{name}.ohlod", "--error-bound", "measured", *options, "--json")
        say(f"\n{'export':12} {'tiles':>8} {'triangles':>11} {'content bytes':>14} {'all bytes':>12} {'per triangle':>13} {'ms':>8}")
        for name, options in EXPORTS.items():
            told = self.occlod("tiles", self.out / "nested.ohlod", "-o", self.out / name, *options, "--replace", "--json")
            self.table["exports"][name] = told
            say(f"{name:12} {told['tiles']:8} {told['triangles']:11} {told['content_bytes']:14} {told['bytes']:12} {told['bytes_per_triangle']:13.2f} {told['write_ms']:8.0f}")
        self.names = list(EXPORTS)
        if self.table["exports"]["meshopt"]["texels"] > 0:
            shutil.rmtree(self.out / "ktx2", ignore_errors=True)
            told = json.loads(self.node("bin/occlod.js", "ktx2", self.out / "meshopt", "-o", self.out / "ktx2", "--json"))
            self.table["ktx2"] = told
            self.names.append("ktx2")
            say(f"ktx2: {told['images']} images, {told['texels']} texels, {told['before']} bytes before, {told['after']} after")
        for name in ("nested", "shifted"):
            self.table[name] = self.occlod("hlod", "info", self.out / f"{name}.ohlod", "--json")
            say(f"{name + '.ohlod':36} {'':14} {self.table[name]['file_bytes']:9} {self.table[name]['file_bytes'] / self.table[name]['triangles']:13.2f}")

    def check(self):
        say("\nstrict checker")
        for name in self.names:
            done = subprocess.run([sys.executable, ROOT / "tests/tools/tileset_check.py", self.out / name, "--json"], capture_output=True, text=True, check=False)
            say(f"{name:12} {done.stdout.strip() or done.stderr.strip()}")
            if done.returncode != 0:
                self.failures.append(f"tileset_check.py: {done.stderr.strip()}")
        say("\nglTF validator")
        say(self.node("validate.js", *(self.out / name for name in self.names)))

    def client(self, program, export, *arguments):
        arguments = [*arguments, *([] if "--cameras" in arguments else ["--cameras", self.out / "cameras.json"]), "--error", self.options.error, "--size", self.options.size,
                     "--frame", self.options.picture, "--png", self.out / f"{program}_{export}.png"]
        if program == "three":
            return self.node("three.js", self.out / export, "--modules", self.out / "clients/node_modules", *arguments)
        serving = [self.options.occlod, "serve", self.out / export, "--port", "0", "--cesium", self.out / "clients/node_modules/cesium/Build/Cesium"]
        with subprocess.Popen(serving, stdout=subprocess.PIPE, text=True) as server:
            try:
                return self.node("cesium.js", server.stdout.readline().strip(), *arguments)
            finally:
                server.terminate()

    def clients(self):
        say(f"\n{'client':34} {'triangles':>11} {'tiles':>8} {'texels':>10} {'resident':>10} {'failed':>7}   means of all cameras, {self.options.error} px; a texel is 4 bytes")
        for program, export in (("cesium", "meshopt"), ("cesium", "earth"), ("three", "plain"), ("three", "meshopt"), ("cesium", "ktx2")):
            if export not in self.names:
                continue
            text = self.client(program, export)
            if not text:
                continue
            told = json.loads(text.splitlines()[-1])
            self.table["clients"][f"{program}, {export}"] = told
            say(f"{program + ', ' + export:34} {told['triangles']:11.0f} {told['tiles']:8.1f} {told['texels']:10.0f} {told['resident_texels']:10.0f} {told['failed']:7}"
                f"   {told['contents']} contents and {told['images']} images fetched")

    def clicks(self):
        """Whether a click in CesiumJS names the group of an OBJ file and the node of a glTF file that is there."""
        names = ["north wall", "south wall", "Dach, groß", "door"]
        places = [(4 * (k % 2), 4 * (k // 2), 0) for k in range(4)]
        corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
        faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        lines = []
        for k, (name, place) in enumerate(zip(names, places)):
            lines += [f"g {name}", *(f"v {x + place[0]} {y + place[1]} {z + place[2]}" for x, y, z in corners),
                      *("f " + " ".join(str(8 * k + corner + 1) for corner in face) for face in faces)]
        (self.out / "parts.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")
        triangles = [corner for a, b, c, d in faces for corner in (a, b, c, a, c, d)]
        data = struct.pack("<24f36H", *(x for corner in corners for x in corner), *triangles)
        gltf = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2, 3]}],
                "nodes": [{"mesh": 0, "name": name, "translation": [x, z, -y]} for name, (x, y, z) in zip(names, places)],  # y is up
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
                "accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [-1] * 3, "max": [1] * 3},
                              {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}],
                "bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
                "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}]}
        (self.out / "parts.gltf").write_text(json.dumps(gltf))
        say("")
        for source in ("obj", "gltf"):
            folder = self.out / f"parts_{source}"
            self.occlod("tiles", self.out / f"parts.{source}", "-o", folder, "--compress", "meshopt", "--node-triangles", "16", "--replace", "--json")
            say(self.node("validate.js", folder))
            # Of a glTF file z up becomes y up, and its tileset turns it back: its root has the axes of the file.
            turned = [(x, z, -y) for x, y, z in places] if source == "gltf" else places
            tops = [(x, y, z + 1) if source == "obj" else (x, y + 1, z) for x, y, z in turned]
            eye, up = ([2, 2.001, 20], [0, 1, 0]) if source == "obj" else ([2, 20, -2.001], [0, 0, -1])
            target = [2, 2, 0] if source == "obj" else [2, 0, -2]
            cameras = [{"eye": eye, "target": target, "up": up, "fov_y_deg": 60, "click": top} for top in tops]
            (self.out / f"clicks_{source}.json").write_text(json.dumps({"cameras": cameras}))
            text = self.client("cesium", folder.name, "--cameras", self.out / f"clicks_{source}.json")
            picked = [row.get("picked") for row in json.loads(text.splitlines()[-1])["rows"]] if text else []
            say(f"clicks on {source}: {picked}")
            if picked != names:
                self.failures.append(f"clicks on {source} name {picked}, not {names}")

    def ours(self):
        """The same cameras by bench_hlod_compare, by both kinds of error, as CesiumJS has them."""
        say("")
        for error, metric in (("guaranteed", "guaranteed"), ("quadric", "box")):
            for name, strategy in OURS:
                (drawn,) = self.hlod_compare(self.out / f"{name}.ohlod", "--scene", self.out / "jumps.json", "--path", "keys", "--strategies", strategy,
                                             "--metric", metric, "--tolerance", self.options.error, "--size", self.options.size, "--json")["runs"]
                self.table["ours"][f"{name}, {strategy}, {error}"] = {"triangles": drawn["drawn_triangles"], "nodes": drawn["drawn_nodes"]}
                say(f"{f'ours: {name}, {strategy}, {error}':34} {drawn['drawn_triangles']:11.0f} {drawn['drawn_nodes']:8.1f}")

    def compare(self):
        say("")
        for export, error in (("meshopt", "guaranteed"),):
            told = self.table["clients"].get(f"cesium, {export}")
            if told:
                ratios = [told["triangles"] / self.table["ours"][f"{name}, {strategy}, {error}"]["triangles"] for name, strategy in OURS]
                self.table["ratios"][error] = {f"{name}, {strategy}": ratio for (name, strategy), ratio in zip(OURS, ratios)}
                say(f"CesiumJS / ours, {error}: " + ", ".join(f"{ratio:.2f} ({name}, {strategy})" for (name, strategy), ratio in zip(OURS, ratios)))

    def run(self):
        self.install_programs()
        say(f"{self.options.scene}, paths {self.options.paths}: {self.cameras()} cameras")
        self.build()
        self.check()
        self.clients()
        self.clicks()
        self.ours()
        self.compare()
        (self.out / "tiles.json").write_text(json.dumps(self.table, indent=1))
        for failure in self.failures:
            say(f"FAILED: {failure}")
        return 1 if self.failures else 0


def main():
    parser = argparse.ArgumentParser()
    for name in ("--occlod", "--modules", "--out"):
        parser.add_argument(name, required=True)
    parser.add_argument("scene")
    parser.add_argument("--paths", default="walk,fly_over")
    parser.add_argument("--frames", type=int, default=100)
    parser.add_argument("--error", default="2")
    parser.add_argument("--size", default="640x480")
    parser.add_argument("--picture", default="7")
    sys.exit(Run(parser.parse_args()).run())


if __name__ == "__main__":
    main()
