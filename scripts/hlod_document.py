"""What the tables of HLODs are written to: headings, texts and tables, as Markdown or as HTML."""
import html
import re


class Markdown:
    """Printed as it comes."""

    def heading(self, text):
        print(f"## {text}\n")

    def text(self, text):
        print(f"{text}\n")

    def table(self, titles, rows):
        print("| " + " | ".join(titles) + " |")
        print("|" + "---|" * len(titles))
        for row in rows:
            print("| " + " | ".join(map(str, row)) + " |")
        print()


class Html:
    """Collected. Of Markdown's marks, texts and cells may have `code` and **strong**."""

    def __init__(self):
        self.parts, self.headings = [], []

    def heading(self, text):
        self.headings.append(text)
        self.parts.append(f'<h2 id="part{len(self.headings)}">{inline(text)}</h2>')

    def text(self, text):
        self.parts.append(f"<p>{inline(text)}</p>")

    def table(self, titles, rows):
        """Columns of words are set to the left."""
        rows = [list(map(str, row)) for row in rows]
        words = [not all(is_number(row[i]) for row in rows if i < len(row)) for i in range(len(titles))]
        head = "".join(f"<th{kind(is_words)}>{inline(title)}</th>" for title, is_words in zip(titles, words))
        body = "".join("<tr>" + "".join(f"<td{kind(is_words, value)}>{inline(value)}</td>" for value, is_words in zip(row, words)) + "</tr>" for row in rows)
        self.parts.append(f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>")

    def add(self, part):
        """HTML as it is, such as a figure."""
        self.parts.append(part)

    def contents(self):
        return "<nav>" + "".join(f'<a href="#part{i + 1}">{inline(text)}</a>' for i, text in enumerate(self.headings)) + "</nav>"

    def __str__(self):
        return "\n".join(self.parts)


VERDICTS = {"met": "met", "**missed**": "missed"}


def is_number(text):
    return re.fullmatch(r"[-+(]?[\d,.]*[ %()/+\-\d,.]*", text) is not None


def kind(is_words, value=""):
    kinds = [name for name in ("words" if is_words else None, VERDICTS.get(value)) if name]
    return f' class="{" ".join(kinds)}"' if kinds else ""


def inline(text):
    text = html.escape(text, quote=False)
    for mark, tag in (("**", "strong"), ("`", "code")):
        parts = text.split(mark)
        if len(parts) % 2:
            text = "".join(f"<{tag}>{part}</{tag}>" if i % 2 else part for i, part in enumerate(parts))
    return text
