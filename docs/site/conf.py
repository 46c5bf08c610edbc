"""Sphinx reads docs/ as it is on GitHub. What only the site needs is added here while it reads:
tables of contents from the lists of links in index pages, and a page of the reference for every public header.
scripts/docs.sh sets OCCLOD_DOXYGEN_XML."""
import os
import re

project = "occlod"
author = "the occlod authors"
copyright = "the occlod authors, MIT licence"
extensions = ["breathe", "myst_parser"]
exclude_patterns = ["site"]
source_suffix = {".md": "markdown"}
root_doc = "index"

html_theme = "furo"
html_title = "occlod"
html_show_sphinx = False
html_copy_source = False
html_theme_options = {"navigation_with_keys": True}

myst_heading_anchors = 4
highlight_language = "none"
primary_domain = "cpp"

breathe_projects = {"occlod": os.environ["OCCLOD_DOXYGEN_XML"]}
breathe_default_project = "occlod"
breathe_show_include = False

HEADER_LINK = re.compile(r"\]\((?:\.\./)+lib/include/occlod/([\w/]+)\.h\)")


def contents(text):
    """Hidden tables of contents: one for each heading, of the pages that the items of its lists begin with."""
    tables = []
    for part in re.split(r"^## ", text, flags=re.M):
        caption = part.split("\n", 1)[0]
        pages = re.findall(r"^[-|] \[[^\]]*\]\(([\w./-]+)\.md\)", part, flags=re.M)
        if pages:
            title = "" if caption.startswith("#") else f":caption: {caption}\n"
            tables.append("\n```{toctree}\n:hidden:\n" + title + "\n" + "\n".join(pages) + "\n```\n")
    return "".join(tables)


def add_what_the_site_needs(app, page, source):
    depth = page.count("/")
    text = HEADER_LINK.sub(lambda link: f"]({'../' * depth}reference/{link.group(1)}.md)", source[0])
    if page.endswith("index"):
        text += contents(text)
    source[0] = text


def setup(app):
    app.connect("source-read", add_what_the_site_needs)
