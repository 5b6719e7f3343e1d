"""JSON results, written whole or not at all."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from reflest_core.errors import ReflestError


class OutputError(ReflestError):
    """A result cannot be written where it was asked for."""


def check_writable(path: Path) -> None:
    """Raise :class:`OutputError` now rather than after a long run."""
    folder = path.absolute().parent
    if not folder.is_dir():
        raise OutputError(f"cannot write {path}: the folder {folder} does not exist")
    if path.is_dir() or not os.access(folder, os.W_OK):
        raise OutputError(f"cannot write {path}: it is a folder or its folder is read-only")


def write_json(path: Path, record: dict[str, Any]) -> None:
    """Write beside ``path``, then rename. NaN is not JSON: write null (None) for it.

    Raises:
        OutputError: with the system's reason.
    """
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    try:
        partial.write_text(json.dumps(record, indent=2, allow_nan=False) + "\n", encoding="utf-8")
        partial.replace(path)
    except OSError as error:
        partial.unlink(missing_ok=True)
        raise OutputError(f"cannot write {path}: {error.strerror}") from error
