# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Renders an RGB-D sequence into a rosbag2 directory with its truth beside it.

Importing this module loads Mitsuba.
"""

from __future__ import annotations

from pathlib import Path

from tqdm import tqdm

from reflest_core.synbrdf.path_tracing.mitsuba_scene import mitsuba_scene
from reflest_core.synbrdf.path_tracing.ward_bsdf import ward_bsdf
from reflest_core.synbrdf.sequences.bag_writer import write_bag
from reflest_core.synbrdf.sequences.filming import Film, FilmSettings, Stage
from reflest_core.synbrdf.sequences.sequence_scene import (
    SequenceRefused,
    SequenceRequest,
    draw_sequence_scene,
)
from reflest_core.synbrdf.sequences.sequence_truth import write_truth
from reflest_core.whole_file import whole_folder


def write_sequence(out: Path, request: SequenceRequest, command: str) -> None:
    """Write a bag folder; the same request gives the same bytes.

    Args:
        out: folder to make.
        request: what to render.
        command: the command line, for the truth.

    Raises:
        SequenceRefused: The folder exists.
        OutputError: It cannot be written.
    """
    if out.exists():
        raise SequenceRefused(f"{out} exists: delete it or choose another --out")
    scene = draw_sequence_scene(request)
    rendered = mitsuba_scene(scene.mesh, ward_bsdf(scene.material), scene.light.radiance)
    settings = FilmSettings(
        request.seed, request.width, request.height, request.samples, request.rate, request.realism
    )
    film = Film(Stage(rendered, scene.light.radiance, scene.poses), settings)
    with whole_folder(out) as unfinished:
        progress = tqdm(film.frames(), total=request.frames, unit="frame")
        write_bag(unfinished, film.camera, progress)
        write_truth(unfinished, request, scene, film.exposure, command)
