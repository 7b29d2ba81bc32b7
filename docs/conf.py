"""How Sphinx builds the site. `make docs` writes it to `out/docs`; every warning is an error."""

from importlib.metadata import version as installed_version

project = "Hilt"
author = "The Hilt developers"
version = release = installed_version("hilt")
copyright = "2026, the Hilt developers. Apache-2.0"  # noqa: A001 - the name that Sphinx reads

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
exclude_patterns = ["schemas"]
suppress_warnings = [
    "misc.highlighting_failure",  # Pygments knows neither CSV nor RDF 1.2
    "ref.python",  # members of two classes may have one name, as Rule.part and Candidate.part
]

html_theme = "furo"
html_title = "Hilt"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_extra_path = ["schemas"]
html_show_sourcelink = False

myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 3

autodoc_default_options = {"members": True}
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
python_use_unqualified_type_names = True
napoleon_use_ivar = True  # attributes are fields of their class, not targets of links
default_role = "py:obj"  # one backtick in a docstring: code, and a link where it names something

nitpicky = True
nitpick_ignore_regex = [
    ("py:obj", ".*"),  # not every code in a docstring is the name of something public
    ("py:class", ".*"),  # types of other libraries, and ours that are not public
]
linkcheck_timeout = 10
