# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A room whose light was seen before: a panorama, or what an earlier scan saw of it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.errors import ReflestError
from reflest_core.fusion.scan import Scan
from reflest_core.light.environment_reader import read_radiance
from reflest_core.light.equirectangular import equirectangular_directions, radiance_from
from reflest_core.light.known_light import NAME, KnownLight, KnownLightError
from reflest_core.light.light_map import SIZE
from reflest_core.light.octahedral import octahedral_directions, octahedral_texels

SCAN_HEIGHT = 2 * SIZE
"""Rows that a scan's light is laid out in: 0.9 degrees, finer than its texels."""
SAMPLES = 4
"""Looked up along each edge of a texel and averaged, so that a small lamp keeps its power."""
LEAST_KNOWN = 0.5
"""Share of a texel's samples that must be known for it to be."""


@dataclass(frozen=True, eq=False)
class Room:
    """Equirectangular, in the axes of :mod:`.equirectangular`.

    ``radiance``: (H, 2 H, 3) float32, linear, any unit. ``is_known``: (H, 2 H) bool.
    """

    name: str
    radiance: NDArray[np.float32]
    is_known: NDArray[np.bool_]

    @staticmethod
    def read(path: Path) -> Room:
        """An ``.hdr`` panorama, or a saved scan. Raises :class:`KnownLightError`."""
        if path.suffix.lower() == ".hdr":
            return Room.of(path.stem, _panorama(path))
        return Room.of_scan(path)

    @staticmethod
    def of(name: str, panorama: NDArray[np.float32]) -> Room:
        """All of (H, 2 H, 3) linear radiance."""
        return Room(name, np.maximum(panorama, 0.0), np.ones(panorama.shape[:2], np.bool_))

    @staticmethod
    def of_scan(path: Path) -> Room:
        """What an earlier scan saw of the room, and not only as a lower bound."""
        try:
            light = Scan.load(path).light.observed()
        except ReflestError as error:
            raise KnownLightError(f"{NAME} is neither an .hdr file nor a scan: {error}") from error
        texels = octahedral_texels(equirectangular_directions(SCAN_HEIGHT), SIZE)
        is_known = (light.coverage > 0.0) & (light.any_clipped == 0.0)
        return Room(path.name, light.radiance.reshape(-1, 3)[texels], is_known.reshape(-1)[texels])

    def known_light(self, turn: float = 0.0) -> KnownLight:
        """Its light in a world in which the room is turned by ``turn`` radians about the vertical.

        Counterclockwise from above.
        """
        directions = turned(octahedral_directions(SAMPLES * SIZE).reshape(-1, 3), -turn)
        known = self.is_known[..., None].astype(np.float32)
        fine = radiance_from(np.concatenate([self.radiance * known, known], axis=-1), directions)
        sums = fine.reshape(SIZE, SAMPLES, SIZE, SAMPLES, 4).sum(axis=(1, 3))
        mean = sums[..., :3] / np.maximum(sums[..., 3:], np.float32(1e-6))
        return KnownLight(mean, sums[..., 3] >= LEAST_KNOWN * SAMPLES**2)


def turned(directions: NDArray[np.floating], angle: float) -> NDArray[np.float32]:
    """(R, 3) turned about the vertical by ``angle`` radians, counterclockwise from above."""
    cosine, sine = np.cos(angle), np.sin(angle)
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(directions @ turn.T, np.float32)


def _panorama(path: Path) -> NDArray[np.float32]:
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
    return panorama
