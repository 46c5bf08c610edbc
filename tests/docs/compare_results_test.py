#!/usr/bin/env python3
"""bench/results/compare.py, and that every table there has rows that its keys tell apart."""
import csv
import pathlib
import sys
import unittest

RESULTS = pathlib.Path(__file__).resolve().parents[2] / "bench" / "results"
sys.path.insert(0, str(RESULTS))
from compare import change, compare, read_table  # noqa: E402


class CompareResults(unittest.TestCase):
    def test_change_is_told_beyond_the_percentage(self):
        self.assertIsNone(change("10", "11", 10))  # Exactly 10 %.
        self.assertEqual(change("10", "12", 10), "10 -> 12 (+20 %)")
        self.assertEqual(change("10", "8", 10), "10 -> 8 (-20 %)")
        self.assertEqual(change("0", "1", 10), "0 -> 1")  # No percentage of nothing.
        self.assertEqual(change("a1", "b2", 10), "a1 -> b2")
        self.assertEqual(change("", "3", 10), "- -> 3")

    def test_rows_are_matched_by_their_keys(self):
        old = {("city", "star"): {"ms": "10"}, ("city", "subtree"): {"ms": "5"}}
        new = {("city", "star"): {"ms": "20"}, ("sponza", "star"): {"ms": "1"}}
        self.assertEqual(sorted(compare(old, new, 10)), ["city star: ms 10 -> 20 (+100 %)", "city subtree: only in the old table",
                                                        "sponza star: only in the new table"])

    def test_keys_tell_the_rows_of_every_table_apart(self):
        for path in sorted(RESULTS.glob("*/*.csv")):
            with self.subTest(table=path.name), open(path, newline="", encoding="utf-8") as file:
                self.assertEqual(len(read_table(path)), len(list(csv.reader(file))) - 1)


if __name__ == "__main__":
    unittest.main()
