# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How much a material map changes from one keyframe to the next."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reflest_core.estimation.material_map import MaterialMap


@dataclass(frozen=True)
class Change:
    """The change between two keyframes.

    Attributes:
        kept: Share of the voxels in both maps that have the same material id.
        steps: For each material in both maps the largest change of ``rho_d``, ``rho_s`` and
            ``alpha`` over the earlier estimate's standard deviation; materials without deviations
            are left out.
    """

    kept: float
    steps: list[float]


def change_between(before: MaterialMap, after: MaterialMap) -> Change | None:
    """Compare the maps of two keyframes of one scan.

    Args:
        before: The earlier map.
        after: The later map.

    Returns:
        The change; None where the maps have no voxel in common.
    """
    keys = after.surface.voxel_keys
    common = np.isin(keys, before.surface.voxel_keys)
    if not common.any():
        return None
    earlier = before.partition.ids_of(keys[common])
    steps = []
    for material in after.materials:
        old = before.material(material.id)
        if old is None:
            continue
        one, other = old.estimate, material.estimate
        moved = np.abs(
            np.array([*one.rho_d, one.rho_s, one.alpha])
            - np.array([*other.rho_d, other.rho_s, other.alpha])
        )
        stated = np.array([*one.rho_d_stddev, one.rho_s_stddev, one.alpha_stddev])
        if np.isfinite(stated).all():
            steps.append(float((moved / np.maximum(stated, 1e-9)).max()))
    return Change(float((earlier == after.material_ids[common]).mean()), steps)
