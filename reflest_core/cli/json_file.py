# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""JSON results, written whole or not at all."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from reflest_core.whole_file import OutputError, write_whole


def check_writable(path: Path) -> None:
    """Raise :class:`OutputError` now rather than after a long run.

    Args:
        path: the file.
    """
    folder = path.absolute().parent
    if not folder.is_dir():
        raise OutputError(f"cannot write {path}: the folder {folder} does not exist")
    if path.is_dir() or not os.access(folder, os.W_OK):
        raise OutputError(f"cannot write {path}: it is a folder or its folder is read-only")


def write_json(path: Path, record: dict[str, Any]) -> None:
    """Write a record. NaN is not JSON: write null (None) for it.

    Args:
        path: the file.
        record: values that JSON has.

    Raises:
        OutputError: with the system's reason.
    """
    text = json.dumps(record, indent=2, allow_nan=False) + "\n"
    write_whole(path, text.encode("utf-8"))
