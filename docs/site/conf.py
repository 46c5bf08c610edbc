"""Settings of Sphinx, which scripts/docs.sh runs on a copy of docs/.

The pages are written to be read in the repository too. What only a site needs is added while they are read: tables of
contents from the lists and tables of links in index pages. scripts/docs.sh sets OCCLOD_DOXYGEN_XML."""
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
    if page.endswith("index"):
        source[0] += contents(source[0])


def setup(app):
    app.connect("source-read", add_what_the_site_needs)
