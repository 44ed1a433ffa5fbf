"""How Sphinx builds the site: `sphinx-build -W --keep-going docs build/site`."""

import sys
import tomllib
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "extensions"))

project = "anet-lumped"
author = "the authors of anet-lumped"
release = tomllib.loads((HERE.parent / "pyproject.toml").read_text(encoding="utf-8"))["project"][
    "version"
]

extensions = [
    "docstrings",
    "mathml",
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
]
exclude_patterns = ["extensions"]
nitpicky = False
default_role = "code"  # what docstrings quote is code
add_module_names = False

myst_enable_extensions = ["dollarmath", "deflist", "colon_fence"]
myst_heading_anchors = 3
math_renderer = "mathml"
html_math_renderer = "mathml"

autodoc_typehints = "none"  # docstrings say what an argument is, with its unit
autodoc_member_order = "bysource"
napoleon_attr_annotations = False
napoleon_google_docstring = False
napoleon_use_param = False
napoleon_use_rtype = False
napoleon_use_ivar = True
napoleon_custom_sections = ["Source", "Sources"]

html_theme = "furo"
html_title = f"anet-lumped {release}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_copyright = False
