"""The site of the documentation: the Markdown of this repository as it stands, read by Sphinx.

Hosts of repositories show the same files, so these have no directives: contents come from the links of index
pages, and the Python blocks of tutorials become cells.
"""

from __future__ import annotations

import re
import sys
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sphinx.application import Sphinx

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]

project = PROJECT["name"]
version = release = PROJECT["version"]
copyright = f"its authors, {PROJECT['license']} licence"

root_doc = "docs/README"
include_patterns = ["*.md", "docs/**.md", "fmus/*/README.md"]
exclude_patterns = [".*", "build", "results"]
extensions = [
    "myst_nb", "sphinx.ext.autodoc", "sphinx.ext.mathjax", "sphinx.ext.viewcode", "sphinx-mathjax-offline",
]  # fmt: skip

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
nb_execution_mode = "cache"
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 600

default_role = "code"  # docstrings write `name`
smartquotes = False  # and "texts" of code
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"

html_theme = "pydata_sphinx_theme"
html_title = "tribocosim"
html_theme_options = {"header_links_before_dropdown": 7, "show_prev_next": False}
html_sidebars = {f"docs/{page}": [] for page in ("gallery", "faq", "comparison")}
html_copy_source = html_show_sourcelink = False

SECTIONS = ["tutorials", "how-to", "reference", "theory", "checks"]
INDEXES = [*(f"docs/{section}/README" for section in SECTIONS), "docs/reference/components"]
# Relative to docs/, or to the root.
TOP = [
    *(f"{section}/README" for section in SECTIONS),
    "gallery",
    "faq",
    "comparison",
    "Install </README>",
    "/CONTRIBUTING",
    "/CHANGELOG",
]
CELLS = '---\nfile_format: mystnb\nkernelspec: {name: "python3", display_name: "Python"}\n---\n'


def prepare(app: Sphinx, name: str, source: list[str]) -> None:
    """Give index pages their contents, and tutorials their cells."""
    if name in INDEXES or name == root_doc:
        linked = TOP if name == root_doc else re.findall(r"\]\(([^)#]+\.md)\)", source[0])
        source[0] += "\n```{toctree}\n:hidden:\n" + "\n".join(dict.fromkeys(linked)) + "\n```\n"
    if name.startswith("docs/tutorials/") and "import tribocosim" in source[0]:
        source[0] = CELLS + source[0].replace("```python\n", "```{code-cell} python\n")


def set_equations(
    app: Sphinx, kind: str, name: str, thing: object, options: object, lines: list[str]
) -> None:
    """Docstrings are plain text: indented equations stay as they are, and |x| is an absolute value."""
    for i, line in enumerate(lines):
        if line.endswith(":") and [following[:4].strip() for following in lines[i + 1 : i + 3]] == ["", ""]:
            lines[i] = line + ":"
        elif not line.startswith("    "):
            lines[i] = line.replace("|", r"\|")


def setup(app: Sphinx) -> None:
    app.connect("source-read", prepare)
    app.connect("autodoc-process-docstring", set_equations)
