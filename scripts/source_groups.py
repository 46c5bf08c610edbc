#!/usr/bin/env python3
"""source_groups.py MOST <TARGETS_AND_SOURCES: which sources of a target can be compiled as one, for cmake/OcclodUnity.cmake.
Lines of the input: a target, a blank, the path of one of its sources. Prints CMake code that names a group for each source
that has company, of at most MOST.

scripts/tidy.py reads sources in groups that are made likewise. Most of the time of both goes to headers of others."""
import collections
import pathlib
import re
import sys

# What stands at the left margin is declared at namespace scope: clang-format does not indent namespaces.
TYPE = re.compile(r"^(?:struct|class|union|enum class|enum|concept|using(?=\s+\w+\s*=))\s+(\w+)", re.M)
TEST = re.compile(r"^(?:TYPED_)?TEST(?:_F|_P)?\((\w+),\s*(\w+)\)", re.M)
VALUE = re.compile(r"^(?!return|using|namespace|typedef|else|friend)[A-Za-z_][\w:<>,&*\[\] ]*?[\w>&*\]] [&*]*((?:\w+::)*~?\w+)(?:\(|\{| =|;|\[)", re.M)
MACRO = re.compile(r"^#\s*define\s+(\w+)", re.M)
IMPORT = re.compile(r"^using [\w:]+::(\w+);", re.M)
CALL = re.compile(r"(?<![.>:\w])([a-z]\w*)\(")  # of a function that is named without its namespace or object
ALONE = re.compile(r"foreach_target\.h|_IMPLEMENTATION\b")  # vector code includes itself
# Many sources have one of their own: a group gives each another name. No header declares a name like that.
RENAMED = {"main", "Options"}
# Functions that take a source's own Options, or other types of their own.
OVERLOADED = {"run", "check", "check_files"}


def declared(text):
    """Names of which a group can have one only."""
    names = {name for pattern in (TYPE, VALUE, MACRO) for name in pattern.findall(text) if "::" not in name}
    return (names - RENAMED - OVERLOADED) | {f"{suite}.{test}" for suite, test in TEST.findall(text)}


def taken_from_others(text):
    """Names of others that one in an anonymous namespace would hide, or that it would clash with."""
    return set(CALL.findall(text)) - OVERLOADED - declared(text) | set(IMPORT.findall(text))


def groups_of(sources, text_of, kind_of, most):
    """Lists of at most `most` sources that can be compiled as one, each of one kind."""
    open_groups, result = {}, []
    for source in sources:
        text = text_of(source)
        if ALONE.search(text):
            result.append([source])
            continue
        names, calls = declared(text), taken_from_others(text)
        candidates = open_groups.setdefault(kind_of(source), [])
        for members, taken, used in candidates:
            if len(members) < most and not names & (taken | used) and not calls & taken:
                members.append(source)
                taken |= names
                used |= calls
                break
        else:
            candidates.append(([source], set(names), set(calls)))
            result.append(candidates[-1][0])
    return result


def main():
    pairs = [line.split(maxsplit=1) for line in sys.stdin.read().splitlines()]
    texts = {path: pathlib.Path(path).read_text(encoding="utf-8") for _, path in pairs}
    # One that two targets compile must not bring others with it.
    shared = {path for path, count in collections.Counter(path for _, path in pairs).items() if count > 1}
    pairs = [pair for pair in pairs if pair[1] not in shared]
    groups = groups_of(pairs, lambda pair: texts[pair[1]], lambda pair: pair[0], int(sys.argv[1]))
    for i, group in enumerate(group for group in groups if len(group) > 1):
        for target, path in group:
            print(f'set_property(SOURCE "{path}" TARGET_DIRECTORY {target} PROPERTY UNITY_GROUP g{i})')


if __name__ == "__main__":
    main()
