"""What goes wrong around the built command `occlod`: files that change or cannot be read or written, too little memory, kills. Each ends in exit 1 and
one line that names what failed, and leaves the file that was there. Tests wait for states of the process, never for a time."""
import json
import math
import os
import pathlib
import random
import re
import resource
import signal
import struct
import subprocess
import time
import unittest
import zlib

from tool_case import OCCLOD, ToolTest

OLD = b"what was there before"
NOBODY = 65534
ATTEMPTS = 50


class Faults(ToolTest):
    def start(self, *arguments, **options):
        return subprocess.Popen([OCCLOD, *map(str, arguments)], cwd=self.folder, env=self.environment, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, **options)

    def end_of(self, process):
        with process:
            output, errors = process.communicate()
        return process.returncode, output, errors

    def run_limited(self, limit, value, *arguments):
        def set_limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_DFL)  # Python ignores it, and so would what it starts
            resource.setrlimit(limit, (value, value))
        return self.end_of(self.start(*arguments, preexec_fn=set_limit))

    def assert_failed(self, end, *parts):
        """Exit 1, nothing on standard output, one line that has all parts."""
        code, output, errors = end
        self.assertEqual((code, output, errors.count("\n")), (1, "", 1), errors)
        self.assertTrue(errors.startswith("occlod: error: "), errors)
        for part in parts:
            self.assertIn(part, errors)

    def names(self):
        return sorted(path.name for path in self.folder.iterdir())

    def make_large_hierarchy(self, level=8):
        self.succeed("generate", "rough-planet", f"level={level}", "-o", "planet.ply")
        self.succeed("build", "planet.ply", "-o", "planet.olod")
        return self.folder / "planet.olod"


class ChangingFiles(Faults):
    def change_while_mapped(self, change, *arguments):
        """Stops the command while it has planet.olod or planet.ohlod mapped, calls change(), and lets it go on. Returns its end."""
        process = self.start(*arguments)
        maps = pathlib.Path(f"/proc/{process.pid}/maps")
        while process.poll() is None:
            if re.search(r"planet\.oh?lod", maps.read_text()):
                os.kill(process.pid, signal.SIGSTOP)
                os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WEXITED | os.WNOWAIT)
                change()
                os.kill(process.pid, signal.SIGCONT)
                break
        return self.end_of(process)

    def test_cut_short_while_mapped(self):
        """Pages that are gone raise SIGBUS, which would end the command without a word. It may have looked at all that it needs before it was
        stopped: then the next attempt counts."""
        path = self.make_large_hierarchy()
        whole = path.read_bytes()
        (self.folder / "target.obj").write_bytes(OLD)
        for arguments in (["info", "--all", "planet.olod"], ["validate", "planet.olod"], ["render", "planet.olod", "--budget", "100000", "--repeat", "50"],
                          ["cut", "planet.olod", "--error", "0", "-o", "target.obj"]):
            for _ in range(ATTEMPTS):
                path.write_bytes(whole)
                end = self.change_while_mapped(lambda: os.truncate(path, 4096), *arguments)
                if end[0] != 0 and "or has extra bytes" not in end[2]:  # which is said of files that were short when they were opened
                    break
            self.assert_failed(end, "planet.olod", "was cut short")
            self.assertEqual((self.folder / "target.obj").read_bytes(), OLD)

    def test_many_threads_tell_once(self):
        """Each meets a page that is gone."""
        path = self.make_large_hierarchy()
        whole = path.read_bytes()
        for _ in range(ATTEMPTS):
            path.write_bytes(whole)
            end = self.change_while_mapped(lambda: os.truncate(path, 4096), "render", "planet.olod", "--budget", "100000", "--repeat", "50", "--threads", "8")
            if end[0] != 0 and "or has extra bytes" not in end[2]:
                self.assert_failed(end, "planet.olod", "was cut short")

    def test_hlod_cut_short_while_mapped(self):
        self.succeed("generate", "rough-planet", "level=8", "-o", "planet.ply")
        self.succeed("hlod", "build", "planet.ply", "-o", "planet.ohlod")
        path = self.folder / "planet.ohlod"
        whole = path.read_bytes()
        for arguments in (["hlod", "info", "--all", "planet.ohlod"], ["hlod", "validate", "planet.ohlod"]):
            for _ in range(ATTEMPTS):
                path.write_bytes(whole)
                end = self.change_while_mapped(lambda: os.truncate(path, 4096), *arguments)
                if end[0] != 0 and "or has extra bytes" not in end[2]:  # which is said of files that were short when they were opened
                    break
            self.assert_failed(end, "planet.ohlod", "was cut short")

    def test_removed_or_replaced_while_mapped(self):
        """The pages live on, so nothing changes."""
        path = self.make_large_hierarchy(6)
        arguments = ["render", "planet.olod", "--budget", "20000", "--repeat", "20", "--json"]
        expected = self.json_of(*arguments[:-1])["hash"]
        other = self.folder / "other.olod"
        kept = path.read_bytes()
        for change in (lambda: path.unlink(), lambda: other.replace(path)):
            path.write_bytes(kept)
            other.write_bytes(OLD)
            code, output, errors = self.change_while_mapped(change, *arguments)
            self.assertEqual(code, 0, errors)
            self.assertIn(expected, output)


class Writing(Faults):
    def commands(self):
        """Each writes a file of more than 64 kB."""
        self.make_hierarchy()
        return {"target.olod": ["build", "planet.ply"], "target.ohlod": ["hlod", "build", "planet.ply"], "target.ply": ["generate", "rough-planet", "level=6"], "target.obj": ["cut", "planet.olod", "--error", 0],
                "target.png": ["render", "planet.olod", "--budget", 3000, "--size", "1024x768", "--png"]}

    def test_disk_full(self):
        """The limit of file sizes stands for a full disk: it fails in the same calls."""
        for target, command in self.commands().items():
            (self.folder / target).write_bytes(OLD)
            before = self.names()
            output = command if command[-1] == "--png" else [*command, "-o"]
            for size in (0, 5000):
                self.assert_failed(self.run_limited(resource.RLIMIT_FSIZE, size, *output, target), target, "File too large", "space on the disk")
                self.assertEqual((self.folder / target).read_bytes(), OLD)
                self.assertEqual(self.names(), before)

    def test_output_full(self):
        """The result goes to standard output as the last thing."""
        self.make_hierarchy()
        with open("/dev/full", "w") as full:
            done = subprocess.run([OCCLOD, "info", "planet.olod", "--json"], cwd=self.folder, stdout=full, stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("standard output: No space left on device", done.stderr)

    def test_cache_that_cannot_be_written(self):
        """A cache only saves time: the picture is made all the same, with a note."""
        self.make_planet()
        self.write_scene('{"objects": [{"mesh": "planet.ply"}], "cameras": {"default": {"eye": [0, 0, 4], "target": [0, 0, 0]}}}')
        code, output, errors = self.run_limited(resource.RLIMIT_FSIZE, 5000, "render", "scene.json", "--json", "--budget", 1000)
        self.assertEqual(code, 0, errors)
        self.assertIn("is not cached", errors)
        self.assertEqual([path for path in (self.folder / "cache").rglob("*") if path.is_file()], [])

    def test_killed_while_writing(self):
        """The old file stays. What is left beside it goes when the same file is written next: once it is a minute old and its process has ended, so
        that no file is taken from somebody who still writes it."""
        self.succeed("generate", "rough-planet", "level=8", "-o", "planet.ply")
        target = self.folder / "target.obj"
        target.write_bytes(OLD)
        for _ in range(ATTEMPTS):
            process = self.start("generate", "rough-planet", "level=8", "-o", target.name)
            while process.poll() is None and not any(name.endswith(".tmp") for name in self.names()):
                continue
            process.kill()
            self.end_of(process)
            leftovers = [name for name in self.names() if name.endswith(".tmp")]
            if leftovers:
                break
            target.write_bytes(OLD)
        self.assertEqual(target.read_bytes(), OLD)
        self.assertEqual(leftovers, [f".target.obj.{process.pid}-0.tmp"])

        long_ago = time.time() - 3600
        others = [f".target.obj.{os.getpid()}-0.tmp", f".other.obj.{process.pid}-0.tmp", ".target.obj.mine.tmp", f".target.obj.{process.pid}-0.bak"]
        for name in others:
            (self.folder / name).write_bytes(OLD)
            os.utime(self.folder / name, (long_ago, long_ago))
        write = ["generate", "rough-planet", "level=2", "-o", target.name]
        self.succeed(*write)
        self.assertIn(leftovers[0], self.names())  # may be written by another machine
        os.utime(self.folder / leftovers[0], (long_ago, long_ago))
        self.succeed(*write)
        self.assertEqual(self.names(), sorted([*others, "planet.ply", target.name]))


class HlodBuildCase(Faults):
    """Builds that keep to a memory limit, whose arrays lie in scratch files."""
    BUILD = ["hlod", "build", "planet.ply", "-o", "a.ohlod", "--memory", "64M"]

    def setUp(self):
        super().setUp()
        self.succeed("generate", "rough-planet", "level=8", "-o", "planet.ply")
        (self.folder / "scratch").mkdir()


class HlodBuild(HlodBuildCase):
    def test_scratch_too_large(self):
        """The limit of file sizes stands for a full disk."""
        (self.folder / "a.ohlod").write_bytes(OLD)
        self.assert_failed(self.run_limited(resource.RLIMIT_FSIZE, 8 << 20, *self.BUILD, "--scratch", "scratch"),
                           "scratch: has no room for", "MiB more of scratch", "File too large", "name a folder on another one")
        self.assertEqual((self.folder / "a.ohlod").read_bytes(), OLD)
        self.assertEqual(self.names(), ["a.ohlod", "planet.ply", "scratch"])
        self.assertEqual(list((self.folder / "scratch").iterdir()), [])

    def run_on_small_disk(self, megabytes, *arguments):
        """With the folder `small` on a disk of so many megabytes, which has the file a.ohlod. Returns how the command ended; what is on the disk
        then lies in the folder `kept`."""
        (self.folder / "small").mkdir()
        within = ["unshare", "-rm", "sh", "-c"]
        mount = f"mount -t tmpfs -o size={megabytes}m none small"
        try:
            possible = subprocess.run([*within, mount], cwd=self.folder, capture_output=True).returncode == 0
        except FileNotFoundError:
            possible = False
        if not possible:
            self.skipTest("SKIPPED: this needs unshare(1) and leave to mount a tmpfs in a user namespace")
        script = mount + " && printf old > small/a.ohlod; \"$@\"; code=$?; cp -a small kept; exit $code"
        with subprocess.Popen([*within, script, "sh", OCCLOD, *map(str, arguments)], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True) as process:
            output, errors = process.communicate()
        return process.returncode, output, errors

    def test_disk_full_of_scratch(self):
        self.assert_failed(self.run_on_small_disk(6, *self.BUILD, "--scratch", "small"), "small: has no room for", "No space left on device")
        self.assertEqual([path.name for path in (self.folder / "kept").iterdir()], ["a.ohlod"])
        self.assertEqual(self.names(), ["kept", "planet.ply", "scratch", "small"])

    def test_disk_full_with_journal(self):
        """What was finished stays, and the build goes on from it where there is room: whether the journal, 17.1 MB, did not fit, or the output, 18.9 MB.
        The limit of file sizes stands for a full disk."""
        build = ["hlod", "build", "planet.ply", "-o", "a.ohlod", "--within", "splits", "--compress", "none"]
        nodes = self.json_of(*build)["nodes"]
        whole = (self.folder / "a.ohlod").read_bytes()
        (self.folder / "a.ohlod").write_bytes(OLD)
        for size, refused in ((14_000_000, "a.ohlod.journal"), (18_000_000, "a.ohlod")):
            end = self.run_limited(resource.RLIMIT_FSIZE, size, *build, "--resume")
            self.assert_failed(end, f"error: {refused}: cannot be written: File too large", "space on the disk")
            self.assertEqual((self.folder / "a.ohlod").read_bytes(), OLD)
            self.assertEqual(self.names(), ["a.ohlod", "a.ohlod.journal", "planet.ply", "scratch"])
        found = self.json_of(*build, "--resume")["nodes_found"]
        self.assertTrue(nodes // 5 < found < nodes, found)
        self.assertEqual((self.folder / "a.ohlod").read_bytes(), whole)
        self.assertEqual(self.names(), ["a.ohlod", "planet.ply", "scratch"])

    def test_disk_full_of_output(self):
        arguments = [argument.replace("a.ohlod", "small/a.ohlod") for argument in (*self.BUILD, "--compress", "none")]
        self.assert_failed(self.run_on_small_disk(6, *arguments, "--scratch", "scratch"), "small/a.ohlod", "No space left on device", "space on the disk")
        self.assertEqual([path.name for path in (self.folder / "kept").iterdir()], ["a.ohlod"])
        self.assertEqual((self.folder / "kept" / "a.ohlod").read_text(), "old")
        self.assertEqual(self.names(), ["kept", "planet.ply", "scratch", "small"])
        self.assertEqual(list((self.folder / "scratch").iterdir()), [])


class HlodKills(HlodBuildCase):
    def leftovers(self):
        """What killed builds have left: files that were being written, which the next build removes once they are a minute old."""
        names = [name for name in self.names() if name not in ("planet.ply", "scratch")]
        for name in names:
            self.assertRegex(name, r"^\.a\.ohlod\.[0-9]+-0\.tmp$")
        self.assertEqual(list((self.folder / "scratch").iterdir()), [])
        return names

    def kept_of(self, journal):
        """The bytes that the next build keeps, at least: whole records, but of groups only when a record follows them.
        A record is the size of its body, two checksums and the body. One of four bytes begins groups, which go on with
        pieces, all but the last of 1 MiB."""
        bytes_ = journal.read_bytes()
        place = kept = 120
        in_groups = False
        while place + 24 <= len(bytes_):
            size = int.from_bytes(bytes_[place:place + 8], "little")
            place += 24 + size
            if place > len(bytes_):
                break
            in_groups = size == 4 or (in_groups and size == 1 << 20)
            if not in_groups:
                kept = place
        return kept if kept > 120 else 0

    def test_killed_at_any_moment(self):
        """At random moments of all its time, and of that in which it writes."""
        build = [*self.BUILD, "--scratch", "scratch"]
        began = time.monotonic()
        self.assertGreater(self.json_of(*build)["scratch_bytes"], 0)
        duration = time.monotonic() - began
        whole = (self.folder / "a.ohlod").read_bytes()
        (self.folder / "a.ohlod").unlink()
        moments, killed = random.Random(1), 0
        for attempt in range(20):
            process = self.start(*build)
            if attempt % 4 == 0:
                while process.poll() is None and f".a.ohlod.{process.pid}-0.tmp" not in self.names():
                    continue
            else:
                try:
                    process.wait(moments.uniform(0, duration))
                except subprocess.TimeoutExpired:
                    pass
            process.kill()
            killed += self.end_of(process)[0] != 0
            target = self.folder / "a.ohlod"
            if target.exists():  # it was faster than the first, or killed at its very end
                self.assertEqual(target.read_bytes(), whole)
                target.unlink()
            left = self.leftovers()
        self.assertGreaterEqual(killed, 5)
        for name in left:
            os.utime(self.folder / name, (0, 0))
        self.succeed(*build)
        self.assertEqual((self.folder / "a.ohlod").read_bytes(), whole)
        self.assertEqual(self.names(), ["a.ohlod", "planet.ply", "scratch"])

    def test_killed_again_and_again_and_resumed(self):
        """Each build goes on where the one before was killed: at random moments, each time a little later, until one ends."""
        build = [*self.BUILD, "--scratch", "scratch", "--node-triangles", "64"]
        began = time.monotonic()
        nodes = self.json_of(*build)["nodes"]
        duration = time.monotonic() - began
        whole, target, journal = (self.folder / "a.ohlod").read_bytes(), self.folder / "a.ohlod", self.folder / "a.ohlod.journal"
        moments = random.Random(2)
        max_found = 0
        for story in range(3):
            target.unlink()
            kills, kept = 0, 0
            while True:
                process = self.start(*build, "--resume", "--threads", moments.choice((1, 2, 3)), "--json")
                try:
                    process.wait(moments.uniform(0.2, 0.5 + 0.1 * kills) * duration)
                except subprocess.TimeoutExpired:
                    process.kill()
                code, output, errors = self.end_of(process)
                if code == 0:
                    found = json.loads(output)["nodes_found"]
                    self.assertLessEqual(found, nodes)
                    max_found = max(max_found, found)
                    break
                self.assertEqual(code, -signal.SIGKILL, errors)
                kills += 1
                if target.exists():  # killed at its very end
                    journal.unlink(missing_ok=True)
                    break
                if journal.exists() or kept > 0:
                    self.assertGreaterEqual(journal.stat().st_size, kept)
                    kept = self.kept_of(journal)
            self.assertEqual(target.read_bytes(), whole)
            if kills == 0:  # it was much faster than the first
                duration /= 2
            left = [name for name in self.names() if name not in ("a.ohlod", "planet.ply", "scratch")]
            for name in left:
                self.assertRegex(name, r"^\.a\.ohlod\.[0-9]+-0\.tmp$")
                (self.folder / name).unlink()
            self.assertEqual(list((self.folder / "scratch").iterdir()), [])
        self.assertGreater(max_found, 0)

    def make_textured(self, cells=96, side=1024):
        """Hills with an image of noise, which takes long to pack."""
        chance = random.Random(3)
        rows = b"".join(b"\0" + chance.randbytes(3 * side) for _ in range(side))
        chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        (self.folder / "hills.png").write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)) +
                                                chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b""))
        (self.folder / "hills.mtl").write_text("newmtl hills\nmap_Kd hills.png\n")
        numbers = range(cells + 1)
        lines = ["mtllib hills.mtl", "usemtl hills", *(f"v {x} {y} {math.sin(x / 5) * math.cos(y / 7):.4f}\nvt {x / cells} {y / cells}" for y in numbers for x in numbers)]
        corner = lambda x, y: "{0}/{0}".format(y * (cells + 1) + x + 1)
        for y in range(cells):
            lines += [f"f {corner(x, y)} {corner(x + 1, y)} {corner(x + 1, y + 1)} {corner(x, y + 1)}" for x in range(cells)]
        (self.folder / "hills.obj").write_text("\n".join(lines))

    def test_killed_again_and_again_while_images_are_made(self):
        """Each build is killed once it has kept further images, until none are left to make."""
        self.make_textured()
        build = ["hlod", "build", "hills.obj", "-o", "a.ohlod", "--node-triangles", "64"]
        self.succeed(*build)
        target, journal = self.folder / "a.ohlod", self.folder / "a.ohlod.images.journal"
        whole = target.read_bytes()
        target.unlink()

        def size():
            try:
                return journal.stat().st_size
            except FileNotFoundError:  # not there yet, or removed
                return 0

        kills, kept = 0, 0
        while True:
            process = self.start(*build, "--resume", "--threads", 1 + kills % 3)
            while process.poll() is None and size() <= kept + len(whole) // 12:
                continue
            process.kill()
            if self.end_of(process)[0] == 0 or target.exists():
                break
            kills += 1
            self.assertGreater(size(), kept)  # nothing that was kept is made again
            kept = size()
        self.assertGreaterEqual(kills, 3)
        self.assertEqual(target.read_bytes(), whole)


class Permissions(Faults):
    def as_nobody(self, *arguments):
        """The rules do not hold for root."""
        def drop():
            if os.getuid() == 0:
                os.setgroups([])
                os.setgid(NOBODY)
                os.setuid(NOBODY)
        try:
            return self.end_of(self.start(*arguments, preexec_fn=drop))
        except (PermissionError, subprocess.SubprocessError) as error:
            self.skipTest(f"cannot run {OCCLOD} as another user: {error}")

    def test_unreadable(self):
        self.make_hierarchy()
        self.folder.chmod(0o755)
        closed = self.folder / "closed"
        closed.mkdir()
        for name in ("planet.olod", "planet.ply"):
            (closed / name).write_bytes((self.folder / name).read_bytes())
        closed.chmod(0)
        for name in ("planet.olod", "planet.ply"):
            self.assert_failed(self.as_nobody("info", f"closed/{name}"), f"closed/{name}")
            (self.folder / name).chmod(0)
            self.assert_failed(self.as_nobody("info", name), name, "cannot be opened")
        self.assert_failed(self.as_nobody("generate", "rough-planet", "level=2", "-o", "closed/target.ply"), "closed/target.ply")
        closed.chmod(0o755)
        self.assert_failed(self.as_nobody("generate", "rough-planet", "level=2", "-o", "closed/target.ply"), "closed/target.ply", "cannot be written",
                           "permissions of the folder")


class StandardStreams(Faults):
    """A stream that is closed, or leads to a full disk, ends no command by a signal, and what is printed gets into no file. Lost messages are lost;
    a lost result is a failure."""
    CLOSED, FULL = "closed", "full"

    def run_without(self, output, errors, *arguments):
        """Each stream is None (captured), CLOSED or FULL. Exit code and what was captured of standard error."""
        def open_stream(kind):
            return open("/dev/full", "w") if kind == self.FULL else open(os.devnull, "w")
        def close():
            for kind, number in ((output, 1), (errors, 2)):
                if kind == self.CLOSED:
                    os.close(number)
        with open_stream(output) as stdout, open_stream(errors) as stderr:
            done = subprocess.run([OCCLOD, *map(str, arguments)], cwd=self.folder, env=self.environment, text=True, preexec_fn=close,
                                  stdout=stdout if output else subprocess.PIPE, stderr=stderr if errors else subprocess.PIPE)
        return done.returncode, done.stderr

    def test_errors_that_cannot_be_told(self):
        self.make_hierarchy()
        for kind in (self.CLOSED, self.FULL):
            for code, arguments in ((1, ["info", "none.olod"]), (1, ["render", "none.json"]), (2, ["paint"]), (2, ["build"]), (0, ["info", "planet.olod"])):
                self.assertEqual(self.run_without(None, kind, *arguments)[0], code, (kind, arguments))

    def test_files_are_right_all_the_same(self):
        """Standard error has the number of the first file that is opened where it is closed, and shows progress while that is written."""
        self.make_hierarchy()
        commands = {"copy.ply": ["generate", "rough-planet", "level=4", "-o"], "copy.olod": ["build", "planet.ply", "-o"],
                    "copy.off": ["cut", "planet.olod", "--error", 0, "-o"]}
        for target, command in commands.items():
            self.succeed(*command, target)
            expected = (self.folder / target).read_bytes()
            for output, errors in ((None, self.CLOSED), (None, self.FULL), (self.CLOSED, None), (self.FULL, None), (self.CLOSED, self.CLOSED),
                                   (self.FULL, self.CLOSED)):
                (self.folder / target).unlink()
                code, told = self.run_without(output, errors, *command, target, "--progress", "always")
                self.assertEqual(code, 1 if output else 0, (output, errors, told))
                self.assertEqual((self.folder / target).read_bytes(), expected, (output, errors))

    def test_results_that_cannot_be_told(self):
        self.make_hierarchy()
        self.write_scene(json.dumps({"objects": [{"mesh": "planet.olod"}], "cameras": {"default": {"eye": [0, 0, 3], "target": [0, 0, 0]}},
                                     "paths": {"long": {"frames": 60, "keys": [{"eye": [0, 0, 3], "target": [0, 0, 0], "width": 16, "height": 12}]}}}))
        path = ["render", "scene.json", "--budget", 100, "--path", "long"]  # its rows are more than is kept back before it is written
        for arguments in (["--version"], ["--help"], ["render", "--help"], ["info", "planet.olod"], ["validate", "planet.olod"], path, [*path, "--json"]):
            for kind, reason in ((self.CLOSED, "Bad file descriptor"), (self.FULL, "No space left on device")):
                code, told = self.run_without(kind, None, *arguments)
                self.assertEqual((code, told.count("\n")), (1, 1), told)
                self.assertTrue(told.startswith(f"occlod: error: standard output: {reason}; "), told)


class Memory(Faults):
    def test_too_little(self):
        """From hardly enough to start up to enough: each build succeeds, or fails in one line and leaves the old file. Threads beside the calling one
        run out of it as well."""
        self.succeed("generate", "rough-planet", "level=7", "-o", "planet.ply")
        target = self.folder / "target.olod"
        target.write_bytes(OLD)
        before = self.names()
        mib = 1 << 20
        least = next((size for size in range(16, 4096, 16) if self.run_limited(resource.RLIMIT_AS, size * mib, "--version")[0] == 0), None)
        if least is None:
            self.skipTest("SKIPPED: starts in no limited address space: built with a sanitizer")
        failures = 0
        for extra in (*range(0, 120, 5), 1000):
            end = self.run_limited(resource.RLIMIT_AS, (least + extra) * mib, "build", "planet.ply", "-o", target.name)
            if end[0] == 0:
                self.assertNotEqual(target.read_bytes(), OLD)
                target.write_bytes(OLD)
            else:
                failures += 1
                self.assert_failed(end, "memory")
                self.assertEqual(target.read_bytes(), OLD)
            self.assertEqual(self.names(), before)
        self.assertEqual(end[0], 0, end[2])
        self.assertGreater(failures, 5)


if __name__ == "__main__":
    unittest.main(verbosity=1)
