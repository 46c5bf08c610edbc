#!/usr/bin/env python3
"""page.py FOLDER: makes FOLDER/report.html, one page that needs nothing else, from the report.json, points.csv and pictures that bench_report left
there; its main plot alone as FOLDER/main_plot.svg, and its tables as FOLDER/report.md."""
import base64
import html
import json
import pathlib
import sys

import break_even
import plot
from plot import Plot, short

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
import hlod_splits  # noqa: E402

CSS = """
:root{color-scheme:light dark}
body{font:16px/1.5 system-ui,sans-serif;color:var(--ink);background:var(--paper);max-width:76rem;margin:0 auto;padding:1rem}
h1{font-size:1.5rem;margin:.2rem 0}h2{font-size:1.2rem;margin:2rem 0 .4rem}p{margin:.4rem 0;max-width:60rem}
dl{display:grid;grid-template-columns:max-content 1fr;gap:.15rem 1rem;margin:.6rem 0}dt{font-weight:600}dd{margin:0}
code{font:.92em ui-monospace,monospace;background:var(--grid);padding:.05em .35em;border-radius:3px}
tr.pick td{color:var(--mark);font-weight:600}.plots{display:flex;flex-wrap:wrap;gap:.8rem}.plots figure{margin:0;flex:1 1 27rem;max-width:37rem}
svg.plot{width:100%;height:auto}figcaption{font-size:.9rem;color:var(--soft)}.legend{display:flex;flex-wrap:wrap;gap:.2rem 1.1rem;font-size:.9rem}
.legend svg{vertical-align:-3px}table{border-collapse:collapse;font-size:.86rem;display:block;overflow-x:auto}
td,th{padding:.15rem .55rem;border-bottom:1px solid var(--grid);text-align:right;white-space:nowrap}td:first-child,th:first-child{text-align:left}
th{vertical-align:bottom;white-space:normal}.pictures{display:flex;flex-wrap:wrap;gap:.5rem}.pictures figure{margin:0;max-width:20rem}
.pictures img{max-width:100%;display:block}.point:hover path,.point.lit path{stroke:var(--ink);stroke-width:3}@media(max-width:40rem){dl{grid-template-columns:1fr}}
"""
# The same setting lights up in every plot.
SCRIPT = """
const points = [...document.querySelectorAll('.point[data-setting]')];
for (const point of points) for (const [event, lit] of [['mouseenter', true], ['mouseleave', false]])
  point.addEventListener(event, () => points.forEach(p => p.dataset.setting === point.dataset.setting && p.classList.toggle('lit', lit)));
"""
X_LABELS = {"ms": "refinement and occlusion, ms a frame", "triangles": "triangles"}


class Report:
    """`data`: what report.json holds."""

    def __init__(self, data, folder=None):
        self.folder, self.data = folder, data
        # No scene has textures, for instance, and so none a slip.
        self.measures = {m["key"]: m for m in self.data["measures"] if any(p[m["key"]] is not None for p in self.data["points"])}
        self.settings = {s["name"]: s for s in self.data["settings"]}
        self.series = list(dict.fromkeys(s["series"] for s in self.data["settings"] if s["series"]))
        self.choice = self.data["choice"]
        self.main = self.measures[self.choice["measure"]]

    def points(self, scene="all"):
        return [p for p in self.data["points"] if p["scene"] == scene]

    def point(self, setting, scene="all"):
        return next(p for p in self.points(scene) if p["setting"] == setting)

    def label(self, measure):
        return f"{measure['name']}, {measure['unit']}"

    def plot(self, measure, scene="all", x="ms", **options):
        result = Plot(self.points(scene), x, measure["key"], X_LABELS[x], self.label(measure), log_y=measure["unit"] == "px", **options)
        result.series = self.series
        result.fronts = {"front": self.data["fronts"][measure["key"]]} if scene == "all" and x == "ms" else {}
        result.marked = {self.choice["recommended"]: ""}
        return result

    def main_plot(self, **options):
        result = self.plot(self.main, **options)
        result.fronts["inner"], result.front_names = self.choice["budget_front"], self.fronts()
        result.marked = {self.choice[k]: name for k, name in RINGS.items()}
        return result

    def figure(self):
        """The main plot for documents and papers: it says what it shows and why its recommended setting is where it is."""
        scenes = ", ".join(scene["name"] for scene in self.data["scenes"])
        measured = f"{self.data['machine']['date'][:10]}, one core, {'x'.join(map(str, self.data['size']))} pixels"
        result = self.main_plot(size=(960, 400), legend_px=290, title="What accuracy costs in time: visible error of each setting against its time",
                                about=[f"Mean over the scenes {scenes}. {measured}.", "Points of a line differ in their budget, 1,000 to 100,000 triangles; lower left is better."])
        result.note = f"Recommended: {why_recommended(self)}"
        return result

    def fronts(self):
        return {"front": "Pareto front", "inner": f"of at most {self.data['knob_budget']:,} triangles"}


RINGS = {"most_accurate": "most accurate", "as_accurate": "no less accurate", "fastest": "fastest", "recommended": "recommended"}


def why_recommended(report):
    """And why that is not on the Pareto front, where it is not: what is both faster and more accurate there draws more triangles."""
    budget, recommended, key = report.data["knob_budget"], report.point(report.choice["recommended"]), report.main["key"]
    error, noise = (f"{100 * (report.choice[factor] - 1):.0f} %" for factor in ("near_best", "time_noise"))
    text = (f"a renderer pays for each triangle, so only settings with at most {budget:,} count (dashed line). Of those within {error} of their least error it is the fastest; "
            f"among times within {noise}, which is noise, the plainest.")
    better = [p["triangles"] for p in map(report.point, report.data["fronts"][key]) if p["ms"] < recommended["ms"] and p[key] <= recommended[key] and p["budget"] > budget]
    return text + (f" What beats it on the Pareto front draws {min(better):,.0f} triangles or more." if better else "")


def how_to(setting):
    """The command, and what it has no flags for."""
    flags, _, others = setting["flags"].partition("(")
    return f"<code>{html.escape('occlod render SCENE ' + flags.strip())}</code>" + (f" with {html.escape(others.rstrip(')'))}" if others else "")


CHOICES = {"recommended": "Which setting should I use?", "fastest": "The fastest", "most_accurate": "The most accurate",
           "as_accurate": "No less accurate, any number of triangles"}


ANSWER_HEADER = ["", "setting", "ms a frame", "visible error, px", "triangles", "times the time", "times the error", "drawing on the CPU, ms"]


def answer_rows(report):
    recommended, key = report.point(report.choice["recommended"]), report.main["key"]
    for choice, question in CHOICES.items():
        p = report.point(report.choice[choice])
        compared = [f"{p['ms'] / recommended['ms']:.2f}", f"{p[key] / recommended[key]:.2f}"]
        yield [question, p["setting"], short(p["ms"]), short(p[key]), f"{p['triangles']:,.0f}", *compared, short(p["draw_ms"])]


def answers(report):
    """Everything that the choice of a setting needs, above the first plot."""
    use = how_to(report.settings[report.choice["recommended"]])
    return f"{table(ANSWER_HEADER, answer_rows(report), CHOICES['recommended'])}<p>Use {use}. {rule(report)}</p>"


def break_even_rows(report):
    return break_even.rows(report.points, [s["name"] for s in report.data["scenes"]], report.main["key"], report.data["knob_budget"])


def pays(report):
    """For which renderers occlusion pays, before all else."""
    return (f"<h2>Does occlusion pay?</h2>{table(break_even.HEADER, break_even_rows(report))}<p>Frame to frame, {report.data['knob_budget']:,} triangles with occlusion; "
            "without it as many as leave the same visible error, between two budgets by logarithms. Fewer triangles save a renderer time, and finding out which takes some: "
            "where a triangle costs more than that break-even to draw, shading included, occlusion is the faster way to the same picture; where it costs less, more triangles "
            "without occlusion are. 1 ns a triangle is a thousand million triangles a second.</p>")


def hlod_rows(report):
    return [row for scene in report.data["scenes"] for row in hlod_splits.rows_of(scene["name"], scene)]


def hlods(report):
    return (f"<h2>Splits or an HLOD?</h2>{table(hlod_splits.TITLES, hlod_rows(report))}<p>Frame to frame, {report.data['knob_budget']:,} triangles, occlusion where <code>auto</code> "
            "has it pay; beside it HLODs whose tolerance leaves no larger error of depth. An HLOD draws more triangles and hardly has to think: where a triangle costs a "
            "renderer less than the bound it is the faster way to the same picture. It has no budget that is never exceeded, and its queries take the device time that is "
            "not counted here.</p>")


def rule(report):
    return (f"Recommended: {why_recommended(report)} No knob is turned for nothing. Milliseconds are those of refinement and occlusion on one core, the error is the root "
            "mean square distance from the full mesh.")


def table(header, rows, marked=None):
    head = "".join(f"<th>{html.escape(h)}</th>" for h in header)
    body = "".join(f'<tr{" class=pick" if row[0] == marked else ""}>' + "".join(f"<td>{html.escape(str(c))}</td>" for c in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def within_rows(report):
    """What each step towards accuracy costs."""
    for entry in report.choice["within"]:
        name = entry["setting"]
        if name is None:
            yield [f"≤ {entry['limit']:g} px", "none", "-", "-", "-", "-"]
            continue
        p = report.point(name)
        yield [f"≤ {entry['limit']:g} px", name, short(p["ms"]), short(p[report.main["key"]]), f"{p['triangles']:,.0f}", short(p["draw_ms"])]


WITHIN_HEADER = ["visible error", "fastest setting", "ms", "error px", "triangles", "drawing on the CPU, ms"]


def point_header(report):
    return ["setting", "triangles", "ms", "refine", "occlusion", "draw"] + [report.label(m) for m in report.measures.values()]


def value(x):
    return "-" if x is None else short(x)


def point_rows(report, scene):
    for p in report.points(scene):
        times = [short(p[key]) for key in ("ms", "refine_ms", "occlusion_ms", "draw_ms")]
        yield [p["setting"], f"{p['triangles']:,.0f}", *times, *(value(p[key]) for key in report.measures)]


def knob_rows(report):
    """Each turned knob against the default at the same budget."""
    default = report.point(next(s["name"] for s in report.data["settings"] if s["series"] == report.series[0] and s["budget"] == report.data["knob_budget"]))
    key = report.main["key"]
    yield [default["setting"], "-", short(default["ms"]), short(default[key]), "1.00", "1.00", value(default["wrongly_hidden_px"])]
    for p in report.points():
        if p["series"] == "":
            compared = [f"{p['ms'] / default['ms']:.2f}", f"{p[key] / default[key]:.2f}"]
            yield [p["setting"], p["knob"], short(p["ms"]), short(p[key]), *compared, value(p["wrongly_hidden_px"])]


KNOB_HEADER = ["setting", "knob", "ms", "error px", "times the default's time", "times its error", "wrongly hidden px"]


def data_uri(path, kind):
    return f"data:{kind};base64,{base64.b64encode(path.read_bytes()).decode()}"


def figure(drawn, caption):
    missing = f" ({drawn.missing} settings without a finite number are not shown)" if drawn.missing else ""
    return f"<figure>{drawn.svg()}<figcaption>{html.escape(caption + missing)}</figcaption></figure>"


def pictures(report):
    parts = []
    for scene in report.data["scenes"]:
        shown = [p for p in report.data["pictures"] if p["scene"] == scene["name"]]
        parts.append(f"<h3>{html.escape(scene['name'])}, {html.escape(scene['path'])}, frame {shown[0]['frame']}</h3><div class=pictures>")
        for p in shown:
            caption = "full mesh" if p["setting"] is None else picture_caption(report, p["setting"], scene["name"])
            image = f'<img alt="{html.escape(caption)}" src="{data_uri(report.folder / p["file"], "image/png")}">'
            parts.append(f"<figure>{image}<figcaption>{html.escape(caption)}</figcaption></figure>")
        parts.append("</div>")
    return "".join(parts)


def picture_caption(report, setting, scene):
    p = report.point(setting, scene)
    mark = " (recommended)" if setting == report.choice["recommended"] else ""
    return f"{setting}{mark}: {short(p['ms'])} ms, {short(p[report.main['key']])} px"


def method(report):
    d, m = report.data, report.data["machine"]
    versions = [m["cpu"], f"{m['cores']} cores", m["system"], m["compiler"], m["build"], f"occlod {m['version']}", f"commit {d['commit'] or 'not told'}", m["date"],
                f"{d['seconds']:.0f} s"]
    scenes = (f"{s['name']} ({s['triangles']:,} triangles) along {s['path']}, frames {', '.join(map(str, s['frames']))}" for s in d["scenes"])
    sizes = ["x".join(map(str, d[key])) for key in ("size", "hidden_size")]
    return (f"<p>{html.escape('; '.join(versions))}. Hash of all refinements: <code>{d['hash']}</code>.</p>"
            f"<p>{html.escape('; '.join(scenes))}. Pictures have {sizes[0]} pixels, those that wrongly hidden pixels are counted in {sizes[1]}.</p>"
            f"<p>Each path is walked in {d['bursts']} bursts of {d['burst_frames']} consecutive frames; each frame is refined with every setting before the next "
            "frame is. The first frame of a burst is refined from scratch by all and not timed; the last is compared with the full mesh and, for popping, with the "
            "mesh of the frame before drawn by the same camera. A scene's time is the median of its frames, that of all scenes their geometric mean; errors are "
            "taken over all pictures of all scenes. Occlusion is the software backend's. Times are of one thread of a machine that others use as well: read their "
            "ratios. Drawing, which a GPU does elsewhere, is not in them.</p>")


def measures_list(report):
    return "<dl>" + "".join(f"<dt>{html.escape(report.label(m))}</dt><dd>{html.escape(m['about'])}; {m['better']} is better</dd>" for m in report.measures.values()) + "</dl>"


STABILITY_HEADER = ["guarantee", "with", "without", "unit", "costs", "ratio"]


def stability_rows(report):
    for row in json.loads((report.folder / "stability.json").read_text()):
        with_it, without = row["with"], row["without"]
        yield [row["what"], f"{with_it['way']}: {short(with_it['value'])}", f"{without['way']}: {short(without['value'])}", row["unit"],
               f"{with_it['value'] - without['value']:+.3g}", f"{with_it['value'] / without['value']:.2f}"]


def downloads(report):
    links = [("report.json", "application/json"), ("points.csv", "text/csv"), ("stability.json", "application/json")]
    return "<p>" + " ".join(f'<a download="{name}" href="{data_uri(report.folder / name, kind)}">{name}</a>' for name, kind in links) + "</p>"


def page(report):
    d = report.data
    legend = plot.legend_html(report.series, {"front": "Pareto front"})
    by_triangles = figure(report.plot(report.main, x="triangles"), "what a renderer pays for instead of the time that it took to find out what to draw")
    by_measure = by_triangles + "".join(figure(report.plot(m), m["about"]) for m in report.measures.values() if m is not report.main)
    by_scene = "".join(figure(report.plot(report.main, s["name"]), s["name"]) for s in d["scenes"])
    all_tables = "".join(f"<details><summary>{html.escape(s)}</summary>{table(point_header(report), point_rows(report, s), report.choice['recommended'])}</details>"
                         for s in ["all"] + [s["name"] for s in d["scenes"]])
    small = "<p><strong>This is the small form that tests make: it says nothing about which setting to use.</strong></p>" if d["small"] else ""
    knobs = "".join(f"<dt>{html.escape(k['name'])}</dt><dd>{html.escape(k['about'])}</dd>" for k in d["knobs"])
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width,initial-scale=1"><title>occlod: what accuracy costs in time</title>
<style>{plot.style()}{CSS}</style></head><body>
<h1>What accuracy costs in time</h1>{small}
{pays(report)}{hlods(report)}<h2>Which setting?</h2>{answers(report)}
<div id="main">{report.main_plot(size=(900, 420)).svg()}</div>{plot.legend_html(report.series, report.fronts())}
<h2>What each step costs</h2>{table(WITHIN_HEADER, within_rows(report))}
<h2>Triangles, and other errors</h2><p>The recommended setting is ringed in each; the front is each plot's own. What is less than {plot.FLOOR} px is drawn there. Crosses that are no settings of the command line are never recommended.</p><div class="plots" id="measures">{by_measure}</div>{legend}
<h2>Scene by scene</h2><div class="plots" id="scenes">{by_scene}</div>{legend}
<h2>One knob at a time</h2>{table(KNOB_HEADER, knob_rows(report))}<dl>{knobs}</dl>
<h2>What stability costs</h2><p>That no view culls what it sees because of rounding, that no damaged file is used, and that no occluder hides what is seen, each beside what would be done without: processor time on one planet, from all of it and from near its ground. A refinement to 10,000 triangles looks at some 20,000 nodes.</p>{table(STABILITY_HEADER, stability_rows(report))}
<h2>Side by side</h2><p>The part of each picture where {html.escape(d["pictures"][1]["setting"])} is most wrong, pixel for pixel.</p>{pictures(report)}
<h2>All points</h2>{all_tables}{downloads(report)}
<h2>What is measured</h2>{measures_list(report)}
<h2>How</h2>{method(report)}
<script>{SCRIPT}</script></body></html>
"""


def markdown(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)] + ["| " + " | ".join(map(str, row)) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def tables_as_markdown(report):
    return "\n".join([markdown(break_even.HEADER, break_even_rows(report)), markdown(hlod_splits.TITLES, hlod_rows(report)), markdown(ANSWER_HEADER, answer_rows(report)), markdown(WITHIN_HEADER, within_rows(report)), markdown(KNOB_HEADER, knob_rows(report)), markdown(STABILITY_HEADER, stability_rows(report)),
                      markdown(point_header(report), point_rows(report, "all"))])


def main():
    folder = pathlib.Path(sys.argv[1])
    report = Report(json.loads((folder / "report.json").read_text()), folder)
    (folder / "main_plot.svg").write_text(report.figure().svg(standalone=True) + "\n")
    (folder / "report.md").write_text(tables_as_markdown(report))
    (folder / "report.html").write_text(page(report))
    print(f"{folder / 'report.html'}")


if __name__ == "__main__":
    main()
