# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Mitsuba 3 with a working LLVM, loaded once and only where something is rendered."""

from __future__ import annotations

import importlib.metadata
import os
from types import ModuleType

from reflest_core.errors import ReflestError

VARIANT = "llvm_ad_rgb"


class RendererMissing(ReflestError):
    """The optional renderer is not installed."""


def load_mitsuba() -> ModuleType:
    """Return the ``mitsuba`` module with its variant set to ``llvm_ad_rgb`` (linear Rec. 709).

    Points Dr.Jit at the LLVM of the wheel ``karellen-llvm-core``: with an older system LLVM the
    process would abort. ``DRJIT_LIBLLVM_PATH`` set by the user wins.
    """
    os.environ.setdefault("DRJIT_LIBLLVM_PATH", _llvm_library())
    try:
        import mitsuba
    except ImportError as error:
        raise missing_package("mitsuba") from error
    if mitsuba.variant() != VARIANT:
        mitsuba.set_variant(VARIANT)
    return mitsuba


def _llvm_library() -> str:
    try:
        files = importlib.metadata.files("karellen-llvm-core") or []
    except importlib.metadata.PackageNotFoundError as error:
        raise missing_package("karellen-llvm-core") from error
    # A distribution lists the library and links to it; any name that exists will do.
    candidates = sorted(
        str(file.locate())
        for file in files
        if file.name.startswith("libLLVM") and ".so" in file.name
    )
    for candidate in candidates:
        if os.path.exists(candidate):
            return candidate
    raise missing_package("karellen-llvm-core")


def missing_package(package: str) -> RendererMissing:
    """Make the error that names a package of the extra.

    Args:
        package: its name on PyPI.
    """
    return RendererMissing(
        f"rendering needs the Python package {package}: install it with "
        "pip install 'reflest-ros[synbrdf]'"
    )
