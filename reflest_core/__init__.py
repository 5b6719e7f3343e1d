# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""reflest: on-the-fly reflectance estimation, without ROS.

    from reflest_core import Scanner, open_capture, sphere

    scanner = Scanner(region=sphere((0.0, 0.0, 0.12), 0.18))
    for frame in open_capture("captures/glossy-red"):
        scanner.add_frame(frame)
    print(scanner.estimate().rho_d)

Stages, in the order in which data flows and in which they may import one another: ``brdf`` <-
``light`` <- ``surface`` <- ``capture`` <- ``fusion`` <- ``inference`` <- ``segmentation`` <-
``models`` <- ``estimation`` <- ``cli``. ``environment``, ``rendering``, ``export``, ``api``,
``synbrdf``, ``training`` and ``evaluation`` stand beside them.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from reflest_core.api.scanner import Scanner as Scanner
    from reflest_core.api.scanner import box as box
    from reflest_core.api.scanner import sphere as sphere
    from reflest_core.capture.open_capture import open_capture as open_capture
    from reflest_core.errors import ReflestError as ReflestError

__version__ = "0.2.0"
__all__ = ["ReflestError", "Scanner", "__version__", "box", "open_capture", "sphere"]

_HOMES = {
    "Scanner": "reflest_core.api.scanner",
    "ReflestError": "reflest_core.errors",
    "box": "reflest_core.api.scanner",
    "open_capture": "reflest_core.capture.open_capture",
    "sphere": "reflest_core.api.scanner",
}


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used: commands start without what they do not need."""
    if name not in _HOMES:
        raise AttributeError(f"module 'reflest_core' has no attribute {name!r}")
    return getattr(importlib.import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    """List the public names, imported or not yet."""
    return sorted({*globals(), *__all__})
