"""Settings of the documentation site; `docs/build.py` lays out the pages and builds it."""

from importlib.metadata import version as version_of

project = "rockshed"
author = "the rockshed authors"
copyright = "2026, the rockshed authors"
release = version_of("rockshed")
version = release

extensions = [
    "myst_parser",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx_copybutton",
]
html_theme = "furo"
html_title = "rockshed"
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#7a5230", "color-brand-content": "#7a5230"},
    "dark_css_variables": {"color-brand-primary": "#d8b08c", "color-brand-content": "#d8b08c"},
}

myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence"]

autodoc_default_options = {"members": True, "member-order": "bysource"}
autodoc_typehints = "signature"
autodoc_use_legacy_class_based = False
numpydoc_show_class_members = False
numpydoc_xref_param_type = False
copybutton_prompt_text = ">>> "
