# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Errors of exporting."""

from pathlib import Path

from reflest_core.errors import ReflestError


class ExportError(ReflestError):
    """The estimate or the light cannot be exported, or not in this form."""


def check_suffix(path: Path, suffix: str, format_name: str) -> None:
    """Refuse a path that readers would take for another format.

    Args:
        path: The file to write.
        suffix: The suffix of the format.
        format_name: The format, for the error.

    Raises:
        ExportError: The path has another suffix.
    """
    if path.suffix.lower() != suffix:
        raise ExportError(f"{path} must end in {suffix} for the format {format_name}")
