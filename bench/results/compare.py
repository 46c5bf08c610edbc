#!/usr/bin/env python3
"""Compares the raw tables of two dates: prints every figure that differs by more than a percentage, and every changed hash or text.

compare.py OLD NEW [--percent P] [TABLE ...]   OLD and NEW are folders beside this file, or paths; P is 10 unless given;
                                               only the tables named, without .csv, or all that both dates have
Rows are matched by their keys: the columns of KEYS that a table has. Exits with 0 whatever differs: times vary by machine.
"""
import argparse
import csv
import pathlib
import sys

KEYS = ("scene", "place", "cell_edge", "max_motion", "way", "path", "mesh", "view", "culling", "occlusion", "mode", "method",
        "openmesh_build", "backend", "settings", "setting", "variant", "bound", "target", "tool", "threads", "level", "budget",
        "to_triangles", "degrees_per_frame", "what", "row", "run", "within", "tolerance_px", "strategy", "device",
        "columns", "order", "boxes", "size", "limit_mib", "renderer", "input")
# In these tables the number of triangles is what was asked for, not a result.
TRIANGLES_ARE_A_KEY = ("software_draw", "software_total", "software_found", "scratch")


def read_table(path):
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    columns = rows[0].keys() if rows else ()
    keys = [column for column in columns if column in KEYS or (column == "triangles" and path.stem in TRIANGLES_ARE_A_KEY)]
    return {tuple(row[key] for key in keys): {column: value for column, value in row.items() if column not in keys} for row in rows}


def change(old, new, percent):
    """What to print about two values, or None."""
    if old == new:
        return None
    try:
        before, after = float(old), float(new)
    except ValueError:
        return f"{old or '-'} -> {new or '-'}"
    if before == 0:
        return f"{old} -> {new}"
    difference = 100 * (after - before) / abs(before)
    return f"{old} -> {new} ({difference:+.0f} %)" if abs(difference) > percent else None


def compare(old, new, percent):
    """Lines about two tables that read_table() returned."""
    for key in old.keys() | new.keys():
        name = " ".join(part or "-" for part in key)
        if key not in new or key not in old:
            yield f"{name}: only in the {'old' if key in old else 'new'} table"
            continue
        for column in old[key].keys() & new[key].keys():
            text = change(old[key][column], new[key][column], percent)
            if text:
                yield f"{name}: {column} {text}"


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("tables", nargs="*")
    parser.add_argument("--percent", type=float, default=10)
    options = parser.parse_args(arguments)
    here = pathlib.Path(__file__).resolve().parent
    folders = [here / name if (here / name).is_dir() else pathlib.Path(name) for name in (options.old, options.new)]
    for folder in folders:
        if not folder.is_dir():
            parser.error(f"{folder} is no folder; the dates are {', '.join(sorted(path.name for path in here.iterdir() if path.is_dir()))}")
    shared = sorted({path.stem for path in folders[0].glob("*.csv")} & {path.stem for path in folders[1].glob("*.csv")})
    for table in shared:
        if options.tables and table not in options.tables:
            continue
        lines = sorted(compare(*(read_table(folder / f"{table}.csv") for folder in folders), options.percent))
        print(f"{table}: {'no difference' if not lines else f'{len(lines)} differences'}")
        for line in lines:
            print(f"  {line}")
    if not shared:
        print("no table is in both")


if __name__ == "__main__":
    main(sys.argv[1:])
