# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""lightnet with more knowledge of the light than the scan shows, from three sources."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from reflest_core.environment.known_rooms import KnownRooms
from reflest_core.environment.room import Room
from reflest_core.evaluation.estimates import estimate_all
from reflest_core.evaluation.networks import EvaluatedNetwork
from reflest_core.evaluation.shown_scenes import shown
from reflest_core.evaluation.statistics.accuracy import accuracy
from reflest_core.evaluation.studies.view_study import drawn_views
from reflest_core.light.known_light import KnownLight
from reflest_core.synbrdf.relit.look_around import FRAMES, look_around
from reflest_core.synbrdf.scenes.scene import Scene
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene
from reflest_core.training.data.sample import Sample

VIEW_COUNTS = (100, 10)


def measure_look_around(
    network: EvaluatedNetwork,
    splits: dict[str, list[SynbrdfScene]],
    drawn: Callable[[SynbrdfScene], Scene],
    rooms: KnownRooms,
) -> dict[str, Any]:
    """RMSE of lightnet from scans alone and with additional light, by pattern of views.

    Args:
        network: lightnet.
        splits: The scenes of each split.
        drawn: Gives the scene with its light, which must be infinitely far.
        rooms: Panoramas of the training environments.

    Returns:
        Rows with the accuracies of ``scan``; of ``with``, :data:`FRAMES` more frames of the room
        by the same camera; of ``rooms``, in which the scan's own room has to be recognised; and of
        ``panorama``, all of the light in high dynamic range.
    """
    estimator = network.estimator()
    statistics = estimator.predictor.card.statistics
    rows = []
    for split, scenes in splits.items():
        for count, samples in _samples(scenes, drawn, rooms, split).items():
            made = {
                name: estimate_all(estimator, some, f"{name}, {count} views of {split}").ward
                for name, some in samples.items()
            }
            for pattern, chosen in _patterns(scenes):
                row: dict[str, Any] = {"split": split, "views": count, "pattern": pattern}
                for name, some in samples.items():
                    of = [some[index] for index in chosen]
                    found = accuracy(made[name][chosen], of, statistics)
                    row[name] = {**dataclasses.asdict(found), "seen": _seen(of)}
                row["recognised"] = _changed(samples, chosen)
                rows.append(row)
    return {
        "frames": FRAMES,
        "rooms": len(rooms.rooms),
        "model_id": estimator.predictor.model_id,
        "rows": rows,
    }


def _samples(
    scenes: list[SynbrdfScene],
    drawn: Callable[[SynbrdfScene], Scene],
    rooms: KnownRooms,
    title: str,
) -> dict[int, dict[str, list[Sample]]]:
    """By number of views: each scene as it was scanned, and in each way to know more."""
    by_count: dict[int, dict[str, list[Sample]]] = {
        count: {"scan": [], "with": [], "rooms": [], "panorama": []} for count in VIEW_COUNTS
    }
    for scene in tqdm(scenes, desc=f"looking around in {title}", unit="scene", leave=False):
        environment = drawn(scene).light.radiance
        frames = look_around(environment, scene.exposure)
        panorama = Room.of("panorama", environment).known_light()
        for count, samples in by_count.items():
            views = drawn_views(scene, count)
            samples["scan"].append(shown(scene, views))
            samples["with"].append(shown(scene, views, frames))
            samples["rooms"].append(_known_before(samples["scan"][-1], rooms))
            samples["panorama"].append(_known_before(samples["scan"][-1], panorama))
    return by_count


def _known_before(scan: Sample, known: KnownLight | KnownRooms) -> Sample:
    surface = scan.surface
    assert surface.light is not None
    joined = dataclasses.replace(surface, light=known.joined(surface.light).light)
    return dataclasses.replace(scan, surface=joined)


def _patterns(scenes: list[SynbrdfScene]) -> Iterator[tuple[str, NDArray[np.int64]]]:
    """Indices of all scenes, and of those with each pattern of views."""
    patterns = np.array([scene.view_pattern for scene in scenes])
    yield "all", np.arange(len(scenes))
    for pattern in np.unique(patterns):
        yield str(pattern), np.flatnonzero(patterns == pattern)


def _seen(samples: list[Sample]) -> float:
    """Mean share of all directions of which the light was seen."""
    lights = [sample.surface.light for sample in samples]
    return float(np.mean([0.0 if light is None else light.seen_share for light in lights]))


def _changed(samples: dict[str, list[Sample]], chosen: NDArray[np.int64]) -> float:
    """Share of the chosen scans to which a known room was joined."""
    pairs = [(samples["scan"][index], samples["rooms"][index]) for index in chosen]
    return float(np.mean([scan.surface.light is not known.surface.light for scan, known in pairs]))
