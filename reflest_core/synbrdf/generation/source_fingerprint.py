# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which code made a file: a hash of the sources that decide its bytes."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

import reflest_core

PARTS = ("brdf", "synbrdf")


@cache
def source_fingerprint(parts: tuple[str, ...] = PARTS) -> str:
    """SHA-256 (hex) over the Python files of ``parts``, by name, as this process found them.

    ``parts``: files and folders in ``reflest_core``; by default those that make a data set.

    Args:
        parts: files and folders of ``reflest_core``.
    """
    root = Path(reflest_core.__file__).parent
    digest = hashlib.sha256()
    for path in sorted(path for part in parts for path in _files(root / part)):
        digest.update(f"{path.relative_to(root).as_posix()}\0".encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def _files(part: Path) -> list[Path]:
    return list(part.rglob("*.py")) if part.is_dir() else [part]
