"""Fig. 3 of Guthe, Balazs and Klein 2006: how often boxes are covered, beside how probable p_cov holds it, theirs and ours."""
import csv

import hlod_table4

MODELS = ("printed", "in_scene")
SOURCES = ("ellipsoids", *hlod_table4.SCENES)


def shown(difference):
    return "-" if difference is None else f"{difference:.3f}"


def print_cover(document, results):
    found = results.load_all("cover", SOURCES)
    if not found:
        return
    document.heading("Guthe, Balazs and Klein 2006, fig. 3")
    document.text("How often the box of an object, or of a node, is covered by what is nearer to the eye, beside p_cov as printed and of the part of the image that the scene covers. Random ellipsoids as theirs, "
                  "and the nodes of our scenes; difference: root mean square by c_scr and c_bb.")
    rows = []
    for source, told in found.items():
        objects = sum(cell["objects"] for cell in told["by_coverage"])
        means = [sum(cell["objects"] * cell[key] for cell in told["by_coverage"]) / objects for key in ("hidden", *MODELS)]
        rows.append([source, f"{objects:,.0f}", *(f"{mean:.3f}" for mean in means), *(shown(told["models"][model]["difference"]) for model in MODELS), told["hash"]])
    document.table(["", "boxes", "covered", "as printed", "of the scene", "difference, printed", "of the scene", "hash"], rows)


def write_csv(results):
    """A line for each scene, c_scr and c_bb."""
    rows = [{"scene": source, **cell} for source, told in results.load_all("cover", SOURCES).items() for cell in told["by_coverage"]]
    if rows:
        with open(results.folder / "cover.csv", "w", newline="") as file:
            table = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
            table.writeheader()
            table.writerows(rows)
