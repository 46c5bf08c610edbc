#!/usr/bin/env python3
"""How links of the repository's Markdown become links of the site."""
import pathlib
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "docs" / "site"))
from copy_pages import place_in_site, with_links_of_the_site  # noqa: E402


class CopyPages(unittest.TestCase):
    def expect(self, text, source, expected):
        page = place_in_site(source)
        self.assertEqual(with_links_of_the_site(text, source, page, ROOT / "site"), expected)

    def test_pages_keep_their_place_below_docs(self):
        self.expect("[a](frames.md#limits)", "docs/guide/occlusion.md", "[a](frames.md#limits)")
        self.expect("![a](../images/a.png)", "docs/guide/occlusion.md", "![a](../images/a.png)")

    def test_headers_lead_to_the_reference(self):
        self.expect("[a](../../lib/include/occlod/refiner.h)", "docs/guide/frames.md", "[a](../reference/refiner.md)")

    def test_markdown_outside_of_docs_becomes_a_page(self):
        self.expect("[a](../../meshes/README.md)", "docs/guide/scenes.md", "[a](../meshes.md)")
        self.expect("[a](../docs/guide/scenes.md)", "meshes/README.md", "[a](guide/scenes.md)")

    def test_other_files_are_linked_where_they_are(self):
        self.expect("[a](../../examples/hello.cpp)", "docs/guide/quickstart.md", "[a](../../examples/hello.cpp)")
        self.expect("[a](../examples/hello.cpp)", "docs/index.md", "[a](../examples/hello.cpp)")
        self.expect("[a](compare.py)", "bench/results/README.md", "[a](../bench/results/compare.py)")

    def test_addresses_and_places_in_the_page_stay(self):
        self.expect("[a](https://b.c/d) [e](#f)", "docs/index.md", "[a](https://b.c/d) [e](#f)")


if __name__ == "__main__":
    unittest.main()
