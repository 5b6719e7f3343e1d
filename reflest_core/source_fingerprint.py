# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which code made a file: a hash of a module and of all that it imports from this package."""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from threading import Lock

PACKAGE = "reflest_core"
ROOT = Path(__file__).parent
_ONE_AT_A_TIME = Lock()
"""Python 3.11's parser fails with a SystemError when two threads use it (CPython issue 106905)."""


def imported_sources(*modules: str, root: Path = ROOT) -> list[Path]:
    """Find the source files of modules and of all that they import, directly or through others.

    Imports inside functions count; those for type checkers alone (``if TYPE_CHECKING``) do not.

    Args:
        *modules: Dotted names in this package.
        root: Folder of the package.

    Returns:
        Paths, sorted.

    Raises:
        ValueError: There is no such module.
    """
    waiting, found = list(modules), dict[str, Path]()
    while waiting:
        name = waiting.pop()
        if name in found:
            continue
        path = _path(name, root)
        if path is None:
            raise ValueError(f"{PACKAGE} has no module {name}")
        found[name] = path
        if "." in name:
            waiting.append(name.rpartition(".")[0])  # importing a module runs its packages
        waiting += [
            one
            for one in _imports(_parsed(path))
            if one.split(".")[0] == PACKAGE and _path(one, root) is not None
        ]
    return sorted(found.values())


@cache
def source_fingerprint(*modules: str, root: Path = ROOT) -> str:
    """SHA-256 (hex) over names and bytes of :func:`imported_sources`, as this process found them.

    Args:
        *modules: Dotted names in this package.
        root: Folder of the package.
    """
    digest = hashlib.sha256()
    for path in imported_sources(*modules, root=root):
        digest.update(f"{path.relative_to(root).as_posix()}\0".encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def _path(module: str, root: Path) -> Path | None:
    place = root.joinpath(*module.split(".")[1:])
    for path in (place.with_suffix(".py"), place / "__init__.py"):
        if path.is_file():
            return path
    return None


def _parsed(path: Path) -> ast.AST:
    with _ONE_AT_A_TIME:
        return ast.parse(path.read_text())


def _imports(tree: ast.AST) -> Iterator[str]:
    """Dotted names that may be modules; of ``from a import b`` both ``a`` and ``a.b``."""
    if isinstance(tree, ast.Import):
        yield from (alias.name for alias in tree.names)
    elif isinstance(tree, ast.ImportFrom) and tree.module and not tree.level:
        yield tree.module
        yield from (f"{tree.module}.{alias.name}" for alias in tree.names)
    inner = list(ast.iter_child_nodes(tree))
    if isinstance(tree, ast.If) and _is_type_checking(tree.test):
        inner = list(tree.orelse)
    for node in inner:
        yield from _imports(node)


def _is_type_checking(test: ast.expr) -> bool:
    return (isinstance(test, ast.Name) and test.id == "TYPE_CHECKING") or (
        isinstance(test, ast.Attribute) and test.attr == "TYPE_CHECKING"
    )
