# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Scenes as a scan leaves them: what the chosen views observed of the surface and of the light."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.relit.scene_light import Background
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene
from reflest_core.training.data.sample import (
    Degradation,
    Sample,
    TrainingError,
    sample_of,
    usable_scenes,
)
from reflest_core.training.data.scanned_scene import scanned

Scene = TypeVar("Scene", SynbrdfScene, Sample)


def load_shown(
    folder: Path, split: str, degradation: Degradation | None = None, limit: int | None = None
) -> list[SynbrdfScene]:
    """Load the usable scenes of a split.

    Args:
        folder: The data set.
        split: ``train``, ``validation`` or ``unseen``.
        degradation: Faults of a real capture that the scenes get, or None.
        limit: Only the first so many scenes; None for all.

    Raises:
        TrainingError: the split has no usable scene.
    """
    scenes = list(usable_scenes(folder, split, degradation))[:limit]
    if not scenes:
        raise TrainingError(f"{folder} holds no scenes of split {split!r}; generate them first")
    return scenes


def shown(
    scene: SynbrdfScene,
    views: NDArray[np.int64] | None = None,
    background_frames: Sequence[Background] = (),
) -> Sample:
    """The observations of some views of a scene, as a sample.

    No pixel of another view enters: neither the surface's colours nor the light.

    Args:
        scene: A scene of the data set.
        views: (W,) int64, indices of views; None for all.
        background_frames: Further frames, which show the light alone.
    """
    if views is None:
        views = np.arange(len(scene.surface.view_centres))
    return dataclasses.replace(
        sample_of(scene), surface=scanned(scene, views, background_frames=background_frames)
    )


def random_subset(scenes: list[Scene], count: int, seed: int) -> list[Scene]:
    """At most ``count`` scenes, drawn at random, in their order.

    Args:
        scenes: What to draw from.
        count: How many at most.
        seed: Of the random generator.
    """
    order = np.random.default_rng(seed).permutation(len(scenes))[:count]
    return [scenes[index] for index in sorted(order.tolist())]
