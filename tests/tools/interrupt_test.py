"""Signals end the built command `occlod` promptly and leave nothing half-written. Every test waits for a state that the command shows (a line
of its progress), never for a time."""
import os
import signal
import subprocess
import unittest

from tool_case import OCCLOD, ToolTest

OLD = b"what was there before"
ATTEMPTS = 20


class Interrupting(ToolTest):
    def start(self, *arguments):
        """With SIGINT handled even where this test runs in the background of a script, which has its children ignore it."""
        return subprocess.Popen([OCCLOD, *map(str, arguments), "--progress", "always"], cwd=self.folder, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))

    def wait_for_stage(self, process, stage):
        for line in process.stderr:
            if stage in line.decode():
                return
        self.fail(f"{process.args} ended before {stage}: exit {process.wait()}")

    def end_of(self, process):
        """Exit code, standard output and what is left of standard error."""
        with process:
            errors, output = process.stderr.read().decode(), process.stdout.read().decode()
        return process.returncode, output, errors

    def assert_cancelled(self, end, command, number):
        """As shells expect it, with one line about it and nothing on standard output."""
        code, output, errors = end
        self.assertEqual((code, output), (128 + number, ""), errors)
        messages = [line for line in errors.split("\n") if line.startswith("occlod: ")]
        self.assertEqual(messages, [f"occlod: error: {command}: was cancelled"])

    def names(self):
        return sorted(path.name for path in self.folder.iterdir())

    def cancel(self, stage, number, command, *arguments, target):
        (self.folder / target).write_bytes(OLD)
        before = self.names()
        process = self.start(*command.split(), *arguments, "-o", target)
        self.wait_for_stage(process, stage)
        process.send_signal(number)
        self.assert_cancelled(self.end_of(process), command, number)
        self.assertEqual((self.folder / target).read_bytes(), OLD)
        self.assertEqual(self.names(), before)

    def cancel_while_writing(self, number, command, *arguments, target):
        """The signal comes to a process that is stopped while it writes. It may have been stopped after its last look for signals, or after it
        ended: the target is new then and whole, and the next attempt counts."""
        path = self.folder / target
        path.write_bytes(OLD)
        before = self.names()
        for _ in range(ATTEMPTS):
            process = self.start(*command.split(), *arguments, "-o", target)
            self.wait_for_stage(process, "writing")
            os.kill(process.pid, signal.SIGSTOP)
            os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WEXITED | os.WNOWAIT)
            was_old = path.read_bytes() == OLD
            os.kill(process.pid, number)
            os.kill(process.pid, signal.SIGCONT)
            end = self.end_of(process)
            self.assertEqual(self.names(), before)
            if end[0] != 0:
                self.assertTrue(was_old)
                self.assert_cancelled(end, command, number)
                self.assertEqual(path.read_bytes(), OLD)
                return
            self.assertNotEqual(path.read_bytes(), OLD)
            path.write_bytes(OLD)
        self.fail(f"{command} was not caught while it wrote in {ATTEMPTS} attempts")

    def make_large_planet(self, level):
        self.succeed("generate", "rough-planet", f"level={level}", "-o", "planet.ply")


class Interrupt(Interrupting):
    def test_build(self):
        self.make_large_planet(8)
        for number in (signal.SIGINT, signal.SIGTERM):
            self.cancel("building", number, "build", "planet.ply", target="target.olod")
        self.cancel_while_writing(signal.SIGINT, "build", "planet.ply", target="target.olod")

    def test_hlod_build(self):
        self.make_large_planet(8)
        for number in (signal.SIGINT, signal.SIGTERM):
            self.cancel("building", number, "hlod build", "planet.ply", target="target.ohlod")
        self.cancel_while_writing(signal.SIGINT, "hlod build", "planet.ply", target="target.ohlod")

    def test_hlod_build_that_is_resumed(self):
        """A signal leaves the journal; the next build goes on from it, and removes it."""
        self.make_large_planet(8)
        self.succeed("hlod", "build", "planet.ply", "-o", "whole.ohlod", "--node-triangles", 32)
        journal, groups = self.folder / "a.ohlod.journal", 2 * 4 * 8 * 4**8  # first the groups of the input and of the next level
        for number in (signal.SIGINT, signal.SIGTERM):
            process = self.start("hlod", "build", "planet.ply", "-o", "a.ohlod", "--node-triangles", 32, "--resume")
            while process.poll() is None and not (journal.exists() and journal.stat().st_size > groups + 100_000):
                continue
            process.send_signal(number)
            self.assert_cancelled(self.end_of(process), "hlod build", number)
            self.assertEqual(self.names(), ["a.ohlod.journal", "planet.ply", "whole.ohlod"])
            again = self.json_of("hlod", "build", "planet.ply", "-o", "a.ohlod", "--node-triangles", 32, "--resume")
            self.assertGreater(again["nodes_found"], 100)
            self.assertTrue(self.same_bytes("a.ohlod", "whole.ohlod"))
            self.assertEqual(self.names(), ["a.ohlod", "planet.ply", "whole.ohlod"])
            (self.folder / "a.ohlod").unlink()

    def test_cells_build(self):
        self.make_large_planet(6)
        self.succeed("build", "planet.ply", "-o", "planet.olod")
        space = ["planet.olod", "--region", "-2.5,-0.5,-0.5,-1.5,0.5,0.5", "--root-cell", 0.125]
        for number in (signal.SIGINT, signal.SIGTERM):
            self.cancel("building", number, "cells build", *space, target="target.vlod")

    def test_cells_build_in_parts(self):
        """Signals end it between parts too; what is done is kept, and the rest is built when it is asked for again."""
        self.make_large_planet(6)
        self.succeed("build", "planet.ply", "-o", "planet.olod")
        space = ["cells", "build", "planet.olod", "--region", "-2.5,-0.5,-0.5,-1.5,0.5,0.5", "--root-cell", 0.25, "--tolerance", 4]
        process = self.start(*space, "-o", "a.vlod", "--work", "parts", "--threads", 1)
        self.wait_for_stage(process, "writing")
        process.send_signal(signal.SIGINT)
        end = self.end_of(process)
        if end[0] != 0:  # it may have come too late
            self.assert_cancelled(end, "cells build", signal.SIGINT)
            self.assertFalse((self.folder / "a.vlod").exists())
        self.assertEqual([path.name for path in (self.folder / "parts").iterdir() if path.suffix != ".vpart"], [])
        again = self.json_of(*space, "-o", "a.vlod", "--work", "parts")
        self.assertEqual(again["cuts"] + 16 * again["parts_found"], 64)
        self.succeed(*space, "-o", "b.vlod")
        self.assertTrue(self.same_bytes("a.vlod", "b.vlod"))

    def test_cells_merge(self):
        """A signal finds it while it merges, or comes too late: then the file is whole. Parts stay as they are."""
        self.make_large_planet(6)
        self.succeed("build", "planet.ply", "-o", "planet.olod")
        self.succeed("cells", "build", "planet.olod", "-o", "whole.vlod", "--work", "parts", "--region", "-2.5,-0.5,-0.5,-1.5,0.5,0.5", "--root-cell", 0.25, "--tolerance", 4)
        parts = {path.name: path.read_bytes() for path in (self.folder / "parts").iterdir()}
        target, caught = self.folder / "a.vlod", 0
        for number in (signal.SIGINT, signal.SIGTERM) * ATTEMPTS:
            target.write_bytes(OLD)
            process = self.start("cells", "merge", "parts", "-o", "a.vlod")
            self.wait_for_stage(process, "merging")
            process.send_signal(number)
            end = self.end_of(process)
            self.assertEqual({path.name: path.read_bytes() for path in (self.folder / "parts").iterdir()}, parts)
            self.assertEqual([name for name in self.names() if name.startswith(".")], [])
            if end[0] == 0:
                self.assertTrue(self.same_bytes("a.vlod", "whole.vlod"))
                continue
            self.assert_cancelled(end, "cells merge", number)
            self.assertEqual(target.read_bytes(), OLD)
            caught += 1
        self.assertGreater(caught, 0)

    def test_cells_pack(self):
        self.make_large_planet(7)
        self.succeed("build", "planet.ply", "-o", "planet.olod")
        self.succeed("cells", "build", "planet.olod", "--region", "-2.5,-0.5,-0.5,-1.5,0.5,0.5", "--root-cell", 0.5, "-o", "a.vlod")
        for number in (signal.SIGINT, signal.SIGTERM):
            self.cancel("packing", number, "cells pack", "a.vlod", "planet.olod", target="target.vlod")

    def test_generate(self):
        self.cancel("generating", signal.SIGINT, "generate", "rough-planet", "level=10", target="target.ply")
        for number in (signal.SIGINT, signal.SIGTERM):
            self.cancel_while_writing(number, "generate", "rough-planet", "level=8", target="target.obj")

    def test_cut(self):
        self.make_large_planet(7)
        self.succeed("build", "planet.ply", "-o", "planet.olod")
        self.cancel_while_writing(signal.SIGINT, "cut", "planet.olod", "--error", 0, target="target.obj")

    def test_ignored_signals_stay_ignored(self):
        """As for nohup and for the background jobs of scripts."""
        process = subprocess.Popen([OCCLOD, "generate", "rough-planet", "level=8", "-o", "planet.ply", "--progress", "always"],
                                   cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN))
        self.wait_for_stage(process, "generating")
        process.send_signal(signal.SIGINT)
        self.assertEqual(self.end_of(process)[0], 0)


class InterruptRepair(Interrupting):
    def test_repair(self):
        self.make_large_planet(7)
        self.cancel("orienting", signal.SIGINT, "repair", "planet.ply", target="target.obj")
        self.cancel_while_writing(signal.SIGTERM, "repair", "planet.ply", target="target.obj")


class ShowProgress(ToolTest):
    def test_stages_of_a_build_in_their_order(self):
        self.make_planet()
        for command in (["build", "planet.ply", "-o", "planet.olod"], ["hlod", "build", "planet.ply", "-o", "planet.ohlod"]):
            done = self.run_tool(*command, "--progress", "always", "--json")
            stages = [word for line in done.stderr.split("\n") for word in line.split() if word.endswith("ing")]
            self.assertEqual(list(dict.fromkeys(stages)), ["reading", "cleaning", "building", "writing"])

    def test_silent_unless_asked_for(self):
        """Standard error is no terminal here."""
        self.make_planet()
        for options in ([], ["--progress", "auto"], ["--progress", "never"]):
            done = self.run_tool("build", "planet.ply", "-o", "planet.olod", *options)
            self.assertEqual((done.returncode, done.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main(verbosity=1)
