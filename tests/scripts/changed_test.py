"""scripts/changed.sh: what differs from the main branch, committed or not."""
import pathlib
import shutil
import subprocess
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/changed.sh"


@unittest.skipUnless(shutil.which("git"), "SKIPPED: git is not installed")
class Changed(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="occlod-changed-")
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        (self.root / "scripts").mkdir()
        shutil.copy(SCRIPT, self.root / "scripts")
        self.git("init", "--quiet", "--initial-branch=main")
        for name in ("kept", "edited", "committed", "removed"):
            (self.root / name).write_text("old\n")
        self.commit()

    def git(self, *arguments):
        subprocess.run(["git", "-c", "user.name=t", "-c", "user.email=t@localhost", *arguments], cwd=self.root, check=True, capture_output=True)

    def commit(self):
        self.git("add", ".")
        self.git("commit", "--quiet", "-m", "a commit")

    def changed(self):
        return subprocess.run([self.root / "scripts/changed.sh"], capture_output=True, text=True, check=True).stdout.split()

    def test_on_a_branch(self):
        """The commits of the branch, edits, new files; neither what main has got since nor what was removed."""
        self.git("switch", "--quiet", "-c", "work")
        (self.root / "committed").write_text("new\n")
        self.commit()
        self.git("switch", "--quiet", "main")
        (self.root / "by_others").write_text("new\n")
        self.commit()
        self.git("switch", "--quiet", "work")
        (self.root / "edited").write_text("new\n")
        (self.root / "added").write_text("new\n")
        (self.root / "removed").unlink()
        self.assertEqual(self.changed(), ["added", "committed", "edited"])

    def test_on_main(self):
        self.assertEqual(self.changed(), [])
        (self.root / "edited").write_text("new\n")
        self.assertEqual(self.changed(), ["edited"])


if __name__ == "__main__":
    unittest.main()
