# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Imports the libraries of the extras ``asset`` and ``viewer``; a robot need not carry them."""

from __future__ import annotations

import ctypes
import importlib
from typing import Any

from reflest_core.export.errors import ExportError


def library(name: str, extra: str = "asset") -> Any:
    """Import a module of an extra.

    Args:
        name: Of the module.
        extra: What pip calls the extra.

    Raises:
        ExportError: It is not installed; the sentence has the pip command.
    """
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ExportError(
            f"this needs {error.name or name}: pip install 'reflest-ros[{extra}]'"
        ) from error


def open3d() -> Any:
    """Import Open3D, also where the system lacks the libusb-1.0 that it links to.

    The library in the PyPI package ``libusb-package`` is loaded first then.

    Raises:
        ExportError: It is not installed.
    """
    try:
        return importlib.import_module("open3d")
    except ImportError:
        ctypes.CDLL(str(library("libusb_package").get_library_path()), mode=ctypes.RTLD_GLOBAL)
        return library("open3d")
