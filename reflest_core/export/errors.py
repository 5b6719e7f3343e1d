# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What can go wrong when a material is handed on."""

from reflest_core.errors import ReflestError


class ExportError(ReflestError):
    """The estimate cannot be exported, or not in this form."""
