# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which code made a data set: a hash of the sources that decide its bytes."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

import reflest_core

PARTS = ("brdf", "synbrdf")


@cache
def source_fingerprint() -> str:
    """SHA-256 (hex) over the Python files of :data:`PARTS`, by name, as this process found them."""
    root = Path(reflest_core.__file__).parent
    digest = hashlib.sha256()
    for path in sorted(path for part in PARTS for path in (root / part).rglob("*.py")):
        digest.update(f"{path.relative_to(root).as_posix()}\0".encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()
