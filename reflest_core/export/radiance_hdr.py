# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Radiance ``.hdr``: an environment in four bytes a pixel (:mod:`reflest_core.light.rgbe`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from reflest_core.light import rgbe

if TYPE_CHECKING:
    from reflest_core.environment.environment_map import EnvironmentMap


def radiance_hdr(environment: EnvironmentMap, note: str) -> bytes:
    """The file, its scan lines without run lengths; ``note`` is a comment of one line.

    Which part was seen does not fit into it.
    """
    height, width = environment.radiance.shape[:2]
    header = (
        f"#?RADIANCE\n# {note}\nSOFTWARE=reflest\nFORMAT=32-bit_rle_rgbe\n"
        f"\n-Y {height} +X {width}\n"
    )
    return header.encode("ascii") + rgbe.encode(environment.radiance).tobytes()
