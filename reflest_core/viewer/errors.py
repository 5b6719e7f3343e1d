# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a user of the viewer can mend, and the libraries of the extra ``viewer``."""

from __future__ import annotations

import importlib
from typing import Any

from reflest_core.errors import ReflestError


class ViewerError(ReflestError):
    """The viewer cannot do what was asked for; the sentence says why."""


def library(name: str) -> Any:
    """Import a module of the extra ``viewer``.

    Args:
        name: Of the module.

    Raises:
        ViewerError: It is not installed; the sentence has the pip command.
    """
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ViewerError(
            f"the viewer needs {error.name or name}: pip install 'reflest-ros[viewer]'"
        ) from error
