# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Light that is known before the scan stands in for what the camera did not see.

The camera's own images come first. The known light is brought to their exposure and white balance
by the directions that both show; where these do not agree, it is not used.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.lab import luminance
from reflest_core.errors import ReflestError
from reflest_core.light.light_map import ObservedLight

NAME = "estimation.known_light"
"""The parameter."""
DARKEST = 0.01
"""Radiance, 1 at the sensor's white, below which 8 bits are too coarse for a ratio."""
FEWEST = 100
"""Directions that scan and room must share, 2.1 degrees each."""
MOST_SPREAD = 0.5
"""Median deviation of the logarithms of the ratios: above it they show different light."""


class KnownLightError(ReflestError):
    """What was given as known light cannot be used."""


@dataclass(frozen=True)
class JoinedLight:
    """The light of a scan, with what was known before where that could be used.

    Attributes:
        light: The joined light, or the scan's own.
        problem: Why known light was left out, or a warning about it, or "".
    """

    light: ObservedLight
    problem: str = ""


@dataclass(frozen=True)
class KnownLight:
    """Light that was known before the scan, in the world frame of its poses.

    Attributes:
        radiance: (N, N, 3) octahedral map, linear, any unit.
        is_known: (N, N) bool.
        warning: What a user should know of it, or "".
    """

    radiance: NDArray[np.float32]
    is_known: NDArray[np.bool_]
    warning: str = ""

    def joined(self, light: ObservedLight) -> JoinedLight:
        """Fill in where a scan saw nothing, or only a lower bound.

        Args:
            light: What the scan saw.

        Returns:
            The joined light.
        """
        shared = is_measured(light) & self.is_known & (self.radiance.min(axis=-1) > 0.0)
        if shared.sum() < FEWEST:
            return JoinedLight(
                light,
                f"{NAME} shares {shared.sum()} directions with what was seen, "
                f"fewer than {FEWEST}: let the camera see more of the room",
            )
        ratios = np.log(light.radiance[shared] / self.radiance[shared])
        gain = np.exp(np.median(ratios, axis=0)).astype(np.float32)
        brightness = np.log(luminance(light.radiance[shared]) / luminance(self.radiance[shared]))
        spread = float(np.median(np.abs(brightness - np.median(brightness))))
        if spread > MOST_SPREAD:
            return JoinedLight(
                light,
                f"{NAME} does not look like what the camera saw (brightness differs "
                f"by a factor of {np.exp(spread):.1f} in the median): it is of another place, or "
                "its axes are not those of the poses' world frame",
            )
        known = gain * self.radiance
        takes = self.is_known & (light.coverage == 0.0)
        bounds = self.is_known[..., None] & (light.clipped > 0.0)
        radiance = light.radiance.copy()
        radiance[takes] = known[takes]
        radiance[bounds] = np.maximum(radiance[bounds], known[bounds])
        coverage = np.where(takes, np.float32(1.0), light.coverage)
        clipped = np.where(bounds, np.float32(0.0), light.clipped)
        return JoinedLight(ObservedLight(radiance, coverage, clipped), self.warning)


def is_measured(light: ObservedLight) -> NDArray[np.bool_]:
    """Find the directions of which the camera saw the value, above the noise of 8 bits.

    Args:
        light: What was seen.

    Returns:
        (N, N) bool.
    """
    is_value = (light.coverage > 0.0) & (light.any_clipped == 0.0)
    return np.asarray(is_value & (light.radiance.min(axis=-1) > DARKEST))
