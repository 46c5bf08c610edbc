#!/usr/bin/env python3
"""Every class, function, enumeration, constant and field that the public headers offer has a comment.

Prints those that have none, by header and line, and fails. Left out: what C++ gives a meaning of its own (destructors,
copies, moves, assignments, comparisons) and functions that override a documented one. Exits with 77, which CTest shows
as skipped, where Doxygen is missing.
"""
import pathlib
import shutil
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "docs" / "site"))
from api_pages import compounds, text_of  # noqa: E402
from run_doxygen import run_doxygen  # noqa: E402

KINDS = {"function", "variable", "typedef", "enum"}


def is_documented(element):
    return any(text_of(element.find(part)) for part in ("briefdescription", "detaileddescription"))


def speaks_for_itself(member, owner):
    name = member.findtext("name")
    types = [text_of(parameter.find("type")).rstrip("& ").removeprefix("const ") for parameter in member.findall("param")]
    if name.startswith("~") or name in ("operator==", "operator="):
        return True
    if name == owner and (types == [owner] or text_of(member.find("argsstring")).endswith("=default")):
        return True
    return member.find("reimplements") is not None


def undocumented(xml):
    for compound in compounds(xml):
        name = compound.findtext("compoundname")
        is_class = compound.get("kind") in ("class", "struct")
        if not is_class and not (compound.get("kind") == "namespace" and name.startswith("occlod")):
            continue
        if is_class and (compound.get("prot") == "private" or not name.startswith("occlod")):
            continue
        if is_class and not is_documented(compound):
            yield compound.find("location"), name
        for member in compound.iter("memberdef"):
            is_public = member.get("prot") == "public" and member.get("kind") in KINDS
            if is_public and not is_documented(member) and not speaks_for_itself(member, name.rpartition("::")[2]):
                yield member.find("location"), f"{name}::{member.findtext('name')}"


def main():
    if shutil.which("doxygen") is None:
        print("SKIPPED: doxygen is not installed")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        run_doxygen(pathlib.Path(folder))
        missing = sorted((place.get("file"), int(place.get("line")), name)
                         for place, name in undocumented(pathlib.Path(folder) / "xml"))
    for file, line, name in missing:
        print(f"lib/include/{file}:{line - 1}: {name} has no comment")  # The filter adds a line at the top.
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
