#!/usr/bin/env python3
"""Runs Doxygen over the public headers, whose comments comment_filter.py hands it; warnings are errors.

run_doxygen.py OUTPUT_FOLDER  writes OUTPUT_FOLDER/xml.
"""
import pathlib
import subprocess
import sys

SITE = pathlib.Path(__file__).resolve().parent
INCLUDE = SITE.parents[1] / "lib" / "include"


def run_doxygen(output):
    settings = (SITE / "Doxyfile").read_text(encoding="utf-8") + f'''
INPUT = "{INCLUDE}"
STRIP_FROM_PATH = "{INCLUDE}"
INPUT_FILTER = "python3 -B '{SITE / "comment_filter.py"}'"
OUTPUT_DIRECTORY = "{output}"
'''
    output.mkdir(parents=True, exist_ok=True)
    subprocess.run(["doxygen", "-"], input=settings, text=True, check=True)


if __name__ == "__main__":
    try:
        run_doxygen(pathlib.Path(sys.argv[1]))
    except subprocess.CalledProcessError:
        sys.exit("run_doxygen: the headers' comments have the errors above")
