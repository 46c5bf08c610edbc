#!/usr/bin/env python3
"""make_environment.py WORK --with-library PREFIX [--gl 0|1]: builds the wheel against the library installed in PREFIX, installs
it into the empty virtual environment WORK/env, and what its tests need after it. Writes into the folder WORK.
What builds it comes from the package registry, in the versions of requirements.txt, and is kept in WORK/builder.
Exit status 77, with the reason, where that cannot be had. OCCLOD_PYTHON names the Python; without it the one that runs this."""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
REQUIREMENTS = pathlib.Path(__file__).with_name("requirements.txt")


def skip(reason):
    print(f"SKIPPED: {reason}")
    sys.exit(77)


def run(*command, **options):
    done = subprocess.run([str(part) for part in command], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False, **options)
    return done.returncode, done.stdout


def require(*command, **options):
    status, output = run(*command, **options)
    if status != 0:
        sys.exit(f"{' '.join(map(str, command))} failed:\n{output}")
    return output


def pinned(*names):
    lines = (line.split("#")[0].strip() for line in REQUIREMENTS.read_text(encoding="utf-8").splitlines())
    return [line for line in lines if line.split("==")[0] in names]


def install(environment, *packages):
    """From the registry; where it does not answer, nothing can be checked."""
    status, output = run(environment / "bin/python", "-m", "pip", "install", "--disable-pip-version-check", "--retries", "1",
                         "--timeout", "15", "-q", *packages)
    if status != 0:
        skip(f"pip could not install {' '.join(map(str, packages))}: {output.strip().splitlines()[-1] if output.strip() else status}")


def python():
    chosen = os.environ.get("OCCLOD_PYTHON", sys.executable)
    status, output = run(chosen, "-c", "import sys, sysconfig, os, venv, ensurepip; print(sys.version_info >= (3, 10), os.path.exists("
                                       "os.path.join(sysconfig.get_path('include'), 'Python.h')))")
    if status != 0:
        skip(f"{chosen} makes no virtual environments (python3-venv)")
    if output.split() != ["True", "True"]:
        skip(f"{chosen} is older than 3.10 or has no headers (python3-dev)")
    return chosen


def builder(chosen, work):
    """A virtual environment with what builds wheels; made once for each version of the requirements."""
    environment, stamp = work / "builder", work / "builder" / "requirements.txt"
    wanted = f"{chosen}\n{REQUIREMENTS.read_text(encoding='utf-8')}"
    if not stamp.exists() or stamp.read_text(encoding="utf-8") != wanted:
        shutil.rmtree(environment, ignore_errors=True)
        require(chosen, "-m", "venv", environment)
        install(environment, *pinned("scikit-build-core", "nanobind"))
        stamp.write_text(wanted, encoding="utf-8")
    return environment / "bin/python"


def build_wheel(chosen, arguments):
    wheels = arguments.work / "wheel"
    shutil.rmtree(wheels, ignore_errors=True)
    environment = dict(os.environ)
    if shutil.which("ccache"):
        environment.setdefault("CMAKE_CXX_COMPILER_LAUNCHER", "ccache")
    settings = [f"cmake.define.occlod_ROOT={arguments.with_library}", "cmake.define.OCCLOD_PYTHON_INSTALLED=ON",
                f"cmake.define.OCCLOD_PYTHON_GL={arguments.gl}", f"build-dir={arguments.work / 'build'}"]
    command = [builder(chosen, arguments.work), "-m", "pip", "wheel", ROOT, "-w", wheels, "--no-deps", "--no-build-isolation", "-q",
               "--disable-pip-version-check", "--no-cache-dir"]
    for setting in settings:
        command += ["--config-settings", setting]
    require(*command, env=environment)
    (wheel,) = wheels.glob("occlod-*.whl")
    return wheel


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--with-library", type=pathlib.Path, required=True)
    parser.add_argument("--gl", default="0")
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    environment = arguments.work / "env"
    shutil.rmtree(environment, ignore_errors=True)  # first: what fails or is skipped leaves none that is out of date
    chosen = python()
    wheel = build_wheel(chosen, arguments)
    require(chosen, "-m", "venv", environment)
    install(environment, wheel, *pinned("numpy"))
    for module in ("trimesh", "pyvista", "scipy", "distributed", "IPython", "tqdm"):  # the package works in an environment that has nothing but NumPy
        assert run(environment / "bin/python", "-c", f"import {module}")[0] != 0, f"{module} is in an empty environment"
    print(require(environment / "bin/python", "-c", "import occlod; print(occlod.version())").strip(), wheel.name, wheel.stat().st_size, "bytes")
    install(environment, *pinned("trimesh", "pillow", "distributed", "mypy", "nbclient", "ipykernel", "tqdm"))


if __name__ == "__main__":
    main()
