#!/usr/bin/env python3
"""Every Markdown file: links that lead somewhere, lines of at most 100 columns, pages that an index lists, commands of benchmarks that exist."""
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
MAX_COLUMNS = 100
MAX_BENCHMARK_LINES = 150
MAX_README_LINES = 120
MAX_WORDS = 40_000  # over all documents
SOURCES = ("bench", "cmake", "python", "examples", "lib", "scripts", "tests", "tools", "viewer", "packaging")

LINK = re.compile(r"\]\(([^)\s]+)\)")
MENTION = re.compile(r"\bdocs/[\w/.-]+\.(?:md|py|txt|png|svg)\b")


def markdown_files():
    folders = [ROOT, *(path for path in ROOT.iterdir() if path.is_dir() and path.name not in ("build", "out"))]
    found = set(ROOT.glob("*.md"))
    for folder in folders[1:]:
        found.update(path for path in folder.rglob("*.md") if ".git" not in path.parts)
    return sorted(found)


def anchors(text):
    """The names that GitHub gives to headings."""
    for heading in re.findall(r"^#+ (.+)$", text, flags=re.M):
        plain = re.sub(r"[^\w\s-]", "", re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)).strip().lower()
        yield plain.replace(" ", "-")


def prose(text):
    """(number, line) of what is wrapped: no code, no tables, no lines of one long word or link."""
    fenced = False
    for number, line in enumerate(text.split("\n"), 1):
        if line.startswith("```"):
            fenced = not fenced
        elif not fenced and not line.startswith(("|", "    ", "!")) and len(line.split()) > 1:
            yield number, line


class Markdown(unittest.TestCase):
    def test_links_lead_somewhere(self):
        broken = []
        for path in markdown_files():
            text = path.read_text(encoding="utf-8")
            for link in LINK.findall(re.sub(r"```.*?```", "", text, flags=re.S)):
                if re.match(r"[a-z]+:", link):
                    continue
                file, _, anchor = link.partition("#")
                target = (path.parent / file).resolve() if file else path
                is_heading = target.exists() and (
                    not anchor or (target.suffix == ".md" and anchor in anchors(target.read_text(encoding="utf-8"))))
                if not is_heading:
                    broken.append(f"{path.relative_to(ROOT)}: {link}")
        self.assertEqual(broken, [])

    def test_sources_name_pages_that_exist(self):
        broken = []
        files = [path for name in SOURCES for path in (ROOT / name).rglob("*") if path.is_file()]
        for path in [*files, *ROOT.glob("*.md"), *ROOT.glob("*.txt"), *(ROOT / ".ci").glob("*"), *(ROOT / ".github").rglob("*.yml")]:
            if path.is_file() and path.suffix in (".h", ".cpp", ".py", ".sh", ".cmake", ".txt", ".json", ".md", ".yml", ""):
                for mention in MENTION.findall(path.read_text(encoding="utf-8", errors="replace")):
                    if not (ROOT / mention).exists() and not mention.startswith("docs/reference/"):
                        broken.append(f"{path.relative_to(ROOT)}: {mention}")
        self.assertEqual(broken, [])

    def test_prose_is_wrapped(self):
        # Not .github: its templates become comments, in which line breaks are kept.
        files = [path for path in markdown_files() if path.relative_to(ROOT).parts[0] != ".github"]
        long_lines = [f"{path.relative_to(ROOT)}:{number}: {len(line)} columns" for path in files
                      for number, line in prose(path.read_text(encoding="utf-8")) if len(line) > MAX_COLUMNS]
        self.assertEqual(long_lines, [])

    def test_every_page_is_listed(self):
        listed = set()
        for index in (ROOT / "docs").rglob("index.md"):
            listed.update((index.parent / link).resolve() for link in LINK.findall(index.read_text(encoding="utf-8")))
        pages = set((ROOT / "docs").rglob("*.md")) - {ROOT / "docs" / "index.md"}
        self.assertEqual(sorted(str(page.relative_to(ROOT)) for page in pages - listed), [])

    def test_every_public_header_is_listed(self):
        index = (ROOT / "docs" / "reference" / "index.md").read_text(encoding="utf-8")
        headers = (ROOT / "lib" / "include").rglob("*.h")
        self.assertEqual(sorted(str(path) for path in headers if f"({'../../' + str(path.relative_to(ROOT))})" not in index), [])

    def test_benchmark_pages_are_short(self):
        lengths = {path.name: len(path.read_text(encoding="utf-8").split("\n")) - 1 for path in (ROOT / "docs" / "benchmarks").glob("*.md")}
        self.assertEqual({name: length for name, length in lengths.items() if length > MAX_BENCHMARK_LINES}, {})

    def test_benchmark_pages_name_commands_that_exist(self):
        build_files = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "bench").rglob("CMakeLists.txt"))
        missing = []
        for path in sorted((ROOT / "docs" / "benchmarks").glob("*.md")):
            text = path.read_text(encoding="utf-8")
            missing += [f"{path.name}: {script}" for script in re.findall(r"\bscripts/\w+\.(?:sh|py)\b", text) if not (ROOT / script).exists()]
            missing += [f"{path.name}: {program}" for program in re.findall(r"`(bench_\w+)", text)
                        if not re.search(rf"\({program}\s+[\w./]+\.cpp", build_files)]
        self.assertEqual(missing, [])

    def test_no_merge_was_left_unfinished(self):
        found = [f"{path.relative_to(ROOT)}:{number}" for path in markdown_files()
                 for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1) if line.startswith(("<<<<<<< ", ">>>>>>> "))]
        self.assertEqual(found, [])

    def test_documents_stay_short(self):
        self.assertLessEqual(len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()), MAX_README_LINES)
        words = sum(len(path.read_text(encoding="utf-8").split()) for path in markdown_files())
        self.assertLessEqual(words, MAX_WORDS)


if __name__ == "__main__":
    sys.exit(unittest.main())
