"""Sphinx builds the site from these pages, the docstrings, the schema, the commands and the gallery (see README.md)."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from generated_pages import write_pages

import geomkin

project = "geomkin"
author = "the developers of geomkin"
version = release = geomkin.__version__
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "numpydoc",
    "sphinx_click",
    "sphinx_copybutton",
    "sphinx_design",
]
myst_enable_extensions = ["html_image", "colon_fence", "deflist", "attrs_inline"]
myst_heading_anchors = 3
numpydoc_show_class_members = False
autodoc_typehints = "none"
autodoc_member_order = "bysource"
nitpicky = True
# Quotes in TOML stay straight.
smartquotes = False
templates_path = ["_templates"]
html_theme = "pydata_sphinx_theme"
html_title = "geomkin"
html_context = {"default_mode": "auto"}
html_sidebars = {"index": [], "start": [], "how-to": [], "generated/gallery": []}
html_theme_options = {"navbar_align": "left", "show_prev_next": True, "footer_start": [], "footer_end": []}
html_static_path = ["static", "generated/static"]
html_css_files = ["book.css"]
html_js_files = ["moving.js", "book.js"]
html_copy_source = False
html_show_copyright = False


def setup(app):
    """Write the pages that are made from the package and the gallery before Sphinx reads any."""
    write_pages(Path(__file__).parent, Path(app.outdir))
