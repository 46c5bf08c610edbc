#!/usr/bin/env python3
"""notebooks.py FOLDER: writes the examples of the Python package as notebooks into FOLDER. Their source are the scripts of
python/examples, which editors and Jupyter with jupytext open as notebooks too: "# %%" begins a cell."""
import json
import pathlib
import re
import sys

EXAMPLES = pathlib.Path(__file__).resolve().parents[1] / "python" / "examples"


def cell_of(kind, text):
    """`kind`: what follows "# %%" in its line."""
    text = text.strip()
    if "[markdown]" in kind:
        return {"cell_type": "markdown", "metadata": {}, "source": text.strip('"').strip()}
    return {"cell_type": "code", "metadata": {}, "execution_count": None, "outputs": [], "source": text}


def notebook_of(script):
    """A notebook of the format 4.4, as a dictionary."""
    _, *parts = re.split(r"^# %%(.*)\n", script, flags=re.M)
    cells = [cell_of(kind, text) for kind, text in zip(parts[::2], parts[1::2])]
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    return {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 4}


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for example in sorted(EXAMPLES.glob("*.py")):
        path = folder / f"{example.stem}.ipynb"
        path.write_text(json.dumps(notebook_of(example.read_text(encoding="utf-8")), indent=1) + "\n", encoding="utf-8")
        print(path)


if __name__ == "__main__":
    main()
