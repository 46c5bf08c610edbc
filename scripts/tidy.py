#!/usr/bin/env python3
"""tidy.py CLANG_TIDY BUILD_DIR [--jobs N] [--fresh] [--list] [--analyze] [--only FILE...]: clang-tidy over our sources that BUILD_DIR compiles, or over
those of the named files and, for a header among them, one that includes it. Exit 1 when it finds something.

Most of clang-tidy's time goes to headers of others, which it parses and searches again for every source. So sources of one
folder are read together: a batch is a source that includes up to 16 of them. What stands in the way (a name that two of them define,
vector code that includes itself) is seen beforehand or when clang says so; such sources are read alone. Missing includes are g++'s to find.

A source that was clean is not read again until something that it is made of differs: its text and that of every header of ours
below it, flags, .clang-tidy files, clang-tidy itself, and size and time of the headers of others that it names. The marks are in
BUILD_DIR/lint; --fresh does without them. --list prints what would be read, and reads nothing. --analyze: the checks of the static
analyser instead, which looks at a source's own functions only; so each is read alone."""
import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import resource
import shlex
import subprocess
import sys

from source_groups import RENAMED, groups_of

ROOT = pathlib.Path(__file__).resolve().parent.parent
BATCH = 16
ANALYZER = "--checks=-*,clang-analyzer-*,-clang-analyzer-optin.*"
INCLUDE = re.compile(r"^\s*#\s*include\s+([<\"])([^>\"]+)[>\"]", re.M)
CLANG_ERROR = re.compile(r"^(?:In file included from )?(/[^:]+):\d+:\d+: (?:fatal )?error: .*\[clang-diagnostic-", re.M)


class Source:
    """A compiled source: its path, the folder whose .clang-tidy rules it, and the flags that matter for reading it."""

    def __init__(self, path, command):
        self.path = path
        self.name = str(path.relative_to(ROOT))
        self.folder = self.name.split("/")[0]
        self.standard, self.flags = "-std=c++20", []
        words = iter(shlex.split(command))
        for word in words:
            if word.startswith(("-D", "-I")):
                self.flags.append((word,))
            elif word == "-isystem":
                self.flags.append((word, next(words)))
            elif word.startswith("-std="):
                self.standard = word
        self.text = path.read_text(encoding="utf-8")

    def search_path(self):
        return [flag[0][2:] for flag in self.flags if flag[0].startswith("-I")] + [flag[1] for flag in self.flags if len(flag) == 2]


def compiled_sources(build_dir):
    found = {}
    for entry in json.loads((build_dir / "compile_commands.json").read_text()):
        path = pathlib.Path(os.path.realpath(os.path.join(entry["directory"], entry["file"])))
        # With OCCLOD_UNITY some of what is compiled includes our sources.
        paths = [pathlib.Path(name) for _, name in INCLUDE.findall(path.read_text())] if path.parent.name == "Unity" else [path]
        for source in paths:
            if source.is_relative_to(ROOT) and not source.is_relative_to(build_dir) and source not in found:
                found[source] = Source(source, entry["command"])
    return [found[path] for path in sorted(found)]


class Fingerprints:
    """For each source a hash of everything that decides what clang-tidy says about it, and the files that it is made of."""

    def __init__(self, clang_tidy, *options):
        version = subprocess.run([clang_tidy, "--version"], capture_output=True, check=True).stdout
        config = b"".join(path.read_bytes() for path in [ROOT / ".clang-tidy", *sorted(ROOT.glob("*/.clang-tidy"))])
        self.base = version + config + repr(options).encode() + pathlib.Path(__file__).read_bytes()
        self.parts = {}

    def part(self, path):
        """The hash of a file's text, or of a foreign header's size and time; the names that a file of ours includes."""
        if path not in self.parts:
            if pathlib.Path(path).is_relative_to(ROOT):
                text = pathlib.Path(path).read_text(encoding="utf-8")
                self.parts[path] = text.encode(), INCLUDE.findall(text)
            else:
                status = os.stat(path)
                self.parts[path] = f"{path} {status.st_size} {status.st_mtime_ns}".encode(), []
        return self.parts[path]

    def of(self, source):
        folders = source.search_path() + ["/usr/include"]
        seen, todo = set(), [str(source.path)]
        hashed = hashlib.sha256(self.base + repr((source.standard, source.flags)).encode())
        while todo:
            path = todo.pop()
            if path in seen:
                continue
            seen.add(path)
            content, includes = self.part(path)
            hashed.update(content)
            for quote, name in includes:
                beside = [os.path.dirname(path)] if quote == '"' else []
                found = next((at for at in (os.path.join(folder, name) for folder in beside + folders) if os.path.isfile(at)), None)
                if found:
                    todo.append(os.path.realpath(found))
        return hashed.hexdigest(), seen


def batches_of(sources):
    """Lists of sources that can be read as one, each of one folder and standard."""
    groups = groups_of(sources, lambda source: source.text, lambda source: (source.folder, source.standard), BATCH)
    return sorted(groups, key=len, reverse=True)


def those_that_read(files, sources, fingerprints):
    """The sources among the files, and for each header that none of them includes the one beside it or the shortest that does."""
    chosen = [source for source in sources if str(source.path) in files]
    made_of = {source: fingerprints.of(source)[1] for source in sources}
    for header in sorted(name for name in files if name.endswith(".h")):
        if any(header in made_of[source] for source in chosen):
            continue
        readers = [source for source in sources if header in made_of[source]]
        if readers:
            chosen.append(min(readers, key=lambda source: (str(source.path.with_suffix(".h")) != header, len(made_of[source]), source.name)))
        else:
            print(f"lint: {os.path.relpath(header, ROOT)} is in no source that is compiled: not checked", file=sys.stderr)
    return chosen


class Reader:
    def __init__(self, clang_tidy, folder, *options):
        self.command = [clang_tidy, "--quiet", *options]
        self.folder = folder

    def run(self, batch):
        """Exit status and output of clang-tidy over one batch."""
        flags = dict.fromkeys([(batch[0].standard,), *(flag for source in batch for flag in source.flags)])
        options, main = [], batch[0].path
        if len(batch) > 1:
            # The batch seems to lie beside its sources, where clang-tidy looks for its configuration.
            name = hashlib.sha256(" ".join(source.name for source in batch).encode()).hexdigest()[:16]
            text, overlay = self.folder / f"{name}.cpp", self.folder / f"{name}.json"
            main = ROOT / batch[0].folder / f"lint_batch_{name}.cpp"
            text.write_text("".join(
                "".join(f"#define {name} {name}{i}  // NOLINT\n" for name in sorted(RENAMED)) + f'#include "{source.path}"\n'
                + "".join(f"#undef {name}\n" for name in sorted(RENAMED)) for i, source in enumerate(batch)))
            overlay.write_text(json.dumps({"version": 0, "roots": [
                {"type": "file", "name": str(main), "external-contents": str(text)}]}))
            options = [f"--vfsoverlay={overlay}"]
        done = subprocess.run([*self.command, *options, str(main), "--", *(word for flag in flags for word in flag), "-Wno-everything"],
                              capture_output=True, text=True, check=False, cwd=ROOT)
        return done.returncode, done.stdout + "\n".join(
            line for line in done.stderr.splitlines() if not re.match(r"\d+ (warnings?|errors?) |Error while processing|Suppressed", line))

    def read(self, batch):
        """The sources of a batch with their verdicts: [(sources, status, output)]."""
        status, output = self.run(batch)
        if status == 0 or len(batch) == 1:
            return [(batch, status, output)]
        refused = set(CLANG_ERROR.findall(output))
        if not refused:
            return [(batch, status, output)]
        alone = [source for source in batch if str(source.path) in refused] or batch
        together = [source for source in batch if source not in alone]
        return [verdict for part in [*([source] for source in alone), together] if part for verdict in self.read(part)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("clang_tidy")
    parser.add_argument("build_dir", type=pathlib.Path)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--fresh", action="store_true")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--analyze", action="store_true")
    parser.add_argument("--only", nargs="+")
    arguments = parser.parse_args()

    build_dir = arguments.build_dir.resolve()
    sources = compiled_sources(build_dir)
    checks = [ANALYZER] if arguments.analyze else []
    fingerprints = Fingerprints(arguments.clang_tidy, *checks)
    if arguments.only:
        sources = those_that_read({os.path.realpath(name) for name in arguments.only}, sources, fingerprints)
    folder = build_dir / "lint"
    (folder / "clean").mkdir(parents=True, exist_ok=True)
    marks = {source: folder / "clean" / fingerprints.of(source)[0] for source in sources}
    todo = [source for source in sources if arguments.fresh or not marks[source].exists()]
    batches = [[source] for source in todo] if arguments.analyze else batches_of(todo)
    if arguments.list:
        print(*(" ".join(source.name for source in batch) for batch in batches), sep="\n")
        return 0

    failed = False
    reader = Reader(arguments.clang_tidy, folder, *checks)
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for verdicts in pool.map(reader.read, batches):
            for batch, status, output in verdicts:
                if status == 0:
                    for source in batch:
                        marks[source].touch()
                else:
                    failed = True
                    print(output, file=sys.stderr)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"lint: {len(sources)} sources, {len(sources) - len(todo)} of them unchanged since they were clean; "
          f"{used.ru_utime + used.ru_stime:.0f} s of processor time", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
