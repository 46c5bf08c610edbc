"""`occlod hlod render --memory` as people and scripts use it, and what damaged .ohlod files do to it and to its neighbours."""
import json
import os
import random
import resource
import signal
import struct
import subprocess
import unittest
import zlib

from tool_case import OCCLOD, ToolTest

SIZE = ("--size", "160x120")
FLIPS = 100
LARGEST = 2**31  # bytes of address space
LONGEST_S = 120


def textured_grid(cells):
    """OBJ text of a hilly grid with texture coordinates, and a seam across it where they jump."""
    lines = ["mtllib none.mtl"]
    for y in range(cells + 1):
        for x in range(cells + 1):
            lines += [f"v {x} {y} {(x * 7 + y * 11) % 5 * 0.1}", f"vt {x / cells} {y / cells}", f"vt {x / cells + 3} {y / cells}"]
    for y in range(cells):
        for x in range(cells):
            a = y * (cells + 1) + x + 1
            b, c, d = a + 1, a + cells + 2, a + cells + 1
            side = 0 if 2 * x >= cells else 1
            for corners in ((a, b, c), (a, c, d)):
                lines.append("f " + " ".join(f"{v}/{2 * v - side}" for v in corners))
    return "\n".join(lines) + "\n"


class Paged(ToolTest):
    """A planet, seen from near and from far away."""

    def setUp(self):
        super().setUp()
        near = {"eye": [0.2, 0.3, 1.5], "target": [0, 0, 0], "near": 0.01, "far": 30}
        self.write_scene(json.dumps({"objects": [{"mesh": "planet.ply"}], "cameras": {"default": near},
                                     "paths": {"by": {"frames": 9, "keys": [dict(near, eye=[1.5, 0, 8]), near]}}}))

    def build(self):
        """Version 1, planet.ohlod, and version 2, grid.ohlod."""
        self.make_planet()
        self.succeed("hlod", "build", "planet.ply", "-o", "planet.ohlod", "--node-triangles", 64)
        (self.folder / "grid.obj").write_text(textured_grid(24))
        self.succeed("hlod", "build", "grid.obj", "-o", "grid.ohlod", "--node-triangles", 64)

    def arguments(self, name, *more):
        return ["hlod", "render", name, "--scene", "scene.json", "--path", "by", *SIZE, "--strategy", "vfc", *more, "--json"]

    def told(self, *more, name="planet.ohlod"):
        return json.loads(self.succeed(*self.arguments(name, *more)))

    def hashes(self, report):
        return [frame["hash"] for frame in report["frames"]]


class HlodPaged(Paged):
    def setUp(self):
        super().setUp()
        self.build()

    def test_the_same_pictures_where_frames_wait(self):
        for name in ("planet.ohlod", "grid.ohlod"):
            whole, paged = self.told(name=name), self.told("--memory", "64M", "--load", "blocking", name=name)
            self.assertEqual(self.hashes(paged), self.hashes(whole))
            self.assertEqual((paged["cache"]["budget_bytes"], paged["cache"]["load"]), (64 << 20, "blocking"))
            self.assertNotIn("cache", whole)

    def test_the_budget_is_kept_and_the_least_is_named(self):
        line = self.failure_of(*self.arguments("planet.ohlod", "--memory", 1))
        least = max(int(word) for word in line.replace(",", " ").replace(";", " ").split() if word.isdigit())
        self.assertIn("at least", line)
        self.assertIn("at least", self.failure_of(*self.arguments("planet.ohlod", "--memory", least - 1)))
        for budget in (least, 3 * least):
            report = self.told("--memory", budget, "--load", "blocking")
            for frame in report["frames"]:
                self.assertLessEqual(frame["resident_bytes"], budget)
            self.assertGreater(report["frames"][-1]["largest_sse_px"], report["tolerance_px"], "there is no room for finer ones")
        self.assertLess(self.told()["frames"][-1]["largest_sse_px"], 1.0 + 1e-6)

    def picture(self, name, *more):
        done = self.run_tool("hlod", "render", "red.ohlod", "--scene", "over.json", *SIZE, "--strategy", "vfc", "--tolerance", 0.5, "--png", name, *more, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        return (self.folder / name).read_bytes(), done.stderr

    def test_nodes_show_images_of_their_own(self):
        """Without the model's image, from memory and paged; a damaged one is told in one line, and something coarser is drawn."""
        (self.folder / "red.obj").write_text("mtllib red.mtl\nusemtl red\n" + textured_grid(24).split("\n", 1)[1])
        (self.folder / "red.mtl").write_text("newmtl red\nmap_Kd red.png\n")
        rows = b"".join(b"\0" + b"".join(bytes([200 + (x ^ y) % 50, 20, y // 2]) for x in range(512)) for y in range(512))
        chunks = [(b"IHDR", struct.pack(">IIBBBBB", 512, 512, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(rows)), (b"IEND", b"")]
        (self.folder / "red.png").write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in chunks))
        over = {"eye": [12, 11, 30], "target": [12, 12, 0], "near": 0.1, "far": 100}
        (self.folder / "over.json").write_text(json.dumps({"objects": [{"mesh": "red.obj"}], "cameras": {"default": over}}))
        self.succeed("hlod", "build", "red.obj", "-o", "red.ohlod", "--node-triangles", 64)
        self.succeed("hlod", "validate", "red.ohlod", "--input", "red.obj")
        (self.folder / "red.png").unlink()
        whole, notes = self.picture("whole.png")
        self.assertEqual(notes, "")
        self.assertTrue(whole != self.picture("plain.png", "--texture", "none")[0])
        paging = ("--memory", "64M", "--load", "blocking")
        self.assertTrue(self.picture("paged.png", *paging) == (whole, ""))
        data = bytearray((self.folder / "red.ohlod").read_bytes())
        sections = {bytes(data[at : at + 4]): struct.unpack_from("<QQ", data, at + 8) for at in range(32, 32 + 48 * struct.unpack_from("<I", data, 12)[0], 48)}
        nodes = struct.iter_unpack("<QQIf", data[sections[b"NIMG"][0] : sum(sections[b"NIMG"])])
        last = max(place for place, _, size, _ in nodes if size > 0)
        data[sections[b"IMGS"][0] + last] ^= 1
        (self.folder / "red.ohlod").write_bytes(data)
        damaged, notes = self.picture("damaged.png", *paging)
        self.assertTrue(damaged != whole)
        self.assertEqual(notes.count("\n"), 1)
        self.assertIn("image of node", notes)
        self.assertIn("image of node", self.failure_of("hlod", "validate", "red.ohlod"))

    def test_wrong_use(self):
        for arguments, told in ((("--load", "async"), "--memory"), (("--memory", "1M", "--within", "splits"), "--within"), (("--memory", "1M", "--reference", 1), "--reference")):
            done = self.run_tool(*self.arguments("planet.ohlod", *arguments))
            self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), done.stderr)
            self.assertIn(told, done.stderr)
        self.assertIn(".ohlod", self.failure_of("hlod", "render", "planet.ply", "--memory", "1M"))

    def on_a_simulated_disk(self, frames):
        return [os.environ["HLOD_COMPARE"], "planet.ohlod", "--scene", "scene.json", "--path", "by", *SIZE, "--strategies", "vfc", "--memory", "64M",
                "--load", "simulated:0.5", "--frames", str(frames), "--json"]

    def changed_while_open(self, change, *more, program=None):
        """How it ends when `change` is done while the file is open and the thread that reads it runs."""
        path = str(self.folder / "planet.ohlod")
        process = subprocess.Popen(program or [OCCLOD, *map(str, self.arguments("planet.ohlod", *more))], cwd=self.folder, env=self.environment, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        with process:
            while process.poll() is None:
                state = f"/proc/{process.pid}"
                try:
                    is_open = any(os.path.realpath(f"{state}/fd/{fd}") == path for fd in os.listdir(f"{state}/fd"))
                    if is_open and len(os.listdir(f"{state}/task")) > 1:
                        os.kill(process.pid, signal.SIGSTOP)
                        os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WEXITED | os.WNOWAIT)
                        change()
                        os.kill(process.pid, signal.SIGCONT)
                        break
                except OSError:
                    continue  # it has ended meanwhile
            output, errors = process.communicate(timeout=LONGEST_S)
        return process.returncode, output, errors

    def test_cut_short_while_open(self):
        """What has not been read never comes: coarser nodes are drawn, and a line tells of each."""
        path = self.folder / "planet.ohlod"
        whole = path.read_bytes()
        slow = self.on_a_simulated_disk(100)
        told = []
        # How far it has read when it is stopped is chance, so it may have read all.
        for bytes_left in (0, 4096, len(whole) // 2) * 5:
            if told:
                break
            path.write_bytes(whole)
            code, output, errors = self.changed_while_open(lambda size=bytes_left: os.truncate(path, size), program=slow)
            if code == 0:  # else it had not been opened yet
                told += errors.splitlines()
                self.assertEqual(len(json.loads(output)["frames"]), 100)
            else:
                self.assertEqual((code, output, errors.count("\n")), (1, "", 1), errors)
        self.assertTrue(told)
        for line in told:
            self.assertRegex(line, r"^occlod: .*planet\.ohlod: node \d+: cannot be read")

    def test_removed_or_replaced_while_open(self):
        """With a simulated disk all runs draw the same."""
        path, other = self.folder / "planet.ohlod", self.folder / "other.ohlod"
        whole = path.read_bytes()
        compare = self.on_a_simulated_disk(60)
        expected = self.hashes(json.loads(subprocess.run(compare, cwd=self.folder, env=self.environment, capture_output=True, check=True).stdout))
        for change in (path.unlink, lambda: other.replace(path)):
            for program in (compare, None):
                path.write_bytes(whole)
                other.write_bytes(b"something else")
                code, output, errors = self.changed_while_open(change, "--memory", "64M", "--frames", 60, program=program)
                self.assertEqual((code, errors), (0, ""))
                hashes = self.hashes(json.loads(output))
                self.assertEqual(hashes if program else len(hashes), expected if program else 60)



class HlodDamage(Paged):
    """Bits flipped anywhere, and files cut anywhere: one line, or a coarser picture."""

    def setUp(self):
        super().setUp()
        self.build()
        self.commands = {"render": self.arguments("a.ohlod"), "cache": self.arguments("a.ohlod", "--memory", "8M", "--load", "blocking"),
                         "validate": ["hlod", "validate", "a.ohlod", "--fronts", 4]}

    def ends(self, content):
        """Of each command, within a minute and little memory: exit, output, errors."""
        (self.folder / "a.ohlod").write_bytes(content)
        ends = {}
        for name, arguments in self.commands.items():
            done = subprocess.run([OCCLOD, *map(str, arguments)], cwd=self.folder, env=self.environment, capture_output=True, text=True, timeout=LONGEST_S, check=False,
                                  preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (LARGEST, LARGEST)))
            ends[name] = (done.returncode, done.stdout, done.stderr)
        return ends

    def assert_one_line(self, end, told):
        code, output, errors = end
        self.assertEqual((code, output, errors.count("\n")), (1, "", 1), f"{told}: {errors}")
        self.assertRegex(errors, r"^occlod: error: .*a\.ohlod", told)

    def check_flips(self, name):
        content = (self.folder / name).read_bytes()
        expected = {command: self.hashes(json.loads(end[1])) if command != "validate" else end for command, end in self.ends(content).items()}
        generator = random.Random(len(content))
        coarser = 0
        for _ in range(FLIPS):
            place, bit = generator.randrange(len(content)), generator.randrange(8)
            flipped = bytearray(content)
            flipped[place] ^= 1 << bit
            told = f"{name}: bit {bit} of byte {place}"
            ends = self.ends(flipped)
            if ends["validate"][0] != 0:
                self.assert_one_line(ends["validate"], told)
            for command in ("render", "cache"):
                code, output, errors = ends[command]
                if code != 0:
                    self.assert_one_line(ends[command], told)
                    continue
                drawn = self.hashes(json.loads(output))
                if errors:  # every line names a node that never comes
                    self.assertEqual(command, "cache", told)
                    for line in errors.splitlines():
                        self.assertRegex(line, r"a\.ohlod: node \d+: is damaged", told)
                    coarser += drawn != expected[command]
                else:  # nothing that was drawn is damaged
                    self.assertEqual(drawn, expected[command], told)
            if ends["validate"][0] == 0:  # between sections, so nobody minds
                self.assertEqual((ends["render"][0], ends["cache"][0], ends["cache"][2]), (0, 0, ""), told)
        self.assertGreater(coarser, 0)

    def test_flipped_bits(self):
        self.check_flips("planet.ohlod")

    def test_flipped_bits_with_wedges(self):
        self.check_flips("grid.ohlod")

    def test_cut_files(self):
        generator = random.Random(7)
        for name in ("planet.ohlod", "grid.ohlod"):
            content = (self.folder / name).read_bytes()
            for size in (0, 1, 8, 31, 32, 33, 79, 80, len(content) - 1, *(generator.randrange(len(content)) for _ in range(20))):
                for end in self.ends(content[:size]).values():
                    self.assert_one_line(end, f"{name} of {size} bytes")


if __name__ == "__main__":
    unittest.main(verbosity=1)
