# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Imports Open3D where the system lacks the libusb-1.0 that it links to (Debian ``libusb-1.0-0``).

The one in the PyPI package ``libusb-package`` is loaded first then.
"""

from __future__ import annotations

import ctypes
import importlib
from typing import Any


def import_open3d() -> Any:
    """The module ``open3d``."""
    try:
        return importlib.import_module("open3d")
    except ImportError:
        libusb_package = importlib.import_module("libusb_package")
        ctypes.CDLL(str(libusb_package.get_library_path()), mode=ctypes.RTLD_GLOBAL)
        return importlib.import_module("open3d")
