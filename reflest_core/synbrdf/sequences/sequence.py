# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Renders an RGB-D sequence into a rosbag2 directory with its truth beside it.

Importing this module loads Mitsuba.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from reflest_core.brdf.lab import luminance
from reflest_core.synbrdf.generation.whole_folder import whole_folder
from reflest_core.synbrdf.path_tracing.full_image import FullImageRenderer
from reflest_core.synbrdf.path_tracing.mitsuba_scene import RadianceTracer, mitsuba_scene
from reflest_core.synbrdf.path_tracing.sparse_scene import camera_rays
from reflest_core.synbrdf.path_tracing.ward_bsdf import ward_bsdf
from reflest_core.synbrdf.realism.camera_faults import CameraFaults, draw_camera_faults
from reflest_core.synbrdf.realism.settings import Realism, streams
from reflest_core.synbrdf.scenes.exposure import auto_exposure, expose
from reflest_core.synbrdf.scenes.thumbnails import THUMBNAIL
from reflest_core.synbrdf.sequences.bag_writer import RecordedFrame, write_bag
from reflest_core.synbrdf.sequences.depth_camera import depth_camera
from reflest_core.synbrdf.sequences.sequence_scene import (
    SequenceRefused,
    SequenceRequest,
    SequenceScene,
    draw_sequence_scene,
)
from reflest_core.synbrdf.sequences.sequence_truth import write_truth

START_NS = 1_750_000_000 * 10**9
"""Stamp of the first frame, the same in every sequence."""
EXPOSED_FRAMES = 16
"""Spread over the sequence; they meter the exposure that all frames share."""
REALISM_STREAM = 0x5EA1
"""Keeps the faults' random numbers apart from the scene's."""


def write_sequence(out: Path, request: SequenceRequest, command: str) -> None:
    """Write the bag folder ``out``, whole or not at all; the same request gives the same bytes.

    Raises:
        SequenceRefused: if ``out`` exists.
    """
    if out.exists():
        raise SequenceRefused(f"{out} exists: delete it or choose another --out")
    scene = draw_sequence_scene(request)
    rendered = mitsuba_scene(scene.mesh, ward_bsdf(scene.material), scene.light.radiance)
    chosen = np.unique(np.linspace(0, len(scene.poses) - 1, EXPOSED_FRAMES).round().astype(int))
    exposure = auto_exposure(_metered(rendered, scene.poses[chosen], request.seed))
    faults = None
    if request.realism is not None:
        faults = _draw_faults(request.realism, rendered, scene.poses, request.seed)
    with whole_folder(out) as unfinished:
        frames = _frames(rendered, scene, request, exposure, faults)
        progress = tqdm(frames, total=request.frames, unit="frame")
        write_bag(unfinished, depth_camera(request.width, request.height), progress)
        write_truth(unfinished, request, scene, exposure, command)


def _metered(rendered: Any, poses: NDArray[np.float64], seed: int) -> NDArray[np.float32]:
    """Radiance (W, P, 3) of a small image from each pose."""
    origins, directions = camera_rays(THUMBNAIL, poses)
    tracer = RadianceTracer(4, lanes=1 << 17)
    radiance = tracer.trace(rendered, origins, directions, _seed(seed, 0))
    return radiance.reshape(len(poses), -1, 3)


def _draw_faults(
    realism: Realism, rendered: Any, poses: NDArray[np.float64], seed: int
) -> CameraFaults:
    light = np.maximum(luminance(_metered(rendered, poses, seed).astype(np.float64)), 1e-6)
    brightness = np.exp(np.log(light).mean(axis=1))
    rng = np.random.default_rng([REALISM_STREAM, seed])
    return draw_camera_faults(realism, brightness, poses, streams(rng))


def _frames(
    rendered: Any,
    scene: SequenceScene,
    request: SequenceRequest,
    exposure: float,
    faults: CameraFaults | None,
) -> Iterator[RecordedFrame]:
    camera = depth_camera(request.width, request.height)
    renderer = FullImageRenderer(camera, request.samples)
    for index, pose in enumerate(scene.poses):
        image = renderer.render(
            rendered, scene.light.radiance, pose, _seed(request.seed, index + 1)
        )
        if faults is None:
            rgb, depth = expose(image.radiance, exposure), image.depth
        else:
            rng = np.random.default_rng([REALISM_STREAM, request.seed, index + 1])
            rgb = faults.image(image.radiance, exposure, index, rng)
            depth = faults.depth(image.depth, image.cosines, camera, rng)
        yield RecordedFrame(
            stamp_ns=START_NS + round(index * 1e9 / request.rate),
            rgb=rgb,
            depth_mm=np.rint(depth * 1000.0).astype(np.uint16),
            pose=pose if faults is None else faults.poses[index],
        )


def _seed(seed: int, frame: int) -> int:
    return int(np.random.SeedSequence([seed, frame]).generate_state(1)[0] >> 1)
