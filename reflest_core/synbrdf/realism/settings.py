# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which faults of a real capture are imitated, and how far each goes."""

from __future__ import annotations

import dataclasses
import enum
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from reflest_core.errors import ReflestError

LOSSLESS = 100
"""A JPEG quality that leaves an image as it is."""
LOWEST_QUALITY = 60
"""Lower ones were not measured."""


class RealismError(ReflestError):
    """A fault was asked for that is not imitated, or to a degree that makes no sense."""


class Effect(enum.Enum):
    """A fault that can be turned on alone."""

    EXPOSURE = "exposure"
    WHITE_BALANCE = "white-balance"
    SENSOR = "sensor"
    JPEG = "jpeg"
    DEPTH = "depth"
    POSE = "pose"
    NORMALS = "normals"


@dataclass(frozen=True)
class Realism:
    """The most that each fault comes to; every scene draws its own degree evenly from 0 to that.

    Attributes:
        exposure_stops: Standard deviation of the exposure's wander over the views.
        metering: Share of the difference between a view's own metering and the scene's that auto
            exposure makes up for.
        white_balance: Standard deviation of the wander of the logarithm of red's and blue's gains.
        shot_noise: Standard deviation of the linear signal at full scale, in units of that; it
            falls as the signal's square root.
        read_noise: Standard deviation of any signal, in units of full scale.
        jpeg_quality: The lowest, drawn evenly up to 95; 100 for none.
        depth_noise: Multiple of the sensor's own.
        depth_holes: Multiple of the sensor's own.
        pose_translation: Standard deviation on each axis, metres.
        pose_rotation: Standard deviation about each axis, degrees.
        normal_noise: Multiple of what fusion was measured to give.
    """

    exposure_stops: float = 0.4
    metering: float = 0.6
    white_balance: float = 0.06
    shot_noise: float = 0.04
    read_noise: float = 0.006
    jpeg_quality: int = 60
    depth_noise: float = 1.0
    depth_holes: float = 1.0
    pose_translation: float = 0.003
    pose_rotation: float = 0.3
    normal_noise: float = 1.5

    def __post_init__(self) -> None:
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if not 0.0 <= value < np.inf:
                raise RealismError(f"realism's {field.name} is {value}, but must be 0 or more")
        if not LOWEST_QUALITY <= self.jpeg_quality <= LOSSLESS:
            raise RealismError(
                f"realism's jpeg_quality is {self.jpeg_quality}, but must be {LOWEST_QUALITY} to "
                f"{LOSSLESS}"
            )

    @classmethod
    def only(cls, effects: Iterable[Effect]) -> Realism:
        """Turn some faults on in their usual degrees, and all others off.

        Args:
            effects: which ones; none for a perfect camera.
        """
        wanted = set(effects)
        off = {
            name: OFF.get(name, 0.0)
            for effect, names in FIELDS.items()
            if effect not in wanted
            for name in names
        }
        return cls(**off)  # type: ignore[arg-type]

    def is_on(self, effect: Effect) -> bool:
        """Whether a fault changes anything.

        Args:
            effect: which one.
        """
        return any(getattr(self, name) != OFF.get(name, 0.0) for name in FIELDS[effect])


FIELDS: dict[Effect, tuple[str, ...]] = {
    Effect.EXPOSURE: ("exposure_stops", "metering"),
    Effect.WHITE_BALANCE: ("white_balance",),
    Effect.SENSOR: ("shot_noise", "read_noise"),
    Effect.JPEG: ("jpeg_quality",),
    Effect.DEPTH: ("depth_noise", "depth_holes"),
    Effect.POSE: ("pose_translation", "pose_rotation"),
    Effect.NORMALS: ("normal_noise",),
}
OFF = {"jpeg_quality": LOSSLESS}
"""What turns a field off where 0 does not."""


def parse_effects(words: Iterable[str]) -> list[Effect]:
    """Effects of the given names; ``all`` stands for every one.

    Args:
        words: names of effects.
    """
    effects: list[Effect] = []
    for word in words:
        if word == "all":
            effects += list(Effect)
            continue
        try:
            effects.append(Effect(word))
        except ValueError:
            known = ", ".join(effect.value for effect in Effect)
            raise RealismError(
                f"--realism does not know {word!r}: choose from all, {known}"
            ) from None
    return [effect for effect in Effect if effect in effects]


def streams(rng: np.random.Generator) -> dict[Effect, np.random.Generator]:
    """One independent stream for each effect, so that turning one off leaves the others alone.

    Args:
        rng: random numbers; the same state draws the same.
    """
    return dict(zip(Effect, rng.spawn(len(Effect)), strict=True))
