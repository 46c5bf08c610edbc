#!/usr/bin/env python3
"""hlod_tables.py FOLDER: the tables of Charalambos 2006, of Charalambos and others 2007 and of Guthe and others 2006 with our figures beside theirs, and what
HLODs are asked to reach with verdicts, from what scripts/hlod_runs.py has left in FOLDER; and all runs as FOLDER/runs.csv, Coh(B) by speed and latency as
FOLDER/motion.csv. What is missing there is missing here."""
import csv
import hashlib
import json
import pathlib
import sys

import hlod_cover
import hlod_splits
import hlod_table4
from hlod_document import Markdown

SESSION = ("overview", "rotation", "close_ups")
FIRST, SECOND = ("hlod_row", "hlod_grid", "hlod_shelves"), ("hlod_5m", "hlod_12m")

# Charalambos 2006, table 1 (Pentium M 1.7, GeForce Go 6200): FPS, nodes drawn, RARN, by scene.
PAPER_2006 = {"simp": ("CHLOD-eps^q", ((72.3, 94.82, 0.85), (40.56, 166.54, 1.97), (62.49, 159.32, 2.95))),
              "bool": ("CHLOD-eps", ((61.57, 110.69, None), (34.99, 193.92, None), (47.69, 200.9, None))),
              "sw-b": ("SW-eps^q", ((53.23, 75.71, None), (28.48, 141.25, None), (43.27, 103.8, None))),
              "sw": ("SW-eps", ((40.39, 107.24, None), (22.24, 180.56, None), (28.19, 199.48, None)))}
# Charalambos and others 2007, table 1 (Core 2 Duo, 8800 GTX): nodes drawn, RARN, delayed, FPS.
PAPER_2007 = {"bool": ("Bool", ((217, None, None, 169.9), (468.5, None, None, 92.9))), "sw-b": ("SW(B)", ((181.4, None, None, 47.3), (302.1, None, None, 68.2))),
              "simp": ("Simp(B)", ((200, 5, None, 173.6), (377.8, 4.3, None, 105.4))), "coh": ("Coh(B)", ((183.3, 0.1, 4.7, 191.6), (303.9, 0.4, 4.2, 130.2)))}
# Sec. 5.3 there: PSNR of Coh(B) against Bool over 20 random frames, mean and deviation, of Y, Cb and Cr.
PAPER_PSNR = (((42.84, 3.22), (67.04, 3.68), (56.2, 3.65)), ((35.51, 1.4), (59.34, 1.55), (48.69, 1.58)))


class Results:
    def __init__(self, folder):
        self.folder = folder

    def load(self, name):
        file = self.folder / f"{name}.json"
        return json.loads(file.read_text()) if file.exists() else None

    def load_all(self, part, names):
        """By name: what is told of that part; without those that are missing."""
        found = {name: self.load(f"{part}_{name}") for name in names}
        return {name: told for name, told in found.items() if told}

    def runs(self, *names):
        """By device and strategy: averages over several runs with as many frames each. Nothing where one of them is missing."""
        reports = [self.load(name) for name in names]
        if not names or None in reports:
            return {}
        found = {}
        for report in reports:
            for run in report["runs"]:
                found.setdefault((run["device"], run["strategy"]), []).append(run)
        return {key: averaged(runs) for key, runs in found.items()}

    def frames(self, name):
        """By device and strategy: what is told of each frame of a run."""
        found = {}
        file = self.folder / f"{name}.csv"
        if file.exists():
            with file.open(newline="") as rows:
                for row in csv.DictReader(rows):
                    found.setdefault((row["device"], row["strategy"]), []).append(row)
        return found

    def session(self, kind, scene):
        return self.runs(*(f"{kind}_{scene}_{path}" for path in SESSION))

    def second(self, scene):
        return self.session("second", scene) if scene in FIRST else self.runs(f"second_{scene}_walk")

    def mended(self, scene):
        """The same, but for Coh(B), which asks when all that is known to be visible has been drawn."""
        mended = self.session("mended", scene) if scene in FIRST else self.runs(f"mended_{scene}_walk")
        second = self.second(scene)
        return {**second, **mended} if second and mended else {}


def averaged(runs):
    result = dict(runs[0])
    for key, value in runs[0].items():
        if isinstance(value, (int, float)):
            result[key] = sum(run[key] for run in runs) / len(runs)
    result["fps"] = 1e3 / result["frame_ms"] if result["frame_ms"] else 0
    if len(runs) > 1:
        result["hash"] = hashlib.sha256("".join(run["hash"] for run in runs).encode()).hexdigest()[:16]
    return result


def number(value, digits=2):
    return "-" if value is None else f"{value:,.{digits}f}"


def devices_of(runs):
    return list(dict.fromkeys(device for device, _ in runs))


def mapped(text):
    return text.replace("virtual:", "")


def size_of(results):
    return results.load("about")["effort"].get("size", "640x480")


def print_first_paper(document, results):
    document.heading("Charalambos 2006, table 1")
    document.text(f"B = mu, alpha as printed there, distance to spheres, nested nodes with free borders, {size_of(results)}, 1 px. Theirs in brackets.")
    for index, scene in enumerate(FIRST):
        runs = results.session("first", scene)
        if not runs:
            continue
        document.text(f"`{scene}` ({('low', 'middle', 'high')[index]} depth complexity):")
        rows = []
        for strategy, (name, figures) in PAPER_2006.items():
            fps, nodes, rarn = figures[index]
            ours = [runs[device, strategy] for device in devices_of(runs)]
            rows.append([name, *(f"{number(run['fps'], 1)}" for run in ours), f"({number(fps, 1)})", f"{number(ours[0]['drawn_nodes'], 1)} ({number(nodes, 1)})",
                         f"{number(ours[0]['rarn'])} ({number(rarn)})", number(ours[0]["queries"], 1), number(ours[0]["wasted_queries"], 1),
                         " ".join(run["hash"] for run in ours)])
        document.table(["", *(f"FPS {mapped(device)}" for device in devices_of(runs)), "FPS", "nodes", "RARN", "queries", "wasted", "hashes"], rows)


def print_speed_ups(document, results):
    document.text("Speed of CHLOD-eps^q, relative to:")
    rows = []
    for other, paper in (("bool", (17, 16, 31)), ("sw-b", (36, 42, 44)), ("sw", (79, 82, 122))):
        row = [PAPER_2006[other][0]]
        for index, scene in enumerate(FIRST):
            runs = results.session("first", scene)
            ours = [f"{100 * (runs[device, 'simp']['fps'] / runs[device, other]['fps'] - 1):+.0f}" for device in devices_of(runs)]
            row.append(f"{' / '.join(ours) or '-'} % ({paper[index]:+d})")
        rows.append(row)
    document.table(["", *FIRST], rows)


def print_second_paper(document, results):
    if not any(results.runs(f"{kind}_{scene}_walk") for kind in ("second", "ours") for scene in SECOND):
        return
    document.heading("Charalambos and others 2007, table 1")
    document.text(f"B_(s,t) with s,t = {results.load('about')['bias']}, alpha exact, distance to spheres, nested nodes with free borders, {size_of(results)}, 1 px. Theirs in brackets.")
    for index, scene in enumerate(SECOND):
        for runs, title in ((results.second(scene), "as published"), (results.mended(scene), "the same, but Coh(B) asks late (ours)"),
                            (results.runs(f"ours_{scene}_walk"), "ours: shifted groups without gaps, distance to boxes, asking late")):
            if not runs:
                continue
            document.text(f"`{scene}`, {title}:")
            rows = []
            for device in devices_of(runs):
                for strategy, (name, figures) in PAPER_2007.items():
                    nodes, rarn, delayed, fps = figures[index]
                    run, coh = runs[device, strategy], runs[device, "coh"]
                    paper_coh = PAPER_2007["coh"][1][index][3]
                    rows.append([mapped(device), name, f"{number(run['drawn_nodes'], 1)} ({number(nodes, 1)})", f"{number(run['rarn'])} ({number(rarn, 1)})",
                                 f"{number(run['delayed'] if strategy == 'coh' else None)} ({number(delayed, 1)})", number(run["queries"], 1), number(run["wasted_queries"], 1),
                                 f"{number(run['frame_ms'], 3)} ({number(1e3 / fps, 3)})",
                                 "" if strategy == "coh" else f"{coh['fps'] / run['fps']:.2f} ({paper_coh / fps:.2f})", run["hash"]])
            document.table(["device", "", "nodes", "RARN", "delayed", "queries", "wasted", "ms", "speed-up of Coh", "hash"], rows)


# Runs with answers at once and late, and what they are called.
WAYS = (("prompt", "Coh(B), answers at once"), ("late", "Coh(B), late, as published"), ("promptmended", "Coh(B) asking late and again, answers at once"),
        ("latemended", "Coh(B) asking late and again, late"))


def by_motion(results, scene):
    """Rows: how the camera moves, how answers come, and of Coh(B): nodes over SW(B)'s, and shares of its nodes that are delayed and RARN."""
    effort = results.load("about")["effort"]
    for part in ("still", *(f"slow{part}" for part in (*reversed(effort["slower"]), 1))):
        def counted(way, strategy):
            rows = [row for (_, name), rows in results.frames(f"{part}_{way}_{scene}").items() if name == strategy for row in rows]
            frames = effort["stand_frames"]
            return [row for row in rows if part != "still" or int(row["frame"]) % frames >= frames - 4]
        ideal = counted("prompt", "sw-b")
        for way, name in WAYS:
            coh = counted(way, "coh")
            if ideal and coh:
                nodes, delayed, rarn = (mean_of(coh, key) for key in ("drawn_nodes", "delayed", "rarn"))
                yield part, name, {"nodes": nodes / mean_of(ideal, "drawn_nodes"), "drawn": nodes, "delayed": delayed / nodes, "rarn": rarn / nodes}


def mean_of(rows, key):
    return sum(float(row[key]) for row in rows) / len(rows)


def print_by_motion(document, results):
    for index, scene in enumerate(SECOND):
        rows = {}
        for part, name, told in by_motion(results, scene):
            rows.setdefault(name, {})[part] = f"{told['nodes']:.3f}, {100 * told['delayed']:.1f}, {100 * told['rarn']:.2f}"
        if not rows:
            continue
        parts = list(dict.fromkeys(part for row in rows.values() for part in row))
        nodes, _, delayed, _ = PAPER_2007["coh"][1][index]
        document.text(f"`{scene}`: nodes of Coh(B) over SW(B)'s; of Coh(B)'s nodes, % delayed, % RARN, by the speed of the walk "
                      f"(theirs, at a speed that is not told: {nodes / PAPER_2007['sw-b'][1][index][0]:.3f}, {100 * delayed / nodes:.1f}, {100 * PAPER_2007['coh'][1][index][1] / nodes:.2f}; late: virtual:modern):")
        document.table(["", *("standing still" if part == "still" else "speed 1" if part == "slow1" else f"speed 1/{part[4:]}" for part in parts)],
                       [[name, *(row.get(part, "-") for part in parts)] for name, row in rows.items()])


def print_psnr(document, results):
    rows = []
    for index, scene in enumerate(SECOND):
        for device, strategy in results.runs(f"second_{scene}_walk"):
            if strategy != "coh":
                continue
            run = results.runs(f"second_{scene}_walk")[device, strategy]
            cells = [f"{number(run[f'unculled_psnr_{part}'])} +- {number(run[f'unculled_psnr_{part}_deviation'])} ({mean} +- {deviation})"
                     for part, (mean, deviation) in zip(("y", "cb", "cr"), PAPER_PSNR[index])]
            rows.append([scene, mapped(device), run["compared_frames"], *cells, number(run["psnr_y"])])
    if rows:
        document.text("PSNR in dB of Coh(B) against Bool, mean and deviation over frames spread evenly (theirs: 20 random ones), with smooth normals and without outlines:")
        document.table(["scene", "device", "frames", "Y", "Cb", "Cr", "Y against the input"], rows)


def print_llvmpipe(document, results):
    rows = []
    for scene in SECOND:
        for threads in ("0", "2"):
            runs = results.runs(f"llvmpipe{threads}_{scene}")
            for (_, strategy), run in runs.items():
                rows.append([scene, threads, PAPER_2007[strategy][0], number(run["drawn_nodes"], 1), number(run["frame_ms"], 1), number(run["stall_ms"], 1),
                             f"{runs['gl', 'coh']['fps'] / run['fps']:.2f}", run["hash"]])
    if rows:
        document.text("llvmpipe, by LP_NUM_THREADS; times are those of this machine:")
        document.table(["scene", "threads", "", "nodes", "ms", "stall ms", "speed-up of Coh", "hash"], rows)


NO_BIAS = "1 where visible"


def sweep(results):
    """By bias, what it draws."""
    found = {}
    for file in sorted(results.folder.glob("bias_*.json")):
        report = json.loads(file.read_text())
        bias = report["bias"]
        found[NO_BIAS if bias is None else f"{bias['s']:g}, {bias['t']:g}"] = report["runs"][0]
    return found


def print_sweep(document, results):
    rows = [[name, number(run["drawn_nodes"], 1), f"{run['drawn_triangles']:,.0f}", number(run["frame_ms"], 3), number(run["unculled_psnr_y"]), number(run["psnr_y"]),
             number(run["depth_rms_px"], 3), run["hash"]] for name, run in sweep(results).items()]
    if rows:
        document.heading("What the bias gives and costs")
        document.text("What SW(B) draws, known beforehand and drawn without a query (`ideal`), so that only the bias decides:")
        document.table(["s, t", "nodes", "triangles", f"ms {mapped(next(iter(sweep(results).values()))['device'])}", "PSNR Y against Bool", "against the input", "depth RMS px", "hash"], rows)


class Goals:
    def __init__(self):
        self.rows = []

    def add(self, goal, what, asked, figure, met):
        self.rows.append([goal, what, asked, figure, "-" if met is None else "met" if met else "**missed**"])


def ways(results, scene):
    """The published way to ask and ours, with a name."""
    return (("Coh(B)", results.second(scene)), ("Coh(B), asking late", results.mended(scene)))


def add_prediction(goals, results):
    for scene in FIRST + SECOND:
        for name, runs in ways(results, scene):
            for device in devices_of(runs):
                add_prediction_rows(goals, name, f"{scene}, {mapped(device)}", runs[device, "coh"], runs[device, "sw-b"])
    for scene in SECOND:
        for part, name, told in by_motion(results, scene):
            if part == "still" and told["nodes"] is not None:
                goals.add(1, f"{name} over SW(B), nodes, standing still: {scene}", "<= 1.005", f"{told['nodes']:.3f}", told["nodes"] <= 1.005)


def add_prediction_rows(goals, name, where, coh, ideal):
    nodes = coh["drawn_nodes"]
    goals.add(1, f"{name} over SW(B), nodes: {where}", "<= 1.005", f"{nodes / ideal['drawn_nodes']:.3f}", nodes <= 1.005 * ideal["drawn_nodes"])
    goals.add(1, "RARN, % of nodes", "<= 0.05", f"{100 * coh['rarn'] / nodes:.2f}", coh["rarn"] <= 0.0005 * nodes)
    goals.add(1, "delayed, % of nodes", "<= 3", f"{100 * coh['delayed'] / nodes:.2f}", coh["delayed"] <= 0.03 * nodes)


def add_speed(goals, results):
    for scene, asked in (("hlod_grid", 1.15), ("hlod_5m", 1.15), ("hlod_shelves", 1.45), ("hlod_12m", 1.45)):
        for name, runs in ways(results, scene):
            for device in devices_of(runs):
                ratio = runs[device, "coh"]["fps"] / runs[device, "bool"]["fps"]
                goals.add(2, f"speed of {name} over Bool: {scene}, {mapped(device)}", f">= {asked}", f"{ratio:.2f}", ratio >= asked)
            if "virtual:query-dear" in devices_of(runs):
                ratio = runs["virtual:query-dear", "coh"]["fps"] / runs["virtual:query-dear", "sw-b"]["fps"]
                goals.add(2, f"over SW(B): {scene}, query-dear", ">= 2", f"{ratio:.2f}", ratio >= 2)
    for scene in SECOND:
        runs = results.runs(f"llvmpipe2_{scene}")
        if runs:
            ratio = runs["gl", "coh"]["fps"] / runs["gl", "sw-b"]["fps"]
            goals.add(2, f"over SW(B): {scene}, llvmpipe with threads", ">= 2", f"{ratio:.2f}", ratio >= 2)
    for scene, asked in zip(FIRST, (15, 15, 30)):
        runs = results.session("first", scene)
        for device in devices_of(runs):
            gain = 100 * (runs[device, "simp"]["fps"] / runs[device, "bool"]["fps"] - 1)
            goals.add(2, f"speed of CHLOD-eps^q over CHLOD-eps, B = mu: {scene}, {mapped(device)}", f">= +{asked} %", f"{gain:+.0f} %", gain >= asked)


def add_pictures(goals, results):
    for scene, ((asked, _), _, _) in zip(SECOND, PAPER_PSNR):
        for name, runs in ways(results, scene):
            for device in devices_of(runs):
                psnr = runs[device, "coh"]["unculled_psnr_y"]
                goals.add(3, f"PSNR Y of {name} against Bool: {scene}, {mapped(device)}", f">= {asked} dB", number(psnr), psnr is not None and psnr >= asked)


def add_graph(goals, results):
    for scene in ("hlod_row", "hlod_grid", "hlod_shelves", "hlod_5m", "hlod_12m"):
        valid = results.load(f"fronts_{scene}")
        if valid:
            goals.add(6, f"violations on {results.load('about')['effort']['fronts']:,} random fronts: {scene}", "0", len(valid["violations"]), valid["valid"])
    for kind in ("shifted", "nested"):
        found = {file.stem: json.loads(file.read_text())["runs"][0] for file in results.folder.glob(f"cracks_*_{kind}_*.json")}
        if found:
            cracks = {name: run["crack_px"] * run["compared_frames"] for name, run in found.items()}
            frames = sum(run["compared_frames"] for run in found.values())
            figure = f"{sum(cracks.values()):.0f} in {frames} frames of {len(found)} paths"
            goals.add(6, f"crack pixels, vfc, {kind}", "0" if kind == "shifted" else "> 0, shown", figure, sum(cracks.values()) == 0 if kind == "shifted" else None)
    add_equal_errors(goals, results)
    off, on = results.runs("geomorph_off"), results.runs("geomorph_on")
    if off and on:
        for key, name in (("largest_popping_px", "largest pop"), ("popping_rms_px", "depth RMS of pops")):
            before, after = off["software", "vfc"][key], on["software", "vfc"][key]
            goals.add(6, f"{name}, geomorphs over none: hlod_row, overview", "<= 0.35" if key.startswith("largest") else "shown",
                      f"{after:.2f} / {before:.2f} px = {after / before:.2f}" if before else "nothing popped",
                      after <= 0.35 * before if before and key.startswith("largest") else None)


def add_equal_errors(goals, results):
    """Triangles of shifted groups at the depth RMS of nested ones, between tolerances as straight lines in logarithms."""
    for path in ("close_ups", "overview"):
        curves = {}
        for kind in ("nested", "shifted"):
            runs = [json.loads(file.read_text())["runs"][0] for file in results.folder.glob(f"rms_hlod_grid_{kind}_{path}_*.json")]
            curves[kind] = sorted((run["depth_rms_px"], run["drawn_triangles"]) for run in runs)
        ratios = [interpolated(curves["shifted"], rms) / triangles for rms, triangles in curves["nested"] if interpolated(curves["shifted"], rms)]
        if ratios:
            mean = sum(ratios) / len(ratios)
            goals.add(6, f"triangles of shifted over nested, free at equal depth RMS: hlod_grid, {path}", "<= 1.15",
                      f"{mean:.3f} ({min(ratios):.3f} to {max(ratios):.3f})", mean <= 1.15)


def interpolated(curve, rms):
    for (low, many), (high, few) in zip(curve, curve[1:]):
        if low <= rms <= high:
            t = (rms - low) / (high - low) if high > low else 0
            return many ** (1 - t) * few ** t
    return None


def all_goals(results):
    """Rows: goal, what, asked, figure, verdict."""
    goals = Goals()
    for add in (add_prediction, add_speed, add_pictures, hlod_table4.add_guthe, add_graph, hlod_splits.add_splits):
        add(goals, results)
    return sorted(goals.rows, key=lambda row: row[0])


def print_goals(document, results):
    rows = all_goals(results)
    document.heading("What is asked")
    document.table(["goal", "what", "asked", "figure", "verdict"], rows)
    judged = [row[-1] for row in rows if row[-1] != "-"]
    document.text(f"{judged.count('met')} met, {len(judged) - judged.count('met')} missed.")


def print_scenes(document, results):
    rows = []
    for scene in FIRST + SECOND:
        built = [results.load(f"{scene}_{kind}") for kind in ("nested", "shifted")]
        if None not in built:
            rows.append([scene, f"{built[0]['triangles']:,}", *(f"{told['nodes']:,} ({told['node_triangles']:,})" for told in built),
                         *(f"{told['build_ms'] / 1e3:.1f}" for told in built)])
    document.table(["scene", "triangles", "nodes, nested (most triangles each)", "nodes, shifted", "built in s, nested", "shifted"], rows)


def write_csv(results):
    """A line for each run: what was drawn, with what and how, and all that came of it. Crack pixels only where no bias makes them doubtful."""
    rows = []
    for file in sorted(results.folder.glob("*.json")):
        report = json.loads(file.read_text())
        for run in report.get("runs", ()):
            bias = report["bias"] or {"s": "", "t": ""}
            rows.append({"run": file.stem, "scene": report["scene"], "path": report["path"], "tolerance_px": report["tolerance_px"], "bias_s": bias["s"],
                         "bias_t": bias["t"], **{key: value for key, value in run.items() if key != "crack_px" or run["strategy"] == "vfc"}})
    keys = list(dict.fromkeys(key for row in rows for key in row))
    with open(results.folder / "runs.csv", "w", newline="") as file:
        table_of_runs = csv.DictWriter(file, keys, restval="", lineterminator="\n")
        table_of_runs.writeheader()
        table_of_runs.writerows(rows)


def write_motion_csv(results):
    with open(results.folder / "motion.csv", "w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["scene", "motion", "way", "drawn_nodes", "over_sw_b", "delayed_share", "rarn_share"])
        for scene in SECOND:
            for part, name, told in by_motion(results, scene):
                motion = "still" if part == "still" else f"1/{part[4:]}"
                table.writerow([scene, motion, name, *(f"{told[key]:.6g}" for key in ("drawn", "nodes", "delayed", "rarn"))])


def print_tables(document, results):
    print_scenes(document, results)
    print_first_paper(document, results)
    if all(results.session("first", scene) for scene in FIRST):
        print_speed_ups(document, results)
    print_second_paper(document, results)
    print_by_motion(document, results)
    print_psnr(document, results)
    print_llvmpipe(document, results)
    print_sweep(document, results)
    hlod_table4.print_guthe(document, results)
    hlod_table4.print_lengths(document, results)
    hlod_cover.print_cover(document, results)
    hlod_splits.print_splits(document, results)
    print_goals(document, results)


def main():
    results = Results(pathlib.Path(sys.argv[1]))
    about = results.load("about")
    print(f"# HLODs refined by occlusion queries\n\n{about['date']}, {about['machine']}{', quick: rough figures' if about['quick'] else ''}\n")
    print_tables(Markdown(), results)
    write_csv(results)
    hlod_cover.write_csv(results)
    write_motion_csv(results)


if __name__ == "__main__":
    main()
