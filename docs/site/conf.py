# SPDX-License-Identifier: BSD-3-Clause
"""The site of the manual: the pages of docs/ and the C API from Doxygen's XML. Built by scripts/docs.sh, which sets
OTG_DOCS_XML."""
import importlib.util
import os
import pathlib
import re

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
HEADERS = ROOT / "ode_trimesh_gpu" / "include" / "ode_trimesh_gpu"

version_header = (HEADERS / "version.h").read_text()
project = "ode_trimesh_gpu"
copyright = "the authors of ode_trimesh_gpu, BSD-3-Clause"
release = ".".join(re.search(r"VERSION_%s (\d+)" % part, version_header).group(1)
                   for part in ("MAJOR", "MINOR", "PATCH"))

extensions = ["myst_parser", "breathe"]
root_doc = "index"
exclude_patterns = ["README.md", "site", "scenes", "pictures"]
nitpicky = True
# Types of C, of ODE, and what stands for them.
nitpick_ignore_regex = [(r"c:identifier|cpp:identifier|c:struct", r"(d\w+|size_t|std|uint\w+|u?int\w+_t|otg)"),
                        # Doxygen takes a name of a header for a link to its listing.
                        (r"std:ref|ref", r"\w+_8h(pp)?_source"),
                        (r"cpp:.*", r"(std(::\w+)*|d[A-Z]\w+)"), (r"c:.*", r"(std::\w+|\w+_t)")]
suppress_warnings = ["myst.header"]

myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence"]
breathe_projects = {"c": os.environ["OTG_DOCS_XML"]}
breathe_default_project = "c"
breathe_domain_by_extension = {"h": "c", "hpp": "cpp"}
breathe_show_include = False

# Examples in Python, where the package and matplotlib can be imported (pip install into build/docs/venv):
# sphinx-gallery runs them.
gallery = HERE.parent / "gallery"
exclude_patterns.append("gallery")
if all(importlib.util.find_spec(name) for name in ("ode_trimesh_gpu", "matplotlib")):
    extensions.append("sphinx_gallery.gen_gallery")
    sphinx_gallery_conf = {"image_scrapers": ("matplotlib",), "reset_modules": ("matplotlib",),
                           "examples_dirs": str(gallery), "gallery_dirs": "gallery_pages", "filename_pattern": "/",
                           "abort_on_example_error": True, "download_all_examples": False, "show_memory": False}

html_theme = "furo"
html_title = "ode_trimesh_gpu " + release
html_show_sphinx = False
html_theme_options = {"light_css_variables": {"color-brand-primary": "#a4380b", "color-brand-content": "#a4380b"},
                      "dark_css_variables": {"color-brand-primary": "#f08a4b", "color-brand-content": "#f08a4b"}}
html_static_path = ["static"]
html_css_files = ["site.css"]


def point_out_of_the_manual(app, docname, source):
    """Links to folders and to files beside docs/ become names: the site does not hold them."""
    folder = pathlib.Path(app.env.doc2path(docname)).parent

    def replace(match):
        text, target = match.group(1), match.group(2).split("#")[0]
        if re.match(r"[a-z]+:", target) or not target:
            return match.group(0)
        path = (folder / target).resolve()
        inside = path.is_relative_to(HERE.parent) and path.is_file() and path != HERE.parent / "README.md"
        if inside:
            return match.group(0)
        name = "`%s`" % (path.relative_to(ROOT) if path != ROOT else "ode_trimesh_gpu")
        plain = text.strip("`")
        return name if plain in target or plain in str(path) else "%s (%s)" % (text, name)

    if docname == "index":
        pages = "gallery_pages/index" if "sphinx_gallery.gen_gallery" in app.config.extensions else ""
        source[0] += "\n```{toctree}\n:caption: Python\n:maxdepth: 1\n\npython\n%s\n```\n" % pages
    if docname in ("results/README", "lab/README"):
        source[0] += "\n```{toctree}\n:hidden:\n:glob:\n*\n```\n"
    source[0] = re.sub(r"(?<!!)\[([^\]]+)\]\(([^)\s]+)\)", replace, source[0])


def setup(app):
    app.connect("source-read", point_out_of_the_manual)
