#!/usr/bin/env python3
"""Writes one Markdown page for each public header, which Breathe fills from Doxygen's XML.

api_pages.py XML_FOLDER OUTPUT_FOLDER  writes OUTPUT_FOLDER/refine/refiner.md for occlod/refine/refiner.h, and so on:
what the header says about itself, its classes, enumerations, functions and constants in the header's order, and the
example that uses most of these.
"""
import pathlib
import re
import sys
from xml.etree import ElementTree

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
DIRECTIVES = {"class": "doxygenclass", "struct": "doxygenstruct", "enum": "doxygenenum", "function": "doxygenfunction",
              "variable": "doxygenvariable", "typedef": "doxygentypedef"}
WITH_MEMBERS = {"class", "struct"}


def text_of(element):
    return "".join(element.itertext()).strip()


def markdown_of(element):
    """Paragraphs of plain text and code, which is all that comment_filter.py leaves."""
    for code in element.iter("computeroutput"):
        code.text = f"`{code.text}`"
    return "\n\n".join(text_of(paragraph) for paragraph in element.iter("para"))


def compounds(xml):
    for path in sorted(xml.glob("*.xml")):
        yield from ElementTree.parse(path).iter("compounddef")


def signature(member):
    types = [text_of(parameter.find("type")) for parameter in member.findall("param")]
    return f"({', '.join(types)})"


def entities(xml):
    """Of every public name at namespace level: header, line, kind, the name that Breathe looks up, the heading."""
    for compound in compounds(xml):
        kind = compound.get("kind")
        name = compound.findtext("compoundname")
        place = compound.find("location")
        if kind in WITH_MEMBERS:
            nested = name.rpartition("::")[0].rpartition("::")[2][:1].isupper()
            if not nested and compound.get("prot") == "public":
                yield place.get("file"), int(place.get("line")), kind, name, name.rpartition("::")[2]
        elif kind == "namespace" and name.startswith("occlod"):
            for member in compound.iter("memberdef"):
                place = member.find("location")
                own = member.findtext("name")
                if member.get("kind") in DIRECTIVES:
                    arguments = signature(member) if member.get("kind") == "function" else ""
                    yield place.get("file"), int(place.get("line")), member.get("kind"), f"{name}::{own}{arguments}", own


def example_of(names):
    """The file of the example in which most of these names occur, the shortest of such; none where none occurs."""
    words = {path: set(re.findall(r"\w+", path.read_text(encoding="utf-8"))) for path in sorted(EXAMPLES.glob("*.cpp"))}
    best = max(words, key=lambda path: (len(words[path] & names), -len(words[path])), default=None)
    return best if best and words[best] & names else None


def page(header, about, found):
    lines = [f"# {header.removeprefix('occlod/')}", "", f'    #include "{header}"', "", about, ""]
    above = None
    for _, _, kind, name, heading in found:
        if heading != above:  # Overloads share one.
            lines += [f"## {heading}", ""]
        above = heading
        lines += [f"```{{{DIRECTIVES[kind]}}} {name}", *([":members:"] if kind in WITH_MEMBERS else []), "```", ""]
    example = example_of({heading for *_, heading in found})
    if example:
        lines += ["## An example", "", f"`examples/{example.name}`:", "", "```cpp", example.read_text(encoding="utf-8").rstrip(), "```", ""]
    return "\n".join(lines)


def main(xml, output):
    about = {}
    for compound in compounds(xml):
        if compound.get("kind") == "file":
            about[compound.find("location").get("file")] = markdown_of(compound.find("detaileddescription"))
    found = sorted(set(entities(xml)))
    for header in about:
        path = output / pathlib.PurePath(header).relative_to("occlod").with_suffix(".md")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(page(header, about[header], [entity for entity in found if entity[0] == header]), encoding="utf-8")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
