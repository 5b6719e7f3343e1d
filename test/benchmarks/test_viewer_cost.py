# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a viewer beside the node costs is the share of the frames that it takes away."""

from benchmarks.report.run_sections import viewer_section


def run(fused, redundant):
    return {
        "frames_fused": fused,
        "frames_redundant": redundant,
        "estimates": 11,
        "latency": {"p50_ms": 208.0},
        "cores_used": 0.5,
    }


def test_redundant_frames_are_taken_too():
    table = viewer_section(run(250, 50) | {"with_viewer": run(230, 55)})
    assert "| frames taken | 300 | 285 |" in table
    assert "| frames that the viewer costs |  | 5.0% |" in table
