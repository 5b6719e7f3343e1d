# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The environment as 8-bit pictures: one to look at, one that says what was seen."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.srgb import encode
from reflest_core.environment.environment_map import EnvironmentMap

UNSEEN, LOWER_BOUND, SEEN = 0, 127, 255
"""Codes of :func:`coverage_codes`."""
LEAST_COVERAGE = 0.5
"""Of a pixel that counts as seen."""
LEAST_CLIPPED = 0.1
"""Of what was seen there, from which on the radiance counts as a lower bound."""
DIMMED = 0.35
"""Brightness in the picture of what was not seen."""


def coverage_codes(environment: EnvironmentMap) -> NDArray[np.uint8]:
    """Code what is known of each pixel.

    Args:
        environment: The light.

    Returns:
        (H, 2 H) 255 seen, 127 seen but known only as a lower bound, 0 not seen: completed.
    """
    seen = np.where(environment.clipped > LEAST_CLIPPED, LOWER_BOUND, SEEN)
    return np.where(environment.coverage < LEAST_COVERAGE, UNSEEN, seen).astype(np.uint8)


def tone_mapped(environment: EnvironmentMap) -> NDArray[np.uint8]:
    """Draw the light as the camera exposed it, clipped at its white; what was not seen is dim.

    Args:
        environment: The light.

    Returns:
        (H, 2 H, 3) 8-bit sRGB.
    """
    picture = encode(environment.radiance.astype(np.float64))
    is_guessed = coverage_codes(environment) == UNSEEN
    picture[is_guessed] *= DIMMED
    return np.asarray(np.round(picture * 255.0), np.uint8)
