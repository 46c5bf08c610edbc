"""For which renderers occlusion pays: what a triangle must cost to draw, so that drawing fewer of them is worth the time that it takes to find out
which."""
import math

WITH, WITHOUT = "occlod, frame to frame", "occlod, frame to frame, no occlusion"


def at_error(points, key, error):
    """(triangles, ms) of a series of points at this error, between two of them by logarithms; None when the finest leaves more."""
    known = sorted((p for p in points if p[key] is not None and p[key] > 0), key=lambda p: p["triangles"])
    for i, p in enumerate(known):
        if p[key] > error:
            continue
        if i == 0:
            return p["triangles"], p["ms"]
        q = known[i - 1]
        part = math.log(q[key] / error) / math.log(q[key] / p[key])
        return tuple(math.exp(math.log(q[c]) + part * (math.log(p[c]) - math.log(q[c]))) for c in ("triangles", "ms"))
    return None


def ns_a_triangle(with_it, without):
    """From how many nanoseconds a triangle on occlusion pays, of (triangles, ms) at the same error: 0 always, infinity never."""
    if without is None:
        return 0.0
    saved, cost_ms = without[0] - with_it[0], with_it[1] - without[1]
    if cost_ms <= 0:
        return 0.0 if saved >= 0 else math.inf
    return 1e6 * cost_ms / saved if saved > 0 else math.inf


def verdict(ns):
    if ns == 0:
        return "always"
    return "never" if math.isinf(ns) else f"from {ns:,.0f} ns a triangle on"


HEADER = ["scene", "ms with occlusion", "triangles", "ms without, at the same error", "triangles", "occlusion pays", "drawing on the CPU, ns a triangle"]


def rows(points_of, scenes, key, budget):
    """One for each scene; `points_of`: its points."""
    for scene in scenes:
        points = points_of(scene)
        chosen = next((p for p in points if p["series"] == WITH and p["budget"] == budget), None)
        if chosen is None or not chosen[key]:
            continue
        with_it = chosen["triangles"], chosen["ms"]
        without = at_error([p for p in points if p["series"] == WITHOUT], key, chosen[key])
        drawing = f"{1e6 * chosen['draw_ms'] / chosen['triangles']:,.0f}"
        other = [f"{without[1]:.2f}", f"{without[0]:,.0f}"] if without else ["-", "not reached"]
        yield [scene, f"{with_it[1]:.2f}", f"{with_it[0]:,.0f}", *other, verdict(ns_a_triangle(with_it, without)), drawing]
