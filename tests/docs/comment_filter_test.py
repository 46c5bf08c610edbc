#!/usr/bin/env python3
"""What Doxygen is told of the headers' plain comments."""
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "docs" / "site"))
from comment_filter import filtered  # noqa: E402


class CommentFilter(unittest.TestCase):
    def expect(self, source, expected):
        self.assertEqual(filtered("#pragma once\n" + source), "#pragma once\n" + expected)

    def test_top_of_the_file_describes_the_file(self):
        self.assertEqual(filtered("// Two\n// lines.\n#pragma once\n"), "/// \\file\n/// Two\n/// lines.\n#pragma once\n")

    def test_comment_above_a_declaration_describes_it(self):
        self.expect("// What it does.\n//\n// More.\nvoid f();", "/// What it does.\n///\n/// More.\nvoid f();")

    def test_comment_behind_a_declaration_describes_it_with_its_continuation(self):
        self.expect("  int a = 0;  // units\n              // and more\n  int b = 0;  // others",
                    "  int a = 0;  ///< units\n              ///< and more\n  int b = 0;  ///< others")

    def test_comment_above_the_next_member_is_no_continuation(self):
        self.expect("  int a = 0;  // units\n  // Of b.\n  int b = 0;", "  int a = 0;  ///< units\n  /// Of b.\n  int b = 0;")

    def test_comment_above_one_that_has_its_own_is_a_heading(self):
        self.expect("// Sizes.\nint a = 0;  // pixels\nint b = 0;  // others",
                    "// Sizes.\nint a = 0;  ///< pixels\nint b = 0;  ///< others")
        self.expect("// Of a.\nint a = 0;  // NOLINT(name)", "/// Of a.\nint a = 0;  // NOLINT(name)")

    def test_enumerators(self):
        self.expect("  one,  // first\n  two   // last", "  one,  ///< first\n  two   ///< last")

    def test_comments_that_describe_no_declaration_stay(self):
        for source in ("// A heading.\n\nint a;", "}  // namespace occlod", "#endif  // OCCLOD_X", "// Before a brace.\n}",
                       "int a = 0;  // NOLINT(name)", "namespace a {  // inner"):
            self.expect(source, source)

    def test_slashes_in_literals_are_no_comment(self):
        self.expect('const char* a = "http://b";', 'const char* a = "http://b";')
        self.expect("char a = '\"';  // a quote", "char a = '\"';  ///< a quote")

    def test_what_doxygen_would_interpret_is_escaped(self):
        self.expect("// a < b && #c \\d @e 5%\nint a;", "/// a &lt; b &amp;&amp; \\#c \\\\d \\@e 5\\%\nint a;")
        self.expect("// * (b)\nint a;", "/// &lowast; (b)\nint a;")

    def test_backticks_are_code(self):
        self.expect("// In `x<1>` only.\nint a;", "/// In <code>x&lt;1&gt;</code> only.\nint a;")


if __name__ == "__main__":
    unittest.main()
