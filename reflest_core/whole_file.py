# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A result's file, written whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path

from reflest_core.errors import ReflestError


class OutputError(ReflestError):
    """A result cannot be written where it was asked for."""


def write_whole(path: Path, content: bytes) -> None:
    """Write beside ``path``, then rename: a reader finds the old file or the new one.

    Raises:
        OutputError: with the system's reason.
    """
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    try:
        partial.write_bytes(content)
        partial.replace(path)
    except OSError as error:
        partial.unlink(missing_ok=True)
        raise OutputError(f"cannot write {path}: {error.strerror}") from error
