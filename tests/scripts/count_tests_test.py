"""scripts/count_tests.py: single tests are counted whatever program they are in, and what was skipped is told."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/count_tests.py"
PASSED = '<testcase name="{0}" status="run" result="completed" classname="Suite"/>'
FAILED = '<testcase name="{0}" status="run" result="completed" classname="Suite"><failure message="1 is not 2"/></testcase>'
SKIPPED = ('<testcase name="{0}" status="run" result="skipped" classname="Suite"><skipped message="a.cpp:7&#x0A;SKIPPED: bunny.ply '
           'is in no folder of OCCLOD_MESHES&#x0A;"/></testcase>')
DISABLED = '<testcase name="{0}" status="notrun" result="suppressed" classname="Suite"/>'


class CountTests(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="occlod-count-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "Testing/gtest").mkdir(parents=True)
        self.entries = []

    def add_entry(self, name, status="run", output=""):
        skipped = '<skipped message="SKIP_RETURN_CODE=77"/>' if status == "notrun" else ""
        self.entries.append(f'<testcase name="{name}" status="{status}">{skipped}<system-out>{output}</system-out></testcase>')

    def add_gtest(self, name, *cases, status="run"):
        self.add_entry(name, status)
        cases = "".join(case.format(f"Test{at}") for at, case in enumerate(cases))
        (self.folder / f"Testing/gtest/{name}.xml").write_text(f"<testsuites><testsuite>{cases}</testsuite></testsuites>")

    def lines(self, *options):
        (self.folder / "junit.xml").write_text(f"<testsuite>{''.join(self.entries)}</testsuite>")
        return subprocess.run([sys.executable, "-B", SCRIPT, self.folder, self.folder / "junit.xml", *options],
                              capture_output=True, text=True, check=True).stdout.splitlines()

    def test_sums_programs(self):
        self.add_gtest("core", PASSED, PASSED, PASSED, DISABLED)
        self.add_gtest("io", PASSED, FAILED, PASSED, status="fail")
        self.assertEqual(self.lines(), ["5 passed, 1 failed"])

    def test_tells_what_was_skipped(self):
        self.add_gtest("io", PASSED, SKIPPED, SKIPPED)
        self.assertEqual(self.lines(), [
            "SKIPPED: 2 tests (Suite.Test1, Suite.Test2): bunny.ply is in no folder of OCCLOD_MESHES", "1 passed, 0 failed, 2 skipped"])

    def test_a_crash_is_one_failure(self):
        """Without results, and with results of tests that all passed before the end."""
        self.add_entry("crashed", status="fail")
        self.add_gtest("leaks", PASSED, PASSED, status="fail")
        self.assertEqual(self.lines(), ["2 passed, 2 failed"])

    def test_unittest(self):
        output = "test_a (gl.Test) ... ok\ntest_b (gl.Test) ... skipped 'no OpenGL context'\n\nRan 7 tests in 1.2s\n\n"
        self.add_entry("tool.Gl", output=output + "OK (skipped=1)\n")
        self.add_entry("tool.Bad", "fail", output="Ran 4 tests in 0.1s\n\nFAILED (failures=2, errors=1)\n")
        self.assertEqual(self.lines(), ["SKIPPED: 1 test (tool.Gl): no OpenGL context", "7 passed, 3 failed, 1 skipped"])

    def test_programs_that_say_nothing(self):
        self.add_entry("consumer")
        self.add_entry("viewer_window.Golden", "notrun", "SKIPPED: Xvfb is not installed\n")
        self.assertEqual(self.lines(), ["SKIPPED: 1 test (viewer_window.Golden): Xvfb is not installed", "1 passed, 0 failed, 1 skipped"])

    def test_what_is_checked_beside_tests(self):
        self.add_entry("consumer")
        self.assertEqual(self.lines("--failed", "1", "--skipped", "lint: SKIPPED formatting (no clang-format 14)"), [
            "lint: SKIPPED formatting (no clang-format 14)", "1 passed, 1 failed, 1 skipped"])

    def test_no_run_is_a_failure(self):
        done = subprocess.run([sys.executable, "-B", SCRIPT, self.folder, self.folder / "none.xml"], capture_output=True, text=True, check=True)
        self.assertEqual(done.stdout.splitlines()[-1], "0 passed, 1 failed")


if __name__ == "__main__":
    unittest.main()
