# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Scan files of older versions as the newest would hold them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.light.light_map import LightMap

Arrays = dict[str, NDArray[Any]]


def upgraded(header: dict[str, Any], arrays: Arrays) -> tuple[dict[str, Any], Arrays]:
    """Header and arrays of the newest version; ``KeyError`` where the file is damaged.

    Version 3 did not tell in which channel the light was clipped: in all, then. Version 2 knew one
    exposure only, and its first files no light.
    """
    if header["version"] == 2:
        empty = {f"light_{name}": array for name, array in LightMap().arrays.items()}
        arrays = empty | arrays
        arrays["light_white"] = (arrays["light_count"] > 0.0).astype(np.float32)
        arrays["views_gains"] = np.ones(len(arrays["views_stamps"]), np.float32)
        header = header | {"exposure_gain": 1.0}
    if header["version"] < 4 and arrays["light_clipped_count"].ndim == 2:
        of_any = arrays["light_clipped_count"][..., None]
        arrays = arrays | {"light_clipped_count": np.repeat(of_any, 3, axis=-1)}
    return header, arrays
