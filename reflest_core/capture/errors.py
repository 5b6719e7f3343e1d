# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What can be wrong with a whole capture."""

from __future__ import annotations

from reflest_core.errors import ReflestError


class CaptureError(ReflestError):
    """A capture cannot be opened, or gives no frame at all."""
