"""What scripts/cells_page.py shows: tables and plots of numbers, from the runs that scripts/cells_runs.py has left in a folder, with the figures of Chhugani and
others, vLOD (2003), beside ours. Everything that is shown is in here, as it was measured."""
import csv
import itertools
import json
import statistics
import sys

import cells_runs
import viewcells_table

sys.path.insert(0, str(cells_runs.ROOT / "bench"))
import cluster_model  # noqa: E402

# Table 1 there (R10000, 196 MHz), by columns: nearest neighbours s, seed tour s, times fewer runs after one iteration and after 500,000, s an iteration.
TABLE_1 = {500: (2, 0.7, 3.1, 6.28, 0.005), 1000: (10, 2.8, 3.26, 5.57, 0.008), 3000: (162, 31.1, 2.84, 4.56, 0.015), 9000: (2400, 584, 2.78, 4.25, 0.025),
           27000: (23393, 7447, 2.73, None, 0.05)}
WAYS = {"full_in_view": "full mesh in the frustum", "lod_in_view": "LOD in the frustum", "vlod": "vLOD", "vlod_in_view": "vLOD in the frustum", "update": "Refiner::update"}
TASKS_A_SECOND = 637  # by the scheduler of Dask, as measured: bench/results/2026-11-23/cells_cluster.csv
BINS = 10  # of Fig. 10, and one for all above
BY_SIZE = {"drawn_without_occlusion": "none", "cull_map_drawn": "cull map (2.5D)", "middle_drawn": "shrunk, from the middle", "best_drawn": "shrunk, from the best point",
           "hull_drawn": "hull", "sampled_drawn": "sampled"}
RAYS = ("hull 1 px", "hull 0.25 px", "gvs", "random rays", "objects by hull", "objects by gvs", "seen by the judges")


class Results:
    """What is missing is None."""

    def __init__(self, folder):
        self.folder = folder
        self.about = self.json("about.json")

    def json(self, name):
        file = self.folder / name
        return json.loads(file.read_text()) if file.exists() else None

    def tables(self, name):
        """The tables of a file of CSV, which empty lines part."""
        file = self.folder / name
        parts = file.read_text().strip().split("\n\n") if file.exists() else []
        return [[numbers(row) for row in csv.DictReader(part.splitlines())] for part in parts]

    def table(self, name, *columns):
        """The one with these columns; empty if there is none."""
        return next((rows for rows in self.tables(name) if rows and set(columns) <= set(rows[0])), [])

    @property
    def scenes(self):
        return self.about["scenes"]

    def cost(self, scene, mode, tolerance):
        name = f"{scene}_cost_{mode}_{tolerance:g}"
        build, check = self.json(f"{name}_build.json"), self.json(f"{name}_check.json")
        return build and check and {**build, "pixels": check["pixels"], "unexplained": check["unexplained"]}

    def walks(self, scene, part):
        return self.json(f"{scene}_{part}_walks.json")


def numbers(row):
    return {key: number(value) for key, value in row.items()}


def number(text):
    if not text:
        return None
    try:
        return float(text) if not text.isdecimal() else int(text)
    except ValueError:
        return text


def ratio(a, b):
    return a / b if a is not None and b else None


class Table:
    """`digits`: behind the point, of each column; None: text. `row_digits`: instead, of each row, of all but its first two columns."""

    def __init__(self, name, titles, digits, rows, row_digits=None):
        self.told = {"table": name, "titles": titles, "digits": digits, "row_digits": row_digits, "rows": [list(row) for row in rows]}


class Plot:
    """`lines`: by name, [x, y]. `log`: the axis of y is logarithmic."""

    def __init__(self, name, caption, x, y, lines, dots=True, log=False):
        self.told = {"plot": name, "caption": caption, "x": x, "y": y, "lines": {name: line for name, line in lines.items() if line}, "dots": dots, "log": log}


def part(name, title, *items):
    """Texts, tables and plots. Tables without rows and plots without lines are left out."""
    told = [{"text": item} if isinstance(item, str) else item.told for item in items]
    return {"part": name, "title": title, "items": [item for item in told if item.get("rows", True) and item.get("lines", True)]}


def all_parts(results):
    return [make(results) for make in (goals, models, table_1, balls, deltas, frames, codes, shrunk, cells, costs, by_size, rays, cluster, elsewhere, hashes)]


# --- parts


def goals(results):
    rows = []
    for scene in results.scenes:
        measured = results.json(f"{scene}_viewcells.json")
        if measured:
            rows += [(goal, f"{scene}: {what}", figure, asked, verdict(met)) for goal, what, figure, asked, met in viewcells_table.rows(measured)]
        told = [results.cost(scene, "hull", tolerance) for tolerance in cells_runs.TOLERANCES]
        if all(told):
            count = sum(cost["unexplained"] for cost in told)
            rows.append(("1", f"{scene}: unexplained pixels of {sum(cost['pixels'] for cost in told):,}, mode hull", f"{count}", "0", verdict(count == 0)))
    for edge, most in ((4, 0.8), (16, 0.35)):
        values = [row["hull_over_best"] for row in results.table("shrunk.csv", "hull_over_best") if row["cell_edge"] == edge]
        if values:
            rows.append(("3", f"triangles drawn, hull over shrunk occluders, {edge} m, most", f"{max(values):.3f}", f"<= {most}", verdict(max(values) <= most)))
    for row in results.table("order.csv", "goal"):
        sign, bound = row["asked"].split()
        rows.append((str(row["goal"]), row["measure"], f"{row['is']:g}", row["asked"], verdict(row["is"] <= float(bound) if sign == "<=" else row["is"] >= float(bound))))
    compared = [(ours["cpu_ms"], theirs["cpu_ms"], ours["missed_pixels"]) for ours, theirs in against_rays(results) if theirs["cpu_ms"] is not None]
    if compared:
        slowest, missed = max(ours / theirs for ours, theirs, _ in compared), sum(count for *_, count in compared)
        rows.append(("15", "time over that of gvs to 0.01 % missed, most; pixels that ours misses", f"{slowest:.2f}; {missed}", "<= 0.2; 0", verdict(slowest <= 0.2 and missed == 0)))
    order = sorted(rows, key=lambda row: int(row[0]) if row[0].isdecimal() else 99)
    return part("goals", "What is asked for", "Goal, what was measured, what is asked. 8 to 10 and 15 are of a city of their own, all others of the scene that is named.",
                Table("goals", ["goal", "what", "measured", "asked", "verdict"], [None] * 5, order))


def verdict(met):
    return "met" if met else "**missed**"


def models(results):
    rows = [["paper: power plant", 13_000_000, None, None, "Onyx2 InfiniteReality"], ["paper: city", 52_400_000, None, None, "the same; 2.8 GHz PC with a GeForce 4; 16 PCs"]]
    for scene in results.scenes:
        walked = results.walks(scene, "t")
        measured = results.json(f"{scene}_viewcells.json")
        if walked and measured:
            rows.append([f"ours: {scene}", walked["triangles"], measured["hierarchy_bytes"], measured["cells"], results.about["machine"] + ", no GPU"])
    return part("models", "Models and machines", "The paper's models are not available: compare ratios, not counts.",
                Table("models", ["model", "triangles", "bytes of its hierarchies", "cells", "machine"], [None, 0, 0, 0, None], rows))


def table_1(results):
    rows = []
    for row in results.table("order.csv", "knn_s"):
        knn, seed, first, last, iteration = TABLE_1.get(row["columns"], (None,) * 5)
        rows.append([row["columns"], knn, row["knn_s"], seed, row["seed_s"], first, row["fewer_runs_seed"], last, row["fewer_runs_tour"], iteration, row["s_a_move"],
                     row["fewer_runs_sort"], row["sort_s"]])
    lines = {"tour": [[row["columns"], row["fewer_runs_tour"]] for row in results.table("order.csv", "knn_s")],
             "sort": [[row["columns"], row["fewer_runs_sort"]] for row in results.table("order.csv", "knn_s")],
             "paper, after 500,000 iterations": [[columns, told[3]] for columns, told in TABLE_1.items() if told[3] and columns in [row["columns"] for row in results.table("order.csv", "knn_s")]]}
    return part("table1", "Table 1: the order of splits by a tour in the Hamming metric",
                "Columns of a matrix whose rows are the lists of crossings. Fewer runs: times, against splits as they are numbered. The paper's times are of an R10000 of 196 MHz; "
                "what an iteration is it does not say, so our tour stands beside both of its states. The sort is ours.",
                Table("table1", ["columns", "nearest, s: paper", "ours", "seed tour, s: paper", "ours", "fewer runs: paper, first iteration", "ours, seed", "paper, 500,000", "ours, end",
                                 "s an iteration: paper", "ours, a move", "fewer runs by the sort", "its s"], [0, 1, 3, 1, 3, 2, 2, 2, 2, 3, 6, 2, 6], rows),
                Plot("fewer_runs", "times fewer runs than as splits are numbered", "columns", "times fewer runs", lines))


def balls(results):
    rows = results.table("order.csv", "share_mean_pct")
    by_factor = {f"{columns:,} columns": [[row["within"], row["share_mean_pct"]] for row in rows if row["columns"] == columns] for columns in dict.fromkeys(row["columns"] for row in rows)}
    by_columns = {f"within {factor:g} times": [[row["columns"], row["share_mean_pct"]] for row in rows if row["within"] == factor] for factor in (1.5, 2, 3)}
    return part("fig4", "Fig. 4: how many columns are near to one",
                "The paper samples candidates for the tour because balls of twice the distance to the nearest column hold about the same share of all columns, however many there are. "
                "The same two curves of ours: the mean over up to 500 columns, the distance to the nearest column that is not equal.",
                Plot("balls_by_factor", "share of all columns within so many times the distance of the nearest one", "times the distance of the nearest", "% of columns", by_factor),
                Plot("balls_by_columns", "the same against the number of columns: about constant where the paper's assumption holds", "columns", "% of columns", by_columns),
                Table("fig4", ["columns", "within", "looked from", "equal to another, %", "mean share, %", "least share, %"], [0, 2, 0, 1, 3, 3],
                      ([row[key] for key in ("columns", "within", "centres", "equal_pct", "share_mean_pct", "share_least_pct")] for row in rows)))


def delta_ratios(walked):
    return [(crossing["added"] + crossing["removed"]) / crossing["drawn"] for path in walked["paths"].values() for crossing in path["crossings"]]


def deltas(results):
    rows, lines = [], {}
    for scene, (which, shown) in itertools.product(results.scenes, (("t", "T"), ("t4", "T/4"))):
        walked = results.walks(scene, which)
        if not walked:
            continue
        ratios = delta_ratios(walked)
        counts = [sum(1 for value in ratios if min(int(BINS * value), BINS) == bin) for bin in range(BINS + 1)]
        if ratios:
            lines[f"{scene}, {shown}"] = [[(bin + 0.5) / BINS, 100 * count / len(ratios)] for bin, count in enumerate(counts)]
        rows.append([scene, shown, walked["max_triangles"], walked["cells"], len(ratios), statistics.median(ratios) if ratios else None, max(ratios, default=None),
                     100 * ratio(sum(value > 0.5 for value in ratios), len(ratios)) if ratios else None])
    return part("fig10", "Fig. 10: how much changes from cell to cell",
                "Triangles that come and triangles that go when a path of the scene crosses into another cell, over what is drawn there. T is what half of the undivided cells draw; cells above it are divided where a part draws less than half, as in the paper. "
                "In the paper more than half changes in less than 10 % of the cases.",
                Plot("delta_histogram", "share of crossings by delta over vLOD; the last point is all above 1", "delta / vLOD", "% of crossings", lines),
                Table("fig10", ["scene", "cells of", "T, triangles", "cells", "crossings", "median", "most", "above 1/2, %: paper < 10"], [None, None, 0, 0, 0, 3, 3, 1], rows))


def frames(results):
    items, rows = [], []
    for scene in results.scenes:
        walked = results.walks(scene, "t")
        for name, path in walked["paths"].items() if walked else ():
            told = path["frame"]
            items.append(Plot(f"frames_{scene}_{name}", f"{scene}, {name}: triangles of frames", "frame", "triangles",
                              {shown: [[frame["frame"], frame[key]] for frame in told] for key, shown in WAYS.items()}, dots=False, log=True))
            medians = {key: statistics.median(frame[key] for frame in told) for key in WAYS}
            rows.append([scene, name, len(told), *medians.values(), ratio(medians["vlod_in_view"], medians["full_in_view"]), ratio(medians["vlod_in_view"], medians["lod_in_view"]),
                         ratio(medians["vlod_in_view"], medians["update"])])
    return part("fig11", "Fig. 11: triangles a frame",
                "Along the paths, by what is drawn: all of the mesh in the frustum; the cell's level of detail without occlusion in the frustum; the cell's vLOD, all and in the frustum; "
                "and what Refiner::update() chooses for the frame at the same tolerance. A triangle is in the frustum unless it is wholly beyond one of its sides. Medians in the table; "
                "the paper gives no numbers.", *items,
                Table("fig11", ["scene", "path", "frames", *WAYS.values(), "vLOD / full, in the frustum", "vLOD / LOD", "vLOD / update"], [None, None, 0, 0, 0, 0, 0, 0, 4, 3, 3], rows))


def codes(results):
    keys = ("bit_vector", "int32", "delimiter", "delimiter_runs", "adaptive_huffman_runs", "zstd_runs", "ours")
    rows = [[row["order"], row["lists"], row["ids"], row["runs"], *(row.get(key) for key in keys)] for row in results.table("order.csv", "adaptive_huffman_runs")]
    read = [[row[key] for key in ("crossings", "bytes_a_crossing_deltas", "bytes_a_crossing_tree", "ratio", "stored_deltas", "stored_tree")]
            for row in results.table("order.csv", "bytes_a_crossing_tree")]
    return part("codes", "2.4: codes of lists of ids", "Bits an id. In the paper plain integers are 25 times smaller than bit vectors, gaps and runs half of that, and half of LZW of the same runs. "
                "zstd packs all lists together, at its best level; all others pack each list by itself, ours in whole bytes.",
                Table("codes", ["lists", "count", "ids", "runs", "bit vector", "int32", "delimiter code of gaps", "of runs", "adaptive Huffman of runs", "zstd of runs", "ours of runs"],
                      [None, 0, 0, 0, 0, 1, 2, 2, 2, 2, 2], rows),
                "What is read at a crossing: lists of differences in the paper's code, or the nodes of the tree of cells.",
                Table("crossings", ["crossings", "bytes each, deltas", "tree", "ratio", "all deltas, bytes", "all nodes, bytes"], [0, 0, 0, 3, 0, 0], read))


def shrunk(results):
    rows = []
    for row in results.table("shrunk.csv", "best_drawn"):
        rows.append([row["place"], row["cell_edge"], row["middle_drawn"], row["best_drawn"], 100 * (1 - row["best_drawn"] / row["middle_drawn"]),
                     1e-3 * row["middle_shrink_cpu_ms"], 1e-3 * row["best_shrink_cpu_ms"], 1e-3 * row["best_query_cpu_ms"], row["hull_drawn"], 1e-3 * row["hull_cpu_ms"]])
    return part("shrunk", "5.2: the best projection point of shrunk occluders",
                "Triangles that shrunk occluders leave, projected from the middle of the cell and from the point of the quadratic programme. In the paper the latter saves 5 to 10 % of a cell's "
                "triangles and takes 0.02 s; shrinking takes 0.16 s and queries 0.2 to 2 s a cell. Beside it the cell builder with hull tests.",
                Table("shrunk", ["cell", "edge, m", "from the middle", "from the best point", "saved, %", "shrinking from the middle, s", "from the best point, s", "queries, s",
                                 "hull: triangles", "s"], [None, 0, 0, 0, 1, 3, 3, 3, 0, 3], rows))


def cells(results):
    told = {scene: [results.json(f"{scene}_{name}.json") for name in ("build", "viewcells", "t_build", "t4_build")] for scene in results.scenes}
    told = {scene: runs for scene, runs in told.items() if all(runs)}

    def row(what, paper, digits, value):
        return [what, paper, *(value(*runs) for runs in told.values())], digits

    def over_paths(measured, key, pick):
        return pick(path[key] for path in measured["paths"].values())

    def worst_rms(measured):
        return max((path["compared"]["depth_rms_px"]["largest"] for path in measured["paths"].values() if "compared" in path), default=None)

    def unexplained(measured):
        return sum(path["compared"]["unexplained_px"] for path in measured["paths"].values() if "compared" in path)

    rows = [row("cells", "5,000,000", 0, lambda b, v, t, q: b["cells"]), row("processor time of all, s", "four nights on 16 PCs", 0, lambda b, v, t, q: b["cpu_s"]),
            row("s a cell: median", "0.4 to 2.2", 3, lambda b, v, t, q: v["cuts"]["seconds"]["median"]), row("s a cell: most", "", 3, lambda b, v, t, q: v["cuts"]["seconds"]["largest"]),
            row("triangles of a cell: median", "", 0, lambda b, v, t, q: b["drawn_median"]), row("triangles of a cell: most", "", 0, lambda b, v, t, q: b["drawn_max"]),
            row("triangles over those that 125 eyes see: median", "2 to 10", 2, lambda b, v, t, q: v["cuts"]["drawn_over_seen"]["median"]),
            row("triangles over those that 125 eyes see: most", "", 2, lambda b, v, t, q: v["cuts"]["drawn_over_seen"]["largest"]),
            row("cells above T, %", "30", 1, lambda b, v, t, q: 100 * t["above_most_triangles"]), row("cells above T: times T, mean", "1.5", 2, lambda b, v, t, q: t["above_by"] or None),
            row("cells above T/4, %", "", 1, lambda b, v, t, q: 100 * q["above_most_triangles"]), row("cells above T/4: times T/4, mean", "", 2, lambda b, v, t, q: q["above_by"] or None),
            row("crossings on all paths", "228 in 180 cells", 0, lambda b, v, t, q: over_paths(v, "crossings", sum)), row("bytes a crossing", "2,000", 0, lambda b, v, t, q: b["crossing_bytes_mean"]),
            row("bytes a cell", "", 0, lambda b, v, t, q: b["bytes_per_cell"]), row("file over hierarchies", "about 1", 4, lambda b, v, t, q: b["bytes_over_hierarchies"]),
            row("memory of a walk, bytes", "low", 0, lambda b, v, t, q: over_paths(v, "resident_bytes", max)),
            row("frames a second with drawing: least of the medians", "15 to 40, GeForce 4", 1, lambda b, v, t, q: 1e3 / over_paths(v, "picture_ms", lambda all: max(one["median"] for one in all))),
            row("frames without drawing, ms: 99th percentile", "", 3, lambda b, v, t, q: over_paths(v, "frame_ms", lambda all: max(one["p99"] for one in all))),
            row("late frames", "not given", 0, lambda b, v, t, q: over_paths(v, "late", sum)), row("late frames without prefetch", "", 0, lambda b, v, t, q: over_paths(v, "late_without_prefetch", sum)),
            row("tolerance, px", "1", 2, lambda b, v, t, q: v["tolerance_px"]), row("depth RMS against the full mesh, px, most", "", 4, lambda b, v, t, q: worst_rms(v)),
            row("unexplained pixels of frames", "unchecked", 0, lambda b, v, t, q: unexplained(v))]
    return part("cells", "6: cells and walks", "The paper's figures are of its power plant and its machines; our frames are drawn on the processor.",
                Table("cells", ["", "paper", *told], None, [row for row, _ in rows] if told else [], [digits for _, digits in rows]))


def costs(results):
    rows, seconds, bytes_ = [], {}, {}
    for scene, mode, tolerance in itertools.product(results.scenes, cells_runs.MODES, cells_runs.TOLERANCES):
        cost = results.cost(scene, mode, tolerance)
        if not cost:
            continue
        rows.append([scene, mode, tolerance, cost["cells"], cost["cpu_s_per_cell"], cost["drawn_mean"], cost["bytes_per_cell"], cost["bytes_over_hierarchies"], cost["pixels"], cost["unexplained"],
                     100 * ratio(cost["unexplained"], cost["pixels"])])
        name = mode if len(results.scenes) == 1 else f"{scene}, {mode}"
        seconds.setdefault(name, []).append([tolerance, 1000 * cost["cpu_s_per_cell"]])
        bytes_.setdefault(name, []).append([tolerance, cost["bytes_per_cell"] / 1000])
    return part("costs", "What accuracy costs in seconds and bytes",
                "The same cells at four tolerances and with each kind of occlusion, by one thread; seconds with what is made once for all cells. Pixels: of images from random eyes, to all sides; "
                "unexplained are those that show surface with nothing drawn within the tolerance. With hull there are none, by promise; sampled promises nothing.",
                Plot("cost_seconds", "processor time of a cell", "tolerance, px", "ms a cell", seconds, log=True), Plot("cost_bytes", "file of the cells, bytes a cell", "tolerance, px", "kB a cell", bytes_),
                Table("costs", ["scene", "occlusion", "tolerance, px", "cells", "s a cell", "triangles drawn, mean", "bytes a cell", "file over hierarchies", "pixels", "unexplained", "%"],
                      [None, None, 1, 0, 3, 0, 0, 5, 0, 0, 5], rows))


def by_size(results):
    told = results.table("shrunk.csv", "seen_by_125_eyes")
    rows = [[row["place"], row["cell_edge"], row["seen_by_125_eyes"], *(ratio(row[key], row["seen_by_125_eyes"]) for key in BY_SIZE)] for row in told]
    plots = []
    for place in dict.fromkeys(row["place"] for row in told):
        lines = {shown: [[row["cell_edge"], ratio(row[key], row["seen_by_125_eyes"])] for row in told if row["place"] == place and row[key] is not None]
                 for key, shown in BY_SIZE.items() if key != "drawn_without_occlusion"}
        plots.append(Plot(f"size_{place.replace(' ', '_')}", f"{place}: triangles drawn over those that 125 eyes see", "edge of the cell, m", "times what is seen", lines))
    return part("size", "Triangles against the size of cells", "Triangles drawn for a cell over those of the builder's cut that 125 eyes see, by what hides. What is drawn where nothing does is "
                "in the table only. The paper's methods hide by the largest boxes inside houses, which suits them best.", *plots,
                Table("size", ["cell", "edge, m", "seen by 125 eyes", *BY_SIZE.values()], [None, 0, 0] + [2] * len(BY_SIZE), rows))


def against_rays(results):
    """By cell: our row and that of gvs when it misses no more than 0.01 %."""
    told = results.table("rays.csv", "within")
    for row in told:
        if row["way"] == "hull 1 px":
            yield row, next(other for other in told if (other["place"], other["cell_edge"], other["way"], other["within"]) == (row["place"], row["cell_edge"], "gvs", 0.01))


def rays(results):
    told = results.table("rays.csv", "within")
    cells_of = list(dict.fromkeys((row["place"], row["cell_edge"]) for row in told))
    found = {(row["place"], row["cell_edge"], row["way"], row["within"]): row for row in told}
    rows = []
    for (place, edge), way in itertools.product(cells_of, RAYS):
        end = found.get((place, edge, way, "end"))
        if end:
            times = [(found.get((place, edge, way, within)) or {}).get("cpu_ms") for within in (1, 0.1, 0.01, 0.001)]
            rows.append([place, edge, way, *times, end["cpu_ms"] or None, end["rays"] or None, end["triangles"], end["missed_pixels"], 100 * end["missed_pixels"] / end["pixels"]])
    return part("rays", "Rays and objects, for comparison",
                "gvs: guided visibility sampling (Wonka and others 2006) with Embree finds triangles of the input that something in the cell sees; it decides which triangles, not which level of "
                "detail. Objects: whole houses, kept where rays find one of their triangles, or where the hull test does not hide their boxes. hull: the cell builder, which chooses a level of "
                "detail. All ask about the same cells, by one thread; pixels are those of eyes that none of them has used.",
                Table("rays", ["cell", "edge, m", "way", "ms to 1 % missed", "to 0.1 %", "to 0.01 %", "to 0.001 %", "ms in all", "rays", "triangles", "pixels missed", "%"],
                      [None, 0, None, 1, 1, 1, 1, 0, 0, 0, 0, 5], rows))


def cluster(results):
    measured = results.table("cluster.csv", "two_workers_s")
    if not measured:
        return part("cluster", "Many machines: a model")
    cell_s = statistics.median(row["one_process_s"] / row["cells"] for row in measured)
    rows = [[cores, *(value / by for value, by in zip(cluster_model.modelled(5e6, cell_s, cores, TASKS_A_SECOND, 60.0), (3600.0, 0.01)))] for cores in (16, 256, 1000, 10_000)]
    return part("cluster", "Many machines: a model", f"Measured on two cores: {measured[0]['cells']} cells by one process and by one and two workers of Dask. Not measured, but a model of five million such "
                f"cells: {cell_s:.2f} s each, {TASKS_A_SECOND} tasks a second by the scheduler, a minute to start (docs/guide/view_cells.md#many-machines). The paper: five million cells in four nights on 16 PCs.",
                Table("measured_cluster", ["run", "cells", "one process, s", "one worker, s", "two workers, s", "two workers over one process, times"], [0, 0, 2, 2, 2, 2],
                      ([row["run"], row["cells"], row["one_process_s"], row["one_worker_s"], row["two_workers_s"], row["one_process_s"] / row["two_workers_s"]] for row in measured)),
                Table("modelled_cluster", ["cores (model)", "hours", "of the cores at work, %"], [0, 2, 0], rows))


def elsewhere(results):
    del results
    return part("elsewhere", "What has no numbers",
                Table("elsewhere", ["in the paper", "what", "ours"], [None] * 3,
                      [["Fig. 1, 12 to 15", "pictures of cells and of what is drawn", "the viewer's panel Cells and its script scripts/viewer_cells.json (docs/guide/viewer.md)"],
                       ["Fig. 3, 5, 6, 8, 9", "constructions: cones, horizon planes, cull maps, shrunk occluders", "bench/papers, tested by ctest -R '^paper_cells$'"],
                       ["dual ray space", "compared, slower to compute; no figures", "not built"]]))


def hashes(results):
    rows = []
    for scene in results.scenes:
        measured = results.json(f"{scene}_viewcells.json")
        if measured:
            rows.append([scene, "cuts", measured["cuts"]["hash"]])
            rows += [[scene, f"walk {name}", path["hash"]] for name, path in measured["paths"].items()]
        rows += [[scene, f"triangles of frames and crossings, {shown}", walked["hash"]] for which, shown in (("t", "T"), ("t4", "T/4")) if (walked := results.walks(scene, which))]
    return part("hashes", "Hashes", "The same in every run, but for walks, whose loads take measured time.", Table("hashes", ["scene", "of", "hash"], [None] * 3, rows))
