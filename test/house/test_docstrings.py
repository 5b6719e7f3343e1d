# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Every public name is documented, each argument by its name."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("reflest_core", "reflest_ros")
OWN_WORDS = re.compile(
    r"\b(anew|of ours|gravest|contenders?|is told by|are told by|tells of|tells apart|foretold)\b"
    r"|what a user can turn|made true by|untruth|\b(elsewise|told apart|cannot be told|hangs on)\b",
    re.IGNORECASE,
)
"""Phrases of this project's own for which the field has terms (docs/explanation/glossary.md)."""


def sources():
    return [path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))]


def public_functions(path):
    """Public functions and methods, as (qualified name, node, whether it is a method)."""
    tree = ast.parse(path.read_text())
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            yield node.name, node, False
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            for inner in node.body:
                if isinstance(inner, ast.FunctionDef) and (
                    not inner.name.startswith("_") or inner.name == "__init__"
                ):
                    yield f"{node.name}.{inner.name}", inner, True


def argument_names(node, is_method):
    arguments = [*node.args.posonlyargs, *node.args.args]
    decorators = {getattr(d, "id", getattr(d, "attr", "")) for d in node.decorator_list}
    skip = 1 if is_method and "staticmethod" not in decorators else 0
    return [argument.arg for argument in (*arguments[skip:], *node.args.kwonlyargs)]


def undocumented(path):
    for name, node, is_method in public_functions(path):
        names = argument_names(node, is_method)
        text = ast.get_docstring(node)
        if node.name == "__init__" and text is None and not names:
            continue
        if text is None:
            yield f"{path.relative_to(ROOT)}:{node.lineno} {name} has no docstring"
            continue
        section = re.search(r"^Args:\n((?:[ \t].*\n?|\n)*)", text, re.MULTILINE)
        entries = section.group(1) if section else ""
        described = re.findall(r"^    \*{0,2}(\w+)", entries, re.MULTILINE)
        if missing := [argument for argument in names if argument not in described]:
            yield f"{path.relative_to(ROOT)}:{node.lineno} {name} lacks Args: {', '.join(missing)}"


@pytest.mark.parametrize("package", PACKAGES)
def test_every_argument_of_a_public_function_is_described(package):
    lacking = [
        line
        for path in sources()
        if path.relative_to(ROOT).parts[0] == package
        for line in undocumented(path)
    ]
    assert lacking == []


def texts():
    """What else users read, and the tests; not the research notes, nor this file."""
    for pattern in (
        "config/*.yaml",
        "msg/*.msg",
        "srv/*.srv",
        "*.md",
        "docs/**/*.md",
        "test/**/*.py",
    ):
        for path in sorted(ROOT.glob(pattern)):
            if "research" not in path.parts and path != Path(__file__):
                yield path


def test_the_words_are_the_field_s():
    found = [
        f"{path.relative_to(ROOT)}:{number}: {line.strip()}"
        for path in [*sources(), *texts()]
        for number, line in enumerate(path.read_text().splitlines(), 1)
        if OWN_WORDS.search(line)
    ]
    assert found == []
