#!/usr/bin/env python3
"""hlod_page.py FOLDER: makes FOLDER/report.html, one page that needs nothing else, of what scripts/hlod_runs.py has left in FOLDER: the tables of the
papers on HLODs with our figures beside theirs, their figures, and verdicts; two of the figures alone as above.svg and cover.svg."""
import html
import pathlib
import sys

import hlod_cover
import hlod_table4
import hlod_tables
from hlod_document import Html

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "bench/report"))
import page  # noqa: E402
import plot  # noqa: E402

CSS = page.CSS + """
h2{border-top:1px solid var(--grid);padding-top:1rem}td.met{color:var(--s2)}td.missed{color:var(--mark);font-weight:600}table{margin:.4rem 0 1rem}
td.words,th.words{text-align:left}.plots figure p.legend{margin:.1rem 0 0}nav{display:flex;flex-wrap:wrap;gap:.2rem 1rem;margin:.6rem 0}nav a{color:var(--s0)}details{margin:.6rem 0}
"""
GOALS = {1: "Coh(B) predicts what SW(B) would draw", 2: "speed of biased errors", 3: "pictures at that speed", 4: "NOHC is near its optimum",
         5: "batch beats the optimum of single queries, auto the best fixed strategy", 6: "shifted groups have no gaps and cost little", 7: "beside today's engines"}
DEAR = "virtual:query-dear"
FIGURE_7 = {strategy: hlod_table4.NAMES[strategy] for strategy in ("bool", "nohc", "optimum", "batch")}
FIGURE_8 = {strategy: hlod_table4.NAMES[strategy] for strategy in ("vfc", "bool", "nohc", "batch")}


def main():
    folder = pathlib.Path(sys.argv[1])
    results = hlod_tables.Results(folder)
    if results.load("about") is None:
        sys.exit(f"hlod_page.py: {folder}: has no about.json: run scripts/hlod_report.sh")
    hlod_tables.write_csv(results)
    write_pictures(results, folder)
    (folder / "report.html").write_text(whole_page(results))
    print(folder / "report.html")


def whole_page(results):
    document = Html()
    for part in (first_paper, second_paper, bias, culling, cover, goals):
        part(document, results)
    title = "HLODs refined by occlusion queries"
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width,initial-scale=1"><title>occlod: {title}</title>
<style>{plot.style()}{CSS}</style></head><body>
<h1>{title}</h1>{about(results)}
{summary(results)}
{document.contents()}
{document}
<h2>Everything measured</h2><p>A line for each run: {download(results.folder / "runs.csv")}</p>
</body></html>
"""


def about(results):
    told = results.load("about")
    small = "<p><strong>This is the small form that tests make, of tiny stand-ins of the scenes: its figures say nothing.</strong></p>" if told.get("small") else ""
    rough = "<p><strong>Quick: few frames, rough figures.</strong></p>" if told["quick"] else ""
    line = "; ".join(html.escape(part) for part in (told["date"], told["machine"], f"commit {told.get('commit', 'not told')}"))
    return (f"{small}{rough}<p>{line}. Times are those of simulated devices, the same on every machine, unless llvmpipe is named; the published ones are of cards and scenes "
            "that we do not have: compare ratios.</p>")


def summary(results):
    document = Html()
    rows = []
    judged = hlod_tables.all_goals(results)
    for goal, what in GOALS.items():
        verdicts = [row[-1] for row in judged if row[0] == goal]
        rows.append([goal, what, verdicts.count("met"), verdicts.count("**missed**")])
    document.table(["goal", "", "met", "missed"], rows)
    return str(document)


def first_paper(document, results):
    document.heading("The scenes of Charalambos")
    hlod_tables.print_scenes(document, results)
    hlod_tables.print_first_paper(document, results)
    if all(results.session("first", scene) for scene in hlod_tables.FIRST):
        hlod_tables.print_speed_ups(document, results)
    figures = []
    for index, scene in enumerate(hlod_tables.FIRST):
        for number, key, label in ((2 * index + 2, "fps", "frames a second"), (2 * index + 3, "drawn_nodes", "nodes drawn")):
            caption = f"Fig. {number}: {scene}: {', '.join(hlod_tables.SESSION)}, one after another"
            figures.append(course(results, [f"first_{scene}_{path}" for path in hlod_tables.SESSION], {s: name for s, (name, _) in hlod_tables.PAPER_2006.items()}, key, label, caption))
    add_figures(document, "Charalambos 2006, figures 2 to 7: frame by frame", figures)


def second_paper(document, results):
    hlod_tables.print_second_paper(document, results)
    hlod_tables.print_by_motion(document, results)
    names = {s: name for s, (name, _) in hlod_tables.PAPER_2007.items()}
    figures = [course(results, [f"second_{scene}_walk"], names, key, label, f"Fig. 4: {scene}, walk") for scene in hlod_tables.SECOND
               for key, label in (("drawn_nodes", "nodes drawn"), ("fps", "frames a second"))]
    add_figures(document, "Charalambos and others 2007, figure 4", figures)
    hlod_tables.print_psnr(document, results)
    hlod_tables.print_llvmpipe(document, results)


def bias(document, results):
    hlod_tables.print_sweep(document, results)
    points = hlod_tables.sweep(results)
    lines = {}
    for name, told in points.items():
        if told["unculled_psnr_y"] is not None:
            lines[name] = [(told["frame_ms"], told["unculled_psnr_y"])]
    drawn = plot.Lines(lines, "ms a frame", "PSNR Y against Bool, dB", dots=True, from_zero=False)
    add_figures(document, "What accuracy costs in time: each point is a bias (s, t)", [figure(drawn, f"upper left is better; Bool, which the others are compared with, takes {ms_without_bias(points)}")])


def ms_without_bias(points):
    return next((f"{told['frame_ms']:.3f} ms" for name, told in points.items() if name == hlod_tables.NO_BIAS), "a time that was not measured")


def culling(document, results):
    hlod_table4.print_guthe(document, results)
    hlod_table4.print_lengths(document, results)
    figures = [course(results, ["table4_city"], FIGURE_7, "frame_ms", "ms", "Fig. 7: city, walk between houses, query-dear", DEAR),
               course(results, ["figure8_city"], FIGURE_8, "frame_ms", "ms", "Fig. 8: city, above the roofs, query-dear", DEAR)]
    add_figures(document, "Guthe and others 2006, figures 7 and 8: much and little is hidden", figures)


def cover(document, results):
    hlod_cover.print_cover(document, results)
    add_figures(document, None, [figure(cover_plot(results, model), f"Fig. 3, p_cov as {model}: by tenths of what is predicted; the grey line is where predictions are right")
                                 for model in hlod_cover.MODELS])


def cover_plot(results, model):
    lines = {source: [(row["predicted"], row["hidden"]) for row in told["models"][model]["by_prediction"]] for source, told in results.load_all("cover", hlod_cover.SOURCES).items()}
    return cover_lines(lines, model)


def cover_lines(lines, model, **options):
    drawn = plot.Lines(lines, f"predicted probability p_cov, as {model}", "share of boxes that are covered", dots=True, **options)
    drawn.diagonal = True
    return drawn


def goals(document, results):
    hlod_tables.print_goals(document, results)


def course(results, runs, names, key, label, caption, device=None):
    """Frame by frame, several runs one after another; on the first device unless told otherwise."""
    shown = device or next(iter(results.frames(runs[0])), (None,))[0]
    where = f", {hlod_tables.mapped(shown)}" if not device and shown else ""
    return figure(plot.Lines(lines_of(results, runs, names, key, shown), "frame", label), caption + where)


def lines_of(results, runs, names, key, device):
    lines, first = {}, 0
    for run in runs:
        told = results.frames(run)
        for strategy, name in names.items():
            lines.setdefault(name, []).extend((first + i, value_of(frame, key)) for i, frame in enumerate(told.get((device, strategy), [])))
        first = max((x + 1 for line in lines.values() for x, _ in line), default=0)
    return lines


def write_pictures(results, folder):
    """Figures 3 and 8 of Guthe and others alone."""
    date = (results.load("about") or {}).get("date", "")
    covered = cover_alone(cover_plot(results, "printed").lines, date)
    for name, drawn in (("above.svg", above(lines_of(results, ["figure8_city"], FIGURE_8, "frame_ms", DEAR), date)), ("cover.svg", covered)):
        if drawn.lines:
            (folder / name).write_text(drawn.svg(standalone=True) + "\n")


def cover_alone(lines, date):
    """`lines`: by source, (predicted, share that is covered)."""
    about = [f"Nodes of the scenes plant, city, dragon_alone and car, and random ellipsoids (Guthe and others 2006, fig. 3), by tenths of what is predicted. {date}.",
             "The grey line is where predictions are right."]
    return cover_lines(lines, "printed", size=(960, 340), legend_px=170, title="How often boxes are covered, by how probable the model holds it", about=about)


def above(lines, date):
    """`lines`: by strategy, (frame, ms)."""
    about = [f"Scene city, path fly_over, error of at most 1 px; simulated device query-dear (Guthe and others 2006, fig. 8). {date}.",
             "VFC draws all that is in view without queries. NOHC and batch ask only where that is expected to pay."]
    return plot.Lines(lines, "frame of the path", "time of a frame, ms", size=(880, 340), legend_px=130, title="Above the roofs of a city, where little is hidden", about=about)


def value_of(frame, key):
    if key == "fps":
        return 1e3 / float(frame["frame_ms"]) if float(frame["frame_ms"]) > 0 else 0.0
    return float(frame[key])


def figure(drawn, caption):
    """Empty where nothing was measured."""
    if not drawn.lines:
        return ""
    return f"<figure>{drawn.svg()}{drawn.legend()}<figcaption>{html.escape(caption)}</figcaption></figure>"


def add_figures(document, title, figures):
    if not any(figures):
        return
    heading = f"<h3>{html.escape(title)}</h3>" if title else ""
    document.add(f'{heading}<div class="plots">{"".join(figures)}</div>')


def download(path):
    return f'<a download="{path.name}" href="{page.data_uri(path, "text/csv")}">{path.name}</a>'


if __name__ == "__main__":
    main()
