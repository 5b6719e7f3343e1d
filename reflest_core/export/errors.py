# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What can go wrong when a material or a light is handed on."""

from pathlib import Path

from reflest_core.errors import ReflestError


class ExportError(ReflestError):
    """The estimate or the light cannot be exported, or not in this form."""


def check_suffix(path: Path, suffix: str, format_name: str) -> None:
    """Refuse a ``path`` that readers would take for another format."""
    if path.suffix.lower() != suffix:
        raise ExportError(f"{path} must end in {suffix} for the format {format_name}")
