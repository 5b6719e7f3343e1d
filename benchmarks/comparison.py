# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Our whole frame against Open3D's integration alone, over the very same frames."""

from __future__ import annotations

from typing import Any

import numpy as np


def compare_with_open3d(path: dict[str, Any], peers: dict[str, Any]) -> dict[str, Any]:
    """Percentiles over the frames that both fused; takes the times by stamp out of both."""
    ours_by_stamp = path.pop("fuse_ms")
    compared: dict[str, Any] = {}
    for name, peer in peers.items():
        theirs_by_stamp = peer.pop("integrate_ms")
        stamps = sorted(set(ours_by_stamp) & set(theirs_by_stamp))
        ours = [ours_by_stamp[stamp] for stamp in stamps]
        theirs = [theirs_by_stamp[stamp] for stamp in stamps]
        compared[name] = {"frames": len(stamps)} | {
            f"p{p}": {
                "fuse_ms": float(np.percentile(ours, p)),
                "open3d_ms": float(np.percentile(theirs, p)),
                "ratio": float(np.percentile(ours, p) / np.percentile(theirs, p)),
            }
            for p in (50, 95)
        }
    return compared
