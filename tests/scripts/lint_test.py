"""scripts/lint.sh where its tools are missing: it says what it has not checked, and calls nothing clean."""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
# All that the script runs beside the tools of clang.
NEEDED = ["bash", "dirname", "env", "find", "grep", "mktemp", "nproc", "rm", "sort", "xargs"]


class LintWithoutTools(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="occlod-lint-")
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)
        for name in NEEDED:
            (self.path / name).symlink_to(shutil.which(name))
        (self.path / "python3").symlink_to(sys.executable)  # the one on the path may be a script that looks for it there

    def add_tool(self, name, version):
        tool = self.path / name
        tool.write_text(f"#!/bin/bash\necho 'Debian {name} version {version}'\n")
        tool.chmod(0o755)

    def lint(self):
        return subprocess.run([ROOT / "scripts/lint.sh", self.path / "build"], env={"PATH": str(self.path)},
                              capture_output=True, text=True, check=False)

    def assert_all_skipped(self, done):
        self.assertEqual(done.returncode, 77, done.stderr)
        self.assertEqual(done.stdout, "lint: SKIPPED formatting (no clang-format 14), clang-tidy's checks (no clang-tidy 14)\n")
        self.assertNotIn("clean", done.stdout + done.stderr)

    def test_without_any(self):
        self.assert_all_skipped(self.lint())

    def test_of_another_version(self):
        self.add_tool("clang-format", "15.0.6")
        self.add_tool("clang-tidy", "15.0.6")
        self.assert_all_skipped(self.lint())

    def test_without_one(self):
        """This clang-format finds nothing; sources have still not been checked."""
        self.add_tool("clang-format-14", "14.0.6")
        done = self.lint()
        self.assertEqual(done.returncode, 77, done.stderr)
        self.assertEqual(done.stdout.splitlines()[-1], "lint: SKIPPED clang-tidy's checks (no clang-tidy 14)")

    def test_findings_count_more_than_what_is_skipped(self):
        """A clang-format that only knows its version and refuses the rest, as the real one does with a badly formatted file."""
        tool = self.path / "clang-format-14"
        tool.write_text("#!/bin/bash\n[ \"$1\" = --version ] && echo 'clang-format version 14.0.6'\n")
        tool.chmod(0o755)
        done = self.lint()
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stdout.splitlines()[-1], "lint: failed")


if __name__ == "__main__":
    unittest.main()
