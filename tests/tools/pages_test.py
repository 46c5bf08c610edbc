"""The manual page and the completions that `occlod pages` writes for an installation."""
import re
import shutil
import subprocess
import unittest

from tool_case import ToolTest


class Pages(ToolTest):
    def setUp(self):
        super().setUp()
        self.succeed("pages", "usr")
        self.share = self.folder / "usr/share"

    def completed(self, *words):
        """By bash: what may stand in place of the last word."""
        script = f"source {self.share}/bash-completion/completions/occlod; COMP_WORDS=(\"$@\"); COMP_CWORD=$(($# - 1)); _occlod; printf '%s\\n' \"${{COMPREPLY[@]}}\""
        done = subprocess.run(["bash", "-uc", script, "bash", "occlod", *words], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done.stdout.split()

    def test_bash_completes(self):
        self.assertEqual(self.completed("re"), ["render", "repair"])
        self.assertEqual(self.completed("hlod", "v"), ["validate"])
        self.assertEqual(self.completed("hlod", "build", "a.ply", "--gr"), ["--grouping"])
        self.assertEqual(self.completed("--json", "hlod", "build", "a.ply", "--th"), ["--threads"])
        self.assertEqual(self.completed("build", "--compress", ""), ["none", "zstd"])
        self.assertEqual(self.completed("tiles", "--compress", ""), ["none", "meshopt"])
        for words in (["build", "-o", ""], ["build", "--output", ""], ["build", "a"], ["render", "--texture", "x"]):
            self.assertEqual(self.completed(*words), [], "files")

    def test_other_shells_take_theirs(self):
        for shell, file in (("zsh", "zsh/site-functions/_occlod"), ("fish", "fish/vendor_completions.d/occlod.fish")):
            if shutil.which(shell):
                done = subprocess.run([shell, "-n", self.share / file], capture_output=True, text=True)
                self.assertEqual((done.returncode, done.stderr), (0, ""))
        if shutil.which("fish"):
            def completed(line):
                script = f"source {self.share}/fish/vendor_completions.d/occlod.fish; complete -C '{line}'"
                return {row.split("\t")[0] for row in subprocess.run(["fish", "-c", script], cwd=self.folder, capture_output=True, text=True, check=True).stdout.splitlines()}
            self.assertEqual(completed("occlod hlod v"), {"validate"})
            self.assertEqual(completed("occlod build --compress "), {"none", "zstd"})
            self.assertEqual(completed("occlod hlod build --gr"), {"--grouping"})
            self.assertIn("--threads", completed("occlod tiles a.ply --"))

    def test_manual_has_all_help(self):
        """Line by line, and no line is a command of troff that is not meant."""
        text = (self.share / "man/man1/occlod.1").read_text()
        self.assertEqual(set(re.findall(r"^\.(\S+)", text, re.M)), {"TH", "SH", "nf", "fi"})
        plain = text.replace("\\-", "-").replace("\\&", "").replace("\\\\", "\\")
        for command in ([], ["build"], ["hlod"], ["hlod", "build"], ["cells", "walk"], ["tiles"], ["generate"]):
            for line in self.succeed(*command, "--help").splitlines():
                self.assertIn(line, plain.splitlines())
        self.assertNotIn("occlod pages", plain)

    def test_hidden_and_refused(self):
        self.assertNotIn("pages", self.succeed("--help"))
        (self.folder / "file").write_text("x")
        self.assertIn("cannot be written; check the folder", self.failure_of("pages", "file"))


if __name__ == "__main__":
    unittest.main(verbosity=1)
