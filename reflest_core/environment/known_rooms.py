# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The room that a camera is in, found among known ones, and its light.

A room may have been turned about the vertical since: a panorama does not know the map's axes, nor
does a map that was started again. Logarithms of brightness are compared at every turn at once, by
Fourier transforms of the rows, with one unknown exposure.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.lab import luminance
from reflest_core.environment.room import Room
from reflest_core.light.equirectangular import (
    equirectangular_directions,
    equirectangular_solid_angles,
)
from reflest_core.light.known_light import (
    FEWEST,
    NAME,
    JoinedLight,
    KnownLight,
    KnownLightError,
    is_measured,
)
from reflest_core.light.light_map import SIZE, ObservedLight
from reflest_core.light.octahedral import octahedral_texels

HEIGHT = 64
"""Rows in which rooms are compared: 2.8 degrees."""
LEAST_LIKE = 0.8
"""Correlation of the room with what was seen."""
CLEAREST = 0.7
"""Greatest share of the next likely room's error (root mean square). With both, 843 of 848 training
scenes were assigned their room among 24; without it, one of them was assigned another."""
STEPS = 4
"""Of a column: turns are found to 0.7 degrees, so that the next keyframe asks for the same one."""
DARKEST = 1e-6
"""Added before a logarithm."""

Grid = NDArray[np.float64]


@dataclass(frozen=True)
class _Likeness:
    """How well R rooms match the observed light at T turns, by so many columns clockwise.

    Attributes:
        error: (R, T) mean square of the log ratios that no exposure explains.
        correlation: (R, T) of the same logarithms.
    """

    error: Grid
    correlation: Grid


@dataclass(frozen=True)
class KnownRooms:
    """Rooms in any turn about the vertical.

    Attributes:
        rooms: The rooms.
        place: Where they are kept, for messages.
    """

    rooms: Sequence[Room]
    place: str

    def joined(self, light: ObservedLight) -> JoinedLight:
        """Fill in from the room that the light was seen in, where the scan saw nothing or a bound.

        Args:
            light: What the scan saw.

        Returns:
            The joined light.
        """
        if is_measured(light).sum() < FEWEST:
            return JoinedLight(
                light, f"too little of the surroundings was seen to recognise a room of {NAME}"
            )
        likeness = self._likeness(light)
        errors = likeness.error.min(axis=1)
        room = int(errors.argmin())
        turn = int(likeness.error[room].argmin())
        next_likely = np.delete(errors, room).min(initial=np.inf)
        is_like = np.isfinite(errors[room]) and likeness.correlation[room, turn] >= LEAST_LIKE
        if not is_like or errors[room] > CLEAREST**2 * next_likely:
            return JoinedLight(
                light,
                f"none of the {len(self.rooms)} rooms in {NAME} = {self.place} looks like what the "
                f"camera saw (the likeliest is {self.rooms[room].name}): add a panorama or a scan "
                "of this one, or let the camera see more of it",
            )
        columns = turn + _between(likeness.error[room], turn)
        steps = round(columns * STEPS)
        return _turned(self.rooms[room], steps).joined(light)

    def _likeness(self, light: ObservedLight) -> _Likeness:
        """By what both show; a room's error is infinite where that is too little."""
        texels = _texels()
        weight = is_measured(light).reshape(-1)[texels] * equirectangular_solid_angles(HEIGHT)
        seen = _log(luminance(light.radiance)).reshape(-1)[texels]
        of_weight, of_seen, of_square = (
            np.fft.rfft(values, axis=1) for values in (weight, weight * seen, weight * seen**2)
        )
        known, shown, square = self._spectra
        count = np.maximum(_at_turns(of_weight, known), 1e-9)
        a, aa = _at_turns(of_seen, known) / count, _at_turns(of_square, known) / count
        b, bb = _at_turns(of_weight, shown) / count, _at_turns(of_weight, square) / count
        product = _at_turns(of_seen, shown) / count
        of_light, of_room = (np.maximum(v, 1e-9) for v in (aa - a * a, bb - b * b))
        together = product - a * b
        error = np.maximum(of_light + of_room - 2.0 * together, 0.0)
        is_enough = count > 0.5 * weight.sum()
        return _Likeness(np.where(is_enough, error, np.inf), together / np.sqrt(of_light * of_room))

    @cached_property
    def _spectra(self) -> list[NDArray[np.complex128]]:
        """(R, HEIGHT, HEIGHT + 1) each: of where rooms are known, their logarithm, its square."""
        grids = [_grid(room) for room in self.rooms]
        known, shown = (np.stack(parts) for parts in zip(*grids, strict=True))
        powers = (known, known * shown, known * shown**2)
        return [np.fft.rfft(power, axis=2).conj() for power in powers]


def read_known_light(path: Path) -> KnownRooms | KnownLight:
    """Read panoramas and saved scans.

    Args:
        path: A folder of ``.hdr`` and ``.exr`` panoramas and saved scans, rooms that the scan may
            be in; or one such file, whose light is in the world's axes.

    Returns:
        The rooms, or the light.

    Raises:
        KnownLightError: A file cannot be used.
    """
    if not path.is_dir():
        return Room.read(path).known_light()
    files = sorted(file for file in path.iterdir() if not file.name.startswith("."))
    if not files:
        raise KnownLightError(
            f"{NAME} = {path} is empty: put .hdr or .exr panoramas or saved scans there"
        )
    return KnownRooms([Room.read(file) for file in files], str(path))


@lru_cache(maxsize=8)
def _turned(room: Room, steps: int) -> KnownLight:
    """Kept, for the next keyframe is likely to ask for it again. Columns count clockwise."""
    return room.known_light(-steps / STEPS * np.pi / HEIGHT)


def _between(errors: Grid, turn: int) -> float:
    """Where between columns the least error lies, by a parabola; in [-0.5, 0.5]."""
    before, least, after = (errors[(turn + step) % len(errors)] for step in (-1, 0, 1))
    bend = before - 2.0 * least + after
    if not (np.isfinite(bend) and bend > 0.0):
        return 0.0
    return float(np.clip(0.5 * (before - after) / bend, -0.5, 0.5))


def _at_turns(of_light: NDArray[np.complex128], of_rooms: NDArray[np.complex128]) -> Grid:
    """(R, T): sums of the products, with the room turned by each number of columns."""
    return np.fft.irfft((of_light * of_rooms).sum(axis=1), n=2 * HEIGHT, axis=1)


def _grid(room: Room) -> tuple[Grid, Grid]:
    """(HEIGHT, 2 HEIGHT) each: where it is known, 0 or 1, and the logarithm of its brightness."""
    known = room.known_light()
    texels = _texels()
    return (
        known.is_known.reshape(-1)[texels].astype(np.float64),
        _log(luminance(known.radiance)).reshape(-1)[texels],
    )


@lru_cache(maxsize=1)
def _texels() -> NDArray[np.int64]:
    return octahedral_texels(equirectangular_directions(HEIGHT), SIZE)


def _log(brightness: NDArray[np.float32]) -> Grid:
    return np.log(brightness.astype(np.float64) + DARKEST)
