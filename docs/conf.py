# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Sphinx' configuration; `make docs` builds the site into build/site."""

import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from reflest_core import __version__  # noqa: E402

project = "reflest"
author = "The reflest developers"
copyright = "2026, The reflest developers"
version = release = __version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["figures"]
html_theme = "furo"
html_title = f"reflest {release}"

myst_heading_anchors = 3
autodoc_member_order = "bysource"
autodoc_typehints = "none"
autodoc_mock_imports = ["torch", "mitsuba", "drjit"]
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True


def _repository_links(app: object, docname: str, source: list[str]) -> None:
    """Leave links to files outside docs/ as text: the site does not hold them."""
    import re

    def outside(match: re.Match[str]) -> str:
        text, target = match.groups()
        path = (Path(__file__).parent / docname).parent / target.split("#")[0]
        inside = Path(__file__).parent.resolve() in path.resolve().parents
        if inside or not path.exists():
            return match.group(0)
        return f"{text} (`{path.resolve().relative_to(ROOT)}`)"

    source[0] = re.sub(r"\[([^\]]+)\]\(((?!https?:)\.\.[^)\s]*)\)", outside, source[0])


def setup(app: object) -> None:
    """Register what this file adds to Sphinx."""
    app.connect("source-read", _repository_links)  # type: ignore[attr-defined]
