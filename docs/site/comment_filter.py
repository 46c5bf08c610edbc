#!/usr/bin/env python3
"""Doxygen input filter: shows the headers' plain // comments to Doxygen as documentation.

comment_filter.py HEADER  writes the header to standard output with
  - the comment at its top as the description of the file,
  - a comment above a declaration as ///, and one behind it, with its continuation lines, as ///<,
  - comments that stand alone (followed by an empty line, a brace or the preprocessor) as they are, and so those above
    a declaration that has another one behind it, since they are headings of groups.
One line is added at the top, so the lines in Doxygen's messages are off by one. Comments are plain text: only `code`
between backticks is markup, everything else that Doxygen would interpret is escaped.
"""
import pathlib
import re
import sys

ESCAPES = {"\\": "\\\\", "@": "\\@", "&": "&amp;", "<": "&lt;", ">": "&gt;", "#": "\\#", "%": "\\%"}


def escape(text):
    return "".join(ESCAPES.get(letter, letter) for letter in text)


def as_doxygen(text):
    """The text of a comment line, as Doxygen markup."""
    if text.startswith("*"):  # Would be a list.
        return "&lowast;" + as_doxygen(text[1:])
    parts = text.split("`")
    if len(parts) % 2 == 0:  # A code span that goes on in the next line: left as it is.
        return escape(text)
    return "".join(f"<code>{escape(part)}</code>" if i % 2 else escape(part) for i, part in enumerate(parts))


def comment_column(line):
    """Where the line's // comment begins outside string and character literals, or -1."""
    for match in re.finditer(r'"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])*\'|//', line):
        if match.group() == "//":
            return match.start()
    return -1


def is_directive(text):
    return text.startswith(("NOLINT", "clang-format"))


def documents_what_follows(lines, index):
    """Whether the first line after the comment block that holds `index` is a declaration."""
    while index < len(lines) and lines[index].lstrip().startswith("//"):
        index += 1
    following = lines[index].strip() if index < len(lines) else ""
    is_heading = comment_column(following) > 0 and not is_directive(following[comment_column(following) + 2:].strip())
    is_declaration = not following.startswith(("#", "}", "namespace", "public:", "private:", "protected:"))
    return bool(following) and is_declaration and not is_heading


def documents_what_precedes(code):
    return not code.rstrip().endswith("{") and not code.lstrip().startswith(("#", "}", "namespace"))


def filtered(source):
    lines = source.split("\n")
    result = []
    trailing_column = None  # Of the comment behind the declaration above, while its continuation may follow.
    for index, line in enumerate(lines):
        column = comment_column(line)
        code, text = line[:column], line[column + 2:].strip()
        if column < 0 or is_directive(text):
            trailing_column = None
            result.append(line)
        elif code.strip():
            trailing_column = column if documents_what_precedes(code) else None
            result.append(line if trailing_column is None else f"{code}///< {as_doxygen(text)}")
        elif column == trailing_column:
            result.append(f"{code}///< {as_doxygen(text)}")
        else:
            trailing_column = None
            at_top = all(above.lstrip().startswith("//") for above in lines[:index])
            if index == 0:
                result.append("/// \\file")
            if at_top or documents_what_follows(lines, index):
                result.append(f"{code}/// {as_doxygen(text)}".rstrip())
            else:
                result.append(line)
    return "\n".join(result)


if __name__ == "__main__":
    sys.stdout.write(filtered(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8")))
