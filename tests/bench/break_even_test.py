"""bench/report/break_even.py: from which cost of a triangle on occlusion pays."""
import math
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "bench" / "report"))
import break_even


def point(series, budget, triangles, ms, error):
    return {"series": series, "budget": budget, "triangles": triangles, "ms": ms, "error": error, "draw_ms": 5.0}


class BreakEven(unittest.TestCase):
    def test_between_two_budgets_by_logarithms(self):
        points = [point("", 1, 1_000, 1.0, 4.0), point("", 2, 4_000, 4.0, 1.0)]
        triangles, ms = break_even.at_error(points, "error", 2.0)
        self.assertAlmostEqual(triangles, 2_000)
        self.assertAlmostEqual(ms, 2.0)
        self.assertEqual(break_even.at_error(points, "error", 8.0), (1_000, 1.0))
        self.assertIsNone(break_even.at_error(points, "error", 0.5))

    def test_what_a_triangle_must_cost(self):
        self.assertAlmostEqual(break_even.ns_a_triangle((10_000, 3.0), (20_000, 1.0)), 200.0)  # 2 ms for 10,000 triangles
        self.assertEqual(break_even.ns_a_triangle((10_000, 1.0), (20_000, 1.0)), 0.0)
        self.assertEqual(break_even.ns_a_triangle((10_000, 1.0), None), 0.0)
        self.assertEqual(break_even.ns_a_triangle((10_000, 3.0), (9_000, 1.0)), math.inf)
        self.assertEqual(break_even.ns_a_triangle((10_000, 1.0), (9_000, 1.0)), math.inf)

    def test_rows(self):
        points = [point(break_even.WITH, 10_000, 10_000, 3.0, 1.0), point(break_even.WITHOUT, 10_000, 10_000, 1.0, 2.0),
                  point(break_even.WITHOUT, 40_000, 40_000, 4.0, 0.5)]
        row, = break_even.rows(lambda scene: points, ["hall"], "error", 10_000)
        self.assertEqual(row, ["hall", "3.00", "10,000", "2.00", "20,000", "from 100 ns a triangle on", "500"])
        self.assertEqual([break_even.verdict(x) for x in (0.0, math.inf)], ["always", "never"])


if __name__ == "__main__":
    unittest.main()
