# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The base class of every error that a user can cause and correct."""


class ReflestError(Exception):
    """Says in one sentence what was wrong and what to change; no traceback is shown for it."""
