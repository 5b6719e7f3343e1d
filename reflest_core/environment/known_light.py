# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Light that is known before the scan: a panorama of the room takes the place of what is unseen.

The camera's own pictures come first. The panorama is brought to their exposure and white balance
by the directions that both show, and is left alone where these do not agree.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.lab import luminance
from reflest_core.environment.environment_reader import read_radiance
from reflest_core.environment.equirectangular_lookup import radiance_from
from reflest_core.errors import ReflestError
from reflest_core.fusion.light_map import SIZE, ObservedLight
from reflest_core.fusion.octahedral import octahedral_directions
from reflest_core.fusion.scan import Scan

NAME = "estimation.known_light"
"""The parameter."""
DARKEST = 0.01
"""Radiance, 1 at the sensor's white, below which 8 bits tell no ratio."""
SAMPLES = 4
"""Looked up along each edge of a texel and averaged, so that a small lamp keeps its power."""
FEWEST = 100
"""Directions that scan and panorama must share, 2.1 degrees each."""
MOST_SPREAD = 0.5
"""Median deviation of the logarithms of the ratios: above it they show different light."""


class KnownLightError(ReflestError):
    """The file cannot be used."""


@dataclass(frozen=True)
class JoinedLight:
    """``light`` of a scan with what was known before; ``problem``: why that was left out, or ""."""

    light: ObservedLight
    problem: str = ""


@dataclass(frozen=True)
class KnownLight:
    """An octahedral map: ``radiance`` (N, N, 3), linear, any unit; ``is_known`` (N, N) bool."""

    radiance: NDArray[np.float32]
    is_known: NDArray[np.bool_]

    @staticmethod
    def read(path: Path) -> KnownLight:
        """An ``.hdr`` panorama in the axes of :mod:`.equirectangular`, or a saved scan's light.

        Of a scan, what it saw and not only as a lower bound. Both in the world frame of the poses.
        Raises :class:`KnownLightError`.
        """
        if path.suffix.lower() != ".hdr":
            return KnownLight.of_scan(path)
        try:
            panorama = read_radiance(path)
        except (OSError, ValueError) as error:
            raise KnownLightError(f"{NAME} = {path} cannot be read: {error}") from error
        height, width, _ = panorama.shape
        if width != 2 * height:
            raise KnownLightError(
                f"{NAME} = {path} is {width} x {height} pixels, but a panorama of all directions "
                "is twice as wide as high"
            )
        if not (np.isfinite(panorama).all() and (panorama > 0.0).any()):
            raise KnownLightError(f"{NAME} = {path} is black or not finite")
        return KnownLight.of(panorama)

    @staticmethod
    def of(panorama: NDArray[np.float32]) -> KnownLight:
        """All of (H, 2 H, 3) linear radiance."""
        fine = octahedral_directions(SAMPLES * SIZE).reshape(-1, 3)
        radiance = radiance_from(np.maximum(panorama, 0.0), fine)
        of_texels = radiance.reshape(SIZE, SAMPLES, SIZE, SAMPLES, 3).mean(axis=(1, 3))
        return KnownLight(of_texels, np.ones((SIZE, SIZE), np.bool_))

    @staticmethod
    def of_scan(path: Path) -> KnownLight:
        """What an earlier scan saw of the same room."""
        try:
            light = Scan.load(path).light.observed()
        except ReflestError as error:
            raise KnownLightError(f"{NAME} is neither an .hdr file nor a scan: {error}") from error
        return KnownLight(light.radiance, (light.coverage > 0.0) & (light.any_clipped == 0.0))

    def joined(self, light: ObservedLight) -> JoinedLight:
        """``light`` with this one where it saw nothing, or only a lower bound."""
        shared = (light.coverage > 0.0) & (light.any_clipped == 0.0) & self.is_known
        shared &= (light.radiance.min(axis=-1) > DARKEST) & (self.radiance.min(axis=-1) > 0.0)
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
        return JoinedLight(ObservedLight(radiance, coverage, clipped))
