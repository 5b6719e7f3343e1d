# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Gloss from what changes with the view: whatever the diffuse light, lobes determine ``rho_s``.

Within a voxel, ``radiance = diffuse + rho_s * lobe(alpha)``, with one unknown diffuse radiance for
each voxel and channel, and what the lobes see of clipped and unseen light (:mod:`.gloss_kernel`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.gloss.gloss_kernel import ROUGHNESSES_AT_ONCE, fit_roughnesses
from reflest_core.inference.material_fit import likelihood
from reflest_core.inference.transport.ward_lobe import ROUGHNESSES
from reflest_core.jit import kernel_array

EVIDENCE = 0.15
"""Power of the misfit's inverse that makes a roughness likely, for each observation that counted.
It would be 3 (channels) for Gaussian errors of unknown size, but neighbours err alike."""
SURE = 0.5
"""The same where the errors of neighbours are nearly independent."""


@dataclass(frozen=True)
class GlossFit:
    """The fit at each of K roughnesses, float32.

    Attributes:
        gloss: (K,) ``rho_s``.
        deviation: (K,) its standard deviation.
        misfit: (K,) root mean square error in units of what is expected, outliers weighing little.
        count: (K,) observations that counted.
    """

    gloss: NDArray[np.float32]
    deviation: NDArray[np.float32]
    misfit: NDArray[np.float32]
    count: NDArray[np.float32]

    @cached_property
    def weight(self) -> NDArray[np.float32]:
        """(K,), how likely each roughness is by its misfit; they sum to 1."""
        return self.weight_by(EVIDENCE)

    def tempered(self, surplus: float) -> GlossFit:
        """Return the fit, no surer than fewer observations would make it.

        Neighbouring voxels err alike: more of them make the fit steadier, but hardly truer.

        Args:
            surplus: Observations for each that is to count, at least 1.
        """
        root = np.float32(np.sqrt(surplus))
        count = self.count / np.float32(surplus)
        return GlossFit(self.gloss, root * self.deviation, self.misfit, count)

    def weight_by(self, evidence: float) -> NDArray[np.float32]:
        """Weigh the roughnesses by their misfits.

        Args:
            evidence: share of the observations that count as independent.

        Returns:
            (K,) float32, summing to 1.
        """
        return likelihood(self.misfit, evidence * float(self.count.max()))

    @property
    def roughness(self) -> int:
        """Index of the roughness that is nearest to the mean of all, by their weights."""
        mean = self.weight @ np.array(ROUGHNESSES)
        return int(np.abs(np.array(ROUGHNESSES) - mean).argmin())


def fit_gloss(
    colours: NDArray[np.float32],
    clipped: NDArray[np.bool_],
    lobes: NDArray[np.float32],
    voxel_of: NDArray[np.int64],
) -> GlossFit:
    """Fit ``rho_s`` at each of K roughnesses by IRLS.

    Args:
        colours: (O, 3) linear.
        clipped: (O, 3) True where a channel is saturated.
        lobes: (O, K, 5) of :func:`~.ward_lobe.lobe_radiance`.
        voxel_of: (O,) rising; every voxel has a diffuse radiance of its own.
    """
    voxels = int(voxel_of[-1]) + 1 if len(voxel_of) else 0
    fits = [
        fit_roughnesses(
            kernel_array(colours, np.float32),
            kernel_array(clipped, np.bool_),
            kernel_array(lobes[:, first : first + ROUGHNESSES_AT_ONCE], np.float32),
            kernel_array(voxel_of, np.int64),
            voxels,
        )
        for first in range(0, lobes.shape[1], ROUGHNESSES_AT_ONCE)
    ]
    return GlossFit(*np.concatenate(fits).astype(np.float32).T)
