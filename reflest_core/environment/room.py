# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A room whose light was seen before: a panorama, or what an earlier scan saw of it."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.errors import ReflestError
from reflest_core.fusion.scan import Scan
from reflest_core.light.environment_reader import LARGEST_RADIANCE, read_radiance
from reflest_core.light.equirectangular import equirectangular_directions, radiance_from
from reflest_core.light.known_light import NAME, KnownLight, KnownLightError
from reflest_core.light.light_map import SIZE
from reflest_core.light.octahedral import octahedral_directions, octahedral_texels
from reflest_core.surface.upright import rotation_about_z

PANORAMAS = (".hdr", ".exr")
"""Suffixes of images of all directions."""
SCAN_HEIGHT = 2 * SIZE
"""Rows that a scan's light is laid out in: 0.9 degrees, finer than its texels."""
SAMPLES = 4
"""Looked up along each edge of a texel and averaged, so that a small lamp keeps its power."""
LEAST_KNOWN = 0.5
"""Share of a texel's samples that must be known for it to be."""


@dataclass(frozen=True, eq=False)
class Room:
    """The light of a room, equirectangular (:mod:`reflest_core.light.equirectangular`).

    Attributes:
        name: Of the file that it comes from.
        radiance: (H, 2 H, 3) float32, linear, any unit.
        is_known: (H, 2 H) bool.
        warning: What a user should know of it, or "".
    """

    name: str
    radiance: NDArray[np.float32]
    is_known: NDArray[np.bool_]
    warning: str = ""

    @staticmethod
    def read(path: Path) -> Room:
        """Read an ``.hdr`` or ``.exr`` panorama, or a saved scan.

        Alpha of an ``.exr`` file is coverage: only what was seen is known.

        Args:
            path: The file.

        Returns:
            The room.

        Raises:
            KnownLightError: The file cannot be used.
        """
        if path.suffix.lower() in PANORAMAS:
            return _panorama(path)
        return Room.of_scan(path)

    @staticmethod
    def of(name: str, panorama: NDArray[np.float32]) -> Room:
        """Take all of a panorama as known.

        Args:
            name: For messages.
            panorama: (H, 2 H, 3) linear radiance; negative values count as 0.

        Returns:
            The room.
        """
        return Room(name, np.maximum(panorama, 0.0), np.ones(panorama.shape[:2], np.bool_))

    @staticmethod
    def of_scan(path: Path) -> Room:
        """Take what an earlier scan saw of the room, and not only as a lower bound.

        Args:
            path: A saved scan.

        Returns:
            The room.

        Raises:
            KnownLightError: The file is not a scan.
        """
        try:
            light = Scan.load(path).light.observed()
        except ReflestError as error:
            raise KnownLightError(
                f"{NAME} is neither an .hdr or .exr panorama nor a scan: {error}"
            ) from error
        texels = octahedral_texels(equirectangular_directions(SCAN_HEIGHT), SIZE)
        is_known = (light.coverage > 0.0) & (light.any_clipped == 0.0)
        return Room(path.name, light.radiance.reshape(-1, 3)[texels], is_known.reshape(-1)[texels])

    def known_light(self, turn: float = 0.0) -> KnownLight:
        """Place the room's light in a world in which the room is turned about the vertical.

        Args:
            turn: Radians, counterclockwise from above.

        Returns:
            The light in the world frame.
        """
        directions = octahedral_directions(SAMPLES * SIZE).reshape(-1, 3)
        directions = np.asarray(directions @ rotation_about_z(-turn).T, np.float32)
        known = self.is_known[..., None].astype(np.float32)
        fine = radiance_from(np.concatenate([self.radiance * known, known], axis=-1), directions)
        sums = fine.reshape(SIZE, SAMPLES, SIZE, SAMPLES, 4).sum(axis=(1, 3))
        mean = sums[..., :3] / np.maximum(sums[..., 3:], np.float32(1e-6))
        return KnownLight(mean, sums[..., 3] >= LEAST_KNOWN * SAMPLES**2, self.warning)


def _panorama(path: Path) -> Room:
    try:
        image = read_radiance(path)
    except OSError as error:
        raise KnownLightError(f"{NAME} = {path} cannot be read: {error.strerror}") from error
    except ValueError as error:
        raise KnownLightError(f"{NAME} = {path} cannot be read: {error}") from error
    height, width, _ = image.radiance.shape
    if width != 2 * height:
        raise KnownLightError(
            f"{NAME} = {path} is {width} x {height} pixels, but a panorama of all directions "
            "is twice as wide as high"
        )
    room = Room.of(path.stem, image.radiance)
    if image.coverage is not None:
        room = dataclasses.replace(room, is_known=image.coverage >= LEAST_KNOWN)
        if not room.is_known.any():
            raise KnownLightError(
                f"{NAME} = {path} has no pixel with alpha: nothing of it is known"
            )
    known = image.radiance[room.is_known]
    if not ((known < LARGEST_RADIANCE).all() and (known > 0.0).any()):
        raise KnownLightError(
            f"{NAME} = {path} is black, or holds radiance that is not below {LARGEST_RADIANCE:g}"
        )
    if image.coverage is None and image.software == "reflest":
        warning = (
            f"{NAME} = {path} was exported by reflest as .hdr, which does not hold what of it was "
            "seen: all of it is taken as known; export it as .exr"
        )
        return dataclasses.replace(room, warning=warning)
    return dataclasses.replace(room, radiance=np.where(room.is_known[..., None], room.radiance, 0))
