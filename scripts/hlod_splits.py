"""Where an HLOD is the faster way to the same error than refinement by splits: what `occlod render --explain --json` has found along paths."""
# Scenes, their paths and the triangles that splits are given.
SCENES = {"armadillo": ("orbit", 10_000), "armadillo_group": ("orbit", 10_000), "planet_near": ("low_flight", 10_000), "city": ("walk", 10_000),
          "sponza": ("walk", 10_000), "ww2_city": ("orbit", 10_000), "hlod_5m": ("walk", 100_000), "hlod_12m": ("walk", 100_000)}
TITLES = ["scene", "error, px", "", "triangles", "ms", "queries", "pays below, ns a triangle", "splits drawn on the CPU, ns a triangle"]


def shown(bound):
    return "-" if bound is None else "any" if bound == "infinite" else f"{bound:,.0f}"


def where(way):
    """An HLOD that draws fewer triangles, but takes longer, pays above a bound."""
    if "queries" not in way:
        return ""
    if way["pays_below_ns"] == 0 and way["pays_above_ns"] != "infinite":
        return f"above {shown(way['pays_above_ns'])}"
    return "never" if way["pays_below_ns"] == 0 else shown(way["pays_below_ns"])


def rows_of(scene, report):
    splits = report["splits_or_hlod"][0]
    for way in report["splits_or_hlod"]:
        is_first = way is splits
        yield [scene if is_first else "", f"{way['depth_rms_px']:.3f}", way["way"], f"{way['triangles']:,.0f}", f"{way['ms']:.3f}",
               "" if is_first else f"{way['queries']:,.0f}", where(way), f"{1e6 * way['draw_ms'] / way['triangles']:,.0f}" if is_first else ""]


def print_splits(document, results):
    found = results.load_all("splits", SCENES)
    if not found:
        return
    document.heading("Splits or an HLOD?")
    document.text("Frame to frame along a path, `--occlusion auto`, beside HLODs whose tolerance leaves no larger root mean square error of depth (three frames of each path). "
                  "Milliseconds are those of one core to find out what to draw; drawing, and an HLOD's queries, are the device's. An HLOD draws more triangles in less time, so "
                  "it pays where a triangle costs a renderer less than the bound, shading included.")
    document.table(TITLES, [row for scene, report in found.items() for row in rows_of(scene, report)])


def add_splits(goals, results):
    """Goal 11: in the largest scene, against splits at equal error."""
    report = results.load("splits_hlod_12m")
    if not report:
        return
    splits, *hlods = report["splits_or_hlod"]
    for way in hlods:
        if way["pays_below_ns"] is None:
            continue
        goals.add(11, f"{way['way']} over splits at equal error, ms: hlod_12m", "<= 0.2", f"{way['ms'] / splits['ms']:.4f}", way["ms"] <= splits["ms"] / 5)
        goals.add(11, f"{way['way']} over splits at equal error, triangles: hlod_12m", "<= 1.6", f"{way['triangles'] / splits['triangles']:.2f}",
                  way["triangles"] <= 1.6 * splits["triangles"])
