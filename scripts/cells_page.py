#!/usr/bin/env python3
"""cells_page.py FOLDER: makes FOLDER/report.html, one page that needs nothing else, of what scripts/cells_runs.py has left in FOLDER; and all that it shows as
FOLDER/report.json, its tables as FOLDER/report.csv as well."""
import csv
import html
import json
import pathlib
import sys

import cells_parts
import hlod_page
from hlod_document import Html

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "bench/report"))
import plot  # noqa: E402

TITLE = "View cells beside vLOD"


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: cells_page.py FOLDER")
    folder = pathlib.Path(sys.argv[1])
    if not (folder / "about.json").is_file():
        sys.exit(f"cells_page.py: {folder}: has no about.json: run scripts/cells_report.sh")
    results = cells_parts.Results(folder)
    report = {"about": results.about, "parts": cells_parts.all_parts(results)}
    (folder / "report.json").write_text(json.dumps(report, indent=1))
    write_csv(report, folder / "report.csv")
    (folder / "report.html").write_text(page(report, folder))
    print(folder / "report.html")


def tables_of(report):
    return [item for part in report["parts"] for item in part["items"] if "table" in item]


def write_csv(report, file):
    """A line for each value: its table, row and column."""
    with file.open("w", newline="") as opened:
        writer = csv.writer(opened, lineterminator="\n")
        writer.writerow(["table", "row", "column", "title", "value"])
        for table in tables_of(report):
            for i, row in enumerate(table["rows"]):
                writer.writerows([table["table"], i, j, title, value] for j, (title, value) in enumerate(zip(table["titles"], row)))


def page(report, folder):
    document = Html()
    for part in report["parts"]:
        document.heading(part["title"])
        add_items(document, part["items"])
    downloads = " ".join(f'<a download="{name}" href="{hlod_page.page.data_uri(folder / name, kind)}">{name}</a>' for name, kind in (("report.json", "application/json"), ("report.csv", "text/csv")))
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width,initial-scale=1"><title>occlod: {TITLE}</title>
<style>{plot.style()}{hlod_page.CSS}</style></head><body>
<h1>{TITLE}</h1>{about(report["about"])}
{document.contents()}
{document}
<h2>Everything shown</h2><p>{downloads}</p>
</body></html>
"""


def about(told):
    rough = ""
    if told["small"]:
        rough = "<p><strong>This is the small form that tests make, of tiny scenes: its figures say nothing.</strong></p>"
    elif told["quick"]:
        rough = "<p><strong>Quick: small scenes, rough figures.</strong></p>"
    line = "; ".join(html.escape(part) for part in (told["date"], told["machine"], f"commit {told['commit']}"))
    return (f"{rough}<p>{line}. What Chhugani and others printed in <em>vLOD</em> (2003), “the paper”, and what ours measured in the same places. Times are processor time of one "
            "thread unless told otherwise, of a machine that others use as well: read their ratios.</p>")


def add_items(document, items):
    """Plots that follow one another stand side by side."""
    plots = []
    for item in [*items, {}]:
        if "plot" in item:
            plots.append(figure(item))
            continue
        if plots:
            document.add(f'<div class="plots">{"".join(plots)}</div>')
            plots = []
        if "text" in item:
            document.text(item["text"])
        elif "table" in item:
            document.table(item["titles"], [shown_row(item, i) for i in range(len(item["rows"]))])


def figure(told):
    return hlod_page.figure(plot.Lines(told["lines"], told["x"], told["y"], dots=told["dots"], log_y=told["log"]), told["caption"])


def shown_row(table, i):
    row = table["rows"][i]
    digits = table["digits"] or [None, None] + [table["row_digits"][i]] * (len(row) - 2)
    return [shown(value, places) for value, places in zip(row, digits)]


def shown(value, digits):
    if value is None:
        return "-"
    return f"{value:,.{digits}f}" if digits is not None and not isinstance(value, str) else str(value)


if __name__ == "__main__":
    main()
