"""scripts/tidy.py: which sources are read together, which again, and by which source a header is read."""
import json
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
import tidy  # noqa: E402


class Tidy(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="occlod-tidy-")
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name).resolve()
        self.addCleanup(setattr, tidy, "ROOT", tidy.ROOT)
        tidy.ROOT = self.root
        (self.root / ".clang-tidy").write_text("Checks: -*\n")
        self.commands = []

    def add(self, name, text, flags=""):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        if name.endswith(".cpp"):
            self.commands.append({"directory": str(self.root), "file": str(path), "command": f"c++ -std=c++20 -I{self.root}/lib {flags} -c {path}"})

    def sources(self):
        build = self.root / "build"
        build.mkdir(exist_ok=True)
        (build / "compile_commands.json").write_text(json.dumps(self.commands))
        return tidy.compiled_sources(build)

    def batches(self):
        return sorted(sorted(source.name for source in batch) for batch in tidy.batches_of(self.sources()))

    def test_reads_what_shares_no_name_together(self):
        self.add("lib/a.cpp", "namespace occlod {\nnamespace {\nint half(int value) { return value / 2; }\n}\n}\n")
        self.add("lib/b.cpp", "namespace occlod {\nstruct Wave {\n};\nvoid Other::half() {}\n}\n")
        self.add("lib/c.cpp", "static constexpr int wave = 3;\n")
        self.assertEqual(self.batches(), [["lib/a.cpp", "lib/b.cpp", "lib/c.cpp"]])

    def test_reads_what_shares_a_name_apart(self):
        """A function, a type, a constant, a macro and a test: each first in a.cpp, then in a source of its own."""
        texts = ["float half(float value) {\n}\n", "struct Wave {\n};\n", "constexpr std::size_t block = 3;\n", "#define WIDE 1\n", "TEST(Suite, Name) {\n}\n"]
        self.add("lib/a.cpp", "".join(texts))
        for at, text in enumerate(texts):
            self.add(f"lib/b{at}.cpp", text)
        self.assertEqual(self.batches(), [["lib/a.cpp"], [f"lib/b{at}.cpp" for at in range(len(texts))]])

    def test_reads_folders_and_vector_code_apart(self):
        self.add("lib/a.cpp", "")
        self.add("lib/b.cpp", '#include "hwy/foreach_target.h"\n')
        self.add("tests/a.cpp", "")
        self.assertEqual(self.batches(), [["lib/a.cpp"], ["lib/b.cpp"], ["tests/a.cpp"]])

    def fingerprint(self):
        return tidy.Fingerprints(sys.executable).of(self.sources()[0])[0]

    def test_reads_again_what_differs(self):
        self.add("lib/far.h", "int far();\n")
        self.add("lib/near.h", '#include "far.h"\n')
        self.add("lib/a.cpp", '#include "near.h"\n')
        self.add("lib/other.h", "")
        seen = {self.fingerprint()}
        self.add("lib/other.h", "int other();\n")
        self.assertEqual({self.fingerprint()}, seen)
        for name, text in [("lib/a.cpp", '#include "near.h"\nint a;\n'), ("lib/far.h", "int far(int);\n"), (".clang-tidy", "Checks: '*'\n")]:
            (self.root / name).write_text(text)
            seen.add(self.fingerprint())
        self.commands[0]["command"] += " -DMORE"
        seen.add(self.fingerprint())
        self.assertEqual(len(seen), 5)

    def test_reads_a_header_by_a_source(self):
        """By the one beside it; else by the one of fewest files; by none where a chosen source includes it anyway."""
        self.add("lib/cut.h", "")
        self.add("lib/ids.h", "")
        self.add("lib/cut.cpp", '#include "cut.h"\n#include "ids.h"\n')
        self.add("lib/more.cpp", '#include "cut.h"\n')
        self.add("lib/short.cpp", '#include "ids.h"\n')

        def read(*names):
            chosen = tidy.those_that_read({str(self.root / name) for name in names}, self.sources(), tidy.Fingerprints(sys.executable))
            return [source.name for source in chosen]

        self.assertEqual(read("lib/cut.h"), ["lib/cut.cpp"])
        self.assertEqual(read("lib/ids.h"), ["lib/short.cpp"])
        self.assertEqual(read("lib/more.cpp", "lib/cut.h"), ["lib/more.cpp"])


if __name__ == "__main__":
    unittest.main()
