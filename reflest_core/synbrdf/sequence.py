"""Renders an RGB-D sequence into a rosbag2 directory with its truth beside it.

Importing this module loads Mitsuba.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.synbrdf.bag_writer import RecordedFrame, write_bag
from reflest_core.synbrdf.exposure import auto_exposure, expose
from reflest_core.synbrdf.full_image import FullImageRenderer
from reflest_core.synbrdf.mitsuba_scene import RadianceTracer, mitsuba_scene
from reflest_core.synbrdf.sequence_scene import (
    SequenceRefused,
    SequenceRequest,
    SequenceScene,
    draw_sequence_scene,
)
from reflest_core.synbrdf.sequence_truth import write_truth
from reflest_core.synbrdf.sparse_scene import camera_rays
from reflest_core.synbrdf.thumbnails import THUMBNAIL
from reflest_core.synbrdf.ward_bsdf import ward_bsdf

FOCAL_LENGTH = 525.0 / 640.0
"""Of the image's width: a VGA depth camera's view."""
START_NS = 1_750_000_000 * 10**9
"""Stamp of the first frame, the same in every sequence."""
EXPOSED_FRAMES = 16
"""Spread over the sequence; they meter the exposure that all frames share."""


def write_sequence(out: Path, request: SequenceRequest, command: str) -> None:
    """Write the bag folder ``out``, whole or not at all; the same request gives the same bytes.

    Raises:
        SequenceRefused: if ``out`` exists.
    """
    if out.exists():
        raise SequenceRefused(f"{out} exists: delete it or choose another --out")
    scene = draw_sequence_scene(request)
    rendered = mitsuba_scene(scene.mesh, ward_bsdf(scene.material), scene.light.radiance)
    exposure = auto_exposure(_metered(rendered, scene, request.seed))
    workplace = out.with_name(f".{out.name}.partial")
    shutil.rmtree(workplace, ignore_errors=True)
    workplace.mkdir(parents=True)
    # The storage file is named after its folder, so that has its final name from the start.
    unfinished = workplace / out.name
    try:
        frames = _frames(rendered, scene, request, exposure)
        progress = tqdm(frames, total=request.frames, unit="frame")
        write_bag(unfinished, camera_of(request), progress)
        write_truth(unfinished, request, scene, exposure, command)
        os.replace(unfinished, out)
    finally:
        shutil.rmtree(workplace)


def camera_of(request: SequenceRequest) -> CameraIntrinsics:
    """The pinhole camera that films a sequence."""
    focal = FOCAL_LENGTH * request.width
    centre = (0.5 * (request.width - 1), 0.5 * (request.height - 1))
    return CameraIntrinsics(request.width, request.height, focal, focal, *centre)


def _metered(rendered: Any, scene: SequenceScene, seed: int) -> np.ndarray[Any, Any]:
    """Radiance (..., 3) of small images of some frames."""
    chosen = np.unique(np.linspace(0, len(scene.poses) - 1, EXPOSED_FRAMES).round().astype(int))
    origins, directions = camera_rays(THUMBNAIL, scene.poses[chosen])
    return RadianceTracer(4, lanes=1 << 17).trace(rendered, origins, directions, _seed(seed, 0))


def _frames(
    rendered: Any, scene: SequenceScene, request: SequenceRequest, exposure: float
) -> Iterator[RecordedFrame]:
    renderer = FullImageRenderer(camera_of(request), request.samples)
    for index, pose in enumerate(scene.poses):
        seed = _seed(request.seed, index + 1)
        image = renderer.render(rendered, scene.light.radiance, pose, seed)
        yield RecordedFrame(
            stamp_ns=START_NS + round(index * 1e9 / request.rate),
            rgb=expose(image.radiance, exposure),
            depth_mm=np.rint(image.depth * 1000.0).astype(np.uint16),
            pose=pose,
        )


def _seed(seed: int, frame: int) -> int:
    return int(np.random.SeedSequence([seed, frame]).generate_state(1)[0] >> 1)
