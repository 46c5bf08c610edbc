#!/usr/bin/env python3
"""figures.py [FOLDER]: makes the plots of docs/images anew, or into FOLDER, from the tables of bench/results."""
import csv
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "bench/report"))
import hlod_page  # noqa: E402
import page  # noqa: E402

SETTINGS = "2026-11-27/report_settings.csv"  # of scripts/report.sh
SCENES = ("armadillo_group", "planet_near", "sponza", "city")
ABOVE = "2026-11-27/hlod_above.csv"  # of figure8_city.csv of scripts/hlod_tables.sh --only table4
KNOB_BUDGET, NEAR_BEST, TIME_NOISE = 10_000, 1.1, 1.25  # of bench_report
NOT_OFFERED = ("raster", "textures")  # knobs that the command line does not have


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs/images"
    figures = {"report.svg": page.Report(report_data()).figure(), "hlod_above.svg": hlod_page.above(frames_above(), date_of(ABOVE))}
    for name, drawn in figures.items():
        (folder / name).write_text(drawn.svg(standalone=True) + "\n")
        print(folder / name)


def rows_of(table):
    with open(ROOT / "bench/results" / table, newline="") as file:
        return list(csv.DictReader(file))


def date_of(table):
    return table.partition("/")[0]


def frames_above():
    """By strategy, (frame, ms)."""
    lines = {name: [] for name in hlod_page.FIGURE_8.values()}
    for row in rows_of(ABOVE):
        lines[hlod_page.FIGURE_8[row["strategy"]]].append((int(row["frame"]), float(row["frame_ms"])))
    return lines


def report_data():
    """As much of a report.json as the main plot shows."""
    points = [point_of(row) for row in rows_of(SETTINGS)]
    measure = {"key": "error", "name": "visible error", "unit": "px"}
    settings = [{"name": p["setting"], "series": p["series"], "budget": p["budget"]} for p in points]
    return {"points": points, "settings": settings, "measures": [measure], "fronts": {"error": names(front(points))}, "choice": choice(points), "knob_budget": KNOB_BUDGET,
            "scenes": [{"name": name} for name in SCENES], "size": (1024, 768), "machine": {"date": date_of(SETTINGS)}}


def point_of(row):
    """Settings of a series are named by it, turned knobs by knob, value and budget."""
    budget = int(row["budget"])
    knob = row["setting"].endswith(f", {budget:,}")
    name = row["setting"] if knob else f"{row['setting']}, {budget:,}"
    return {"scene": "all", "setting": name, "series": "" if knob else row["setting"], "budget": budget, "triangles": float(row["triangles"]), "ms": float(row["total_ms"]),
            "error": float(row["visible_error_px"])}


def choice(points):
    """The rule of bench_report (docs/guide/report.md)."""
    offered = [p for p in points if p["series"] or p["setting"].split()[0] not in NOT_OFFERED]
    kept = [p for p in offered if p["budget"] <= KNOB_BUDGET]
    near = [p for p in kept if p["error"] <= NEAR_BEST * min(q["error"] for q in kept)]
    recommended = next(p for p in near if p["ms"] <= TIME_NOISE * min(q["ms"] for q in near))
    by_time = front(offered)
    return {"measure": "error", "near_best": NEAR_BEST, "time_noise": TIME_NOISE, "recommended": recommended["setting"], "fastest": by_time[0]["setting"],
            "most_accurate": by_time[-1]["setting"], "as_accurate": next(p["setting"] for p in by_time if p["error"] <= recommended["error"]), "budget_front": names(front(kept))}


def front(points):
    """Those that no other beats in both, from the fastest on."""
    found = []
    for p in sorted(points, key=lambda p: (p["ms"], p["error"])):
        if not found or p["error"] < found[-1]["error"]:
            found.append(p)
    return found


def names(points):
    return [p["setting"] for p in points]


if __name__ == "__main__":
    main()
