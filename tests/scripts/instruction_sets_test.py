"""Sources that Highway compiles once for every instruction set keep their names to themselves. Without optimisation
HWY_INLINE is plain `inline`: of two functions of one name and one signature the linker would take one for both sources,
though their types of one name differ."""
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PART = re.compile(r"^namespace (\S+::HWY_NAMESPACE) \{\n(.*?)^\}  // namespace \1\nHWY_AFTER_NAMESPACE", re.M | re.S)


class InstructionSets(unittest.TestCase):
    def test_what_is_compiled_for_each_lies_in_an_unnamed_namespace(self):
        sources = [path for path in (ROOT / "lib").rglob("*.cpp") if "hwy/foreach_target.h" in path.read_text()]
        self.assertTrue(sources)
        for source in sources:
            with self.subTest(str(source.relative_to(ROOT))):
                parts = PART.findall(source.read_text())
                self.assertEqual(len(parts), 1)
                body = parts[0][1]
                self.assertTrue(body.startswith("namespace {\n"), "names that other sources see")
                self.assertTrue(body.endswith("}  // namespace\n"), "names that other sources see")
                self.assertEqual(len(re.findall(r"^\}  // namespace$", body, re.M)), 1, "closed before the end")


if __name__ == "__main__":
    unittest.main()
