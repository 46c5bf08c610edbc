#!/usr/bin/env python3
"""in_environment.py WORK ARGUMENT...: runs Python of the environment that make_environment.py made in WORK. Exit status 77
where there is none: then that test has said why."""
import pathlib
import subprocess
import sys

python = pathlib.Path(sys.argv[1], "env", "bin", "python")
if not python.exists():
    print("SKIPPED: the Python package could not be built: see the test python.wheel")
    sys.exit(77)
sys.exit(subprocess.run([str(python), "-B", *sys.argv[2:]], check=False).returncode)
