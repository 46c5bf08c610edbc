"""occlod.distributed: view cells and HLODs built by several processes have the bytes of one, whatever is killed or damaged
meanwhile."""
import json
import os
import pathlib
import pickle
import resource
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import occlod

try:
    import distributed
except ImportError as error:
    raise unittest.SkipTest("Dask.distributed is not installed") from error
import occlod.distributed  # noqa: E402  pylint: disable=wrong-import-position

SCENE = """{"objects": [{"generator": "city", "options": {"blocks": 2, "facade_cells": 2}}],
            "cameras": {"default": {"eye": [0, 0, 2], "target": [10, 10, 2], "up": [0, 0, 1]}}}"""
OPTIONS = occlod.CellTreeOptions([occlod.CellBox((0, 0, 1), (96, 64, 3))], root_cell=16, smallest_cell=8, max_triangles=200)
# What connects to a scheduler, builds, and says how far it is.
DRIVER = """
import pickle, sys
import distributed, occlod.distributed
scheduler, scene, path, options = sys.argv[1:]
with distributed.Client(scheduler) as client:
    occlod.distributed.build_cells(scene, pickle.loads(bytes.fromhex(options)), path, client=client, shards=24,
                                   progress=lambda done: print(done, flush=True))
"""


class Poison(distributed.WorkerPlugin):
    """Ends a worker that is to build this root cell. In new workers, too, since the scheduler hands it on."""

    def __init__(self, root):
        self.root = root

    def setup(self, worker):
        import occlod.distributed as module  # pylint: disable=import-outside-toplevel

        build, root = module._build_of, self.root

        class Poisoned:
            def __init__(self, whole):
                self.whole, self.part_name, self.has_part = whole, whole.part_name, whole.has_part

            @property
            def cuts(self):
                return self.whole.cuts

            def write_part(self, part, shard, **options):
                if shard[0] <= root < shard[0] + shard[1]:
                    os._exit(3)
                self.whole.write_part(part, shard, **options)

        module._build_of = lambda scene, options: Poisoned(build(scene, options))


class Clusters(unittest.TestCase):
    """Makes clusters of this machine, and a folder for all tests of a class."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="occlod-distributed-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        pickle.loads(pickle.dumps(Poison))  # found by name in this module: nothing of it is sent to workers
        os.environ["PYTHONPATH"] = os.pathsep.join([str(pathlib.Path(__file__).parent), os.environ.get("PYTHONPATH", "")])

    def cluster(self, workers=2):
        cluster = distributed.LocalCluster(n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=":0", silence_logs=50)
        self.addCleanup(cluster.close)
        client = distributed.Client(cluster)
        self.addCleanup(client.close)
        return client


class Cells(Clusters):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene = cls.folder / "city.json"
        cls.scene.write_text(SCENE)
        cls.build = occlod.CellBuild(occlod.Scene.read(cls.scene).load(), OPTIONS)
        cls.build.write(cls.folder / "one.vlod", threads=1)
        cls.expected = (cls.folder / "one.vlod").read_bytes()

    def run_build(self, client, name, shards=24, **options):
        """Into a folder of its own."""
        path = self.folder / name / "city.vlod"
        path.parent.mkdir(exist_ok=True)
        report = occlod.distributed.build_cells(self.scene, OPTIONS, path, client=client, shards=shards, **options)
        self.assertEqual(path.read_bytes(), self.expected)
        return report

    def parts(self, name):
        return sorted((self.folder / name / "city.vlod.parts").iterdir())

    def test_bytes_do_not_depend_on_workers_and_shards(self):
        self.assertEqual(self.build.root_cells, 24)
        for workers, shards in ((1, 1), (2, 7), (3, 100)):
            report = self.run_build(self.cluster(workers), f"w{workers}", shards)
            self.assertEqual((report.shards, report.found, report.halved), (min(shards, 24), 0, 0))
            self.assertEqual(report.cuts, self.build.cuts)
            self.assertGreater(report.worker_seconds, 0)

    def test_a_worker_is_killed(self):
        client, killed = self.cluster(), []

        def kill(done):
            if done > 0.3 and not killed:
                killed.append(next(iter(client.run(os.getpid).values())))
                os.kill(killed[0], signal.SIGKILL)

        report = self.run_build(client, "killed", progress=kill)
        self.assertTrue(killed)
        self.assertEqual((report.shards, report.found), (24, 0))

    def test_the_driver_is_killed(self):
        client = self.cluster()
        path = self.folder / "driver" / "city.vlod"
        path.parent.mkdir()
        command = [sys.executable, "-c", DRIVER, client.scheduler.address, self.scene, path, pickle.dumps(OPTIONS).hex()]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as driver:
            for line in driver.stdout:
                if float(line) >= 0.6:
                    driver.send_signal(signal.SIGKILL)
        self.assertFalse(path.exists())
        report = self.run_build(client, "driver")
        self.assertGreaterEqual(report.found, 14)
        self.assertEqual(report.shards, 24)

    def test_damaged_parts_are_built_again(self):
        client = self.cluster()
        self.run_build(client, "damaged")
        parts = self.parts("damaged")
        kept = {part: part.stat().st_mtime_ns for part in parts[3:]}
        parts[0].write_bytes(parts[0].read_bytes()[:-20])
        data = bytearray(parts[1].read_bytes())
        data[len(data) // 2] ^= 4
        parts[1].write_bytes(data)
        parts[2].write_bytes(parts[3].read_bytes())  # of other root cells
        report = self.run_build(client, "damaged")
        self.assertEqual((report.shards, report.found), (24, 21))
        self.assertEqual(kept, {part: part.stat().st_mtime_ns for part in kept})

    def test_a_root_cell_that_kills_is_named(self):
        client = self.cluster()
        client.register_plugin(Poison(5), name="poison")
        with self.assertRaisesRegex(occlod.Error, "root cell 5: kills the workers"):
            self.run_build(client, "poison", shards=6)
        self.assertFalse((self.folder / "poison" / "city.vlod").exists())
        self.assertEqual(sum(int(part.stem.split("-")[2]) for part in self.parts("poison")), 23)  # all root cells but one
        client.close()
        report = self.run_build(self.cluster(), "poison", shards=6)
        self.assertEqual(report.found, report.shards - 1)

    def test_disk_full(self):
        client = self.cluster()
        client.run(resource.setrlimit, resource.RLIMIT_FSIZE, (100, resource.RLIM_INFINITY))
        with self.assertRaisesRegex(occlod.Error, r"\.vpart: "):
            self.run_build(client, "full")
        self.assertEqual([part for part in self.parts("full") if part.suffix == ".vpart"], [])
        client.run(resource.setrlimit, resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
        self.run_build(client, "full")

    def test_workers_with_another_scene_are_told(self):
        client = self.cluster(1)
        other = occlod.CellTreeOptions(OPTIONS.regions, root_cell=16, smallest_cell=8, max_triangles=199)
        task = occlod.distributed._Task(str(self.scene), other, str(self.folder), self.build.part_name((0, 1)), (0, 1), 1)
        with self.assertRaisesRegex(occlod.Error, "another scene"):
            client.submit(occlod.distributed._write_shard, task).result()


# What connects to a scheduler, builds an HLOD, and says how far it is.
HLOD_DRIVER = """
import sys
import distributed, occlod.distributed
scheduler, scene, path = sys.argv[1:]
with distributed.Client(scheduler) as client:
    occlod.distributed.build_hlod(scene, path, client=client, node_triangles=32, progress=lambda done: print(done, flush=True))
"""


class SlowOrDeadly(distributed.WorkerPlugin):
    """Makes workers sleep before each task, or end before one of this name."""

    def __init__(self, seconds=0.0, deadly=""):
        self.seconds, self.deadly = seconds, deadly

    def setup(self, worker):
        import occlod.distributed as module  # pylint: disable=import-outside-toplevel

        simplify = module.simplify_part

        def changed(task, *, threads):
            time.sleep(self.seconds)
            if pathlib.Path(task).stem == self.deadly:
                os._exit(3)
            simplify(task, threads=threads)

        module.simplify_part = changed


class Hlods(Clusters):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.mesh = cls.folder / "planet.ply"
        occlod.generate("rough-planet", level=7).write(cls.mesh)
        mesh, report = occlod.read_mesh_and_report(cls.mesh)
        occlod.build_hlod(mesh, node_triangles=32, threads=1).write(cls.folder / "one.ohlod", report=report)
        cls.expected = (cls.folder / "one.ohlod").read_bytes()

    def run_build(self, client, name, **options):
        """Into a folder of its own."""
        path = self.folder / name / "planet.ohlod"
        path.parent.mkdir(exist_ok=True)
        report = occlod.distributed.build_hlod(self.mesh, path, client=client, node_triangles=32, **options)
        self.assertEqual(path.read_bytes(), self.expected)
        self.assertEqual([file.name for file in path.parent.iterdir()], ["planet.ohlod"])  # all else is removed
        return report

    def test_bytes_do_not_depend_on_workers(self):
        for workers, options in ((1, {}), (2, {"task_threads": 2}), (3, {"threads": 1})):
            report = self.run_build(self.cluster(workers), f"w{workers}", **options)
            self.assertGreater(report.tasks, 100)  # of 16 groups or more, on two levels or more
            self.assertGreater(report.worker_seconds, 0)

    @unittest.skipUnless("OCCLOD" in os.environ, "OCCLOD does not name the command")
    def test_bytes_are_those_of_the_command(self):
        scene, client = self.folder / "city.json", self.cluster()
        scene.write_text(SCENE)
        for options, arguments in (
            ({"quantise_bits": 14}, ["--quantise", "14"]),
            ({"memory": 1 << 30, "compression": occlod.Compression.none}, ["--memory", "1G", "--compress", "none"]),
            ({"grouping": occlod.Grouping.nested, "borders": occlod.Borders.free, "error_bound": occlod.ErrorBound.measured},
             ["--grouping", "nested", "--borders", "free", "--error-bound", "measured"]),
            ({"within": occlod.Within.splits}, ["--within", "splits"]),
        ):
            for source in (self.mesh, scene):
                one, many = self.folder / "command.ohlod", self.folder / "many.ohlod"
                subprocess.run([os.environ["OCCLOD"], "hlod", "build", source, "-o", one, "--node-triangles", "32", *arguments],
                               check=True, stdout=subprocess.DEVNULL)
                occlod.distributed.build_hlod(source, many, client=client, node_triangles=32, **options)
                self.assertEqual(one.read_bytes(), many.read_bytes(), (source.name, options))

    def test_workers_are_killed(self):
        client, killed = self.cluster(), []

        def kill(done):
            if done > 0.25 * (1 + len(killed)) and len(killed) < 2:
                killed.append(next(iter(client.run(os.getpid).values())))
                os.kill(killed[-1], signal.SIGKILL)

        self.run_build(client, "killed", progress=kill)
        self.assertEqual(len(killed), 2)

    def test_the_driver_is_killed(self):
        """Three times, each time a little later: what is done is not done again."""
        client = self.cluster()
        client.register_plugin(SlowOrDeadly(0.02), name="slow")
        path = self.folder / "driver" / "planet.ohlod"
        path.parent.mkdir()
        command = [sys.executable, "-c", HLOD_DRIVER, client.scheduler.address, self.mesh, path]
        for share in (0.15, 0.35, 0.6):
            with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as driver:
                for line in driver.stdout:
                    if float(line) >= share:
                        driver.send_signal(signal.SIGKILL)
            self.assertFalse(path.exists())
        journal = path.with_name("planet.ohlod.journal")
        kept = journal.read_bytes()
        report = self.run_build(client, "driver")
        self.assertLess(report.tasks, self.run_build(client, "whole").tasks - 50)  # by then nine tenths of the first level's are joined
        if "OCCLOD" in os.environ:  # goes on from the same journal
            journal.write_bytes(kept)
            command = [os.environ["OCCLOD"], "hlod", "build", self.mesh, "-o", path, "--node-triangles", "32", "--resume", "--json"]
            told = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
            self.assertGreater(told["nodes_found"], 100)
            self.assertEqual(path.read_bytes(), self.expected)

    def test_a_task_that_kills_is_named(self):
        client = self.cluster()
        client.register_plugin(SlowOrDeadly(deadly="level-1-0"), name="deadly")
        with self.assertRaisesRegex(occlod.Error, r"level-1-0\.task: kills the workers"):
            self.run_build(client, "deadly")
        self.assertFalse((self.folder / "deadly" / "planet.ohlod").exists())
        client.close()
        self.run_build(self.cluster(), "deadly")

    def test_disk_full(self):
        client = self.cluster()
        client.run(resource.setrlimit, resource.RLIMIT_FSIZE, (100, resource.RLIM_INFINITY))
        with self.assertRaisesRegex(occlod.Error, r"\.nodes: "):
            self.run_build(client, "full", retries=0)
        client.run(resource.setrlimit, resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
        self.run_build(client, "full")

    def test_a_folder_that_not_all_see(self):
        client, patience = self.cluster(1), occlod.distributed.PATIENCE_S
        occlod.distributed.PATIENCE_S = 0.2
        self.addCleanup(setattr, occlod.distributed, "PATIENCE_S", patience)
        client.run(forget_tasks)
        with self.assertRaisesRegex(occlod.Error, "all machines see"):
            self.run_build(client, "unseen")

    def test_the_scene_is_not_overwritten(self):
        with self.assertRaisesRegex(occlod.Error, "would be overwritten"):
            occlod.distributed.build_hlod(self.mesh, self.mesh, client=self.cluster(1))


def forget_tasks():
    """On a worker: from now on it writes its results where nobody sees them."""
    import occlod.distributed as module  # pylint: disable=import-outside-toplevel

    module.simplify_part = lambda task, *, threads: None
