"""What the tables of HLODs are written to: headings, texts and tables, as Markdown or as HTML."""
import html


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
        self.parts = []

    def heading(self, text):
        self.parts.append(f"<h2>{inline(text)}</h2>")

    def text(self, text):
        self.parts.append(f"<p>{inline(text)}</p>")

    def table(self, titles, rows):
        head = "".join(f"<th>{inline(title)}</th>" for title in titles)
        body = "".join("<tr>" + "".join(cell(value) for value in row) + "</tr>" for row in rows)
        self.parts.append(f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>")

    def add(self, part):
        """HTML as it is, such as a figure."""
        self.parts.append(part)

    def __str__(self):
        return "\n".join(self.parts)


VERDICTS = {"met": "met", "**missed**": "missed"}


def cell(value):
    kind = VERDICTS.get(str(value))
    return f'<td class="{kind}">{inline(str(value))}</td>' if kind else f"<td>{inline(str(value))}</td>"


def inline(text):
    for mark, tag in (("**", "strong"), ("`", "code")):
        parts = html.escape(text, quote=False).split(mark) if mark == "**" else text.split(mark)
        text = "".join(f"<{tag}>{part}</{tag}>" if i % 2 else part for i, part in enumerate(parts)) if len(parts) % 2 else mark.join(parts)
    return text
