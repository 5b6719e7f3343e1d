# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Renders a tabletop into a bag with its truth beside it. Importing this module loads Mitsuba."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.synbrdf.generation.data_set import SKIES
from reflest_core.synbrdf.lights.environments import find_environments, procedural_skies
from reflest_core.synbrdf.path_tracing.mitsuba_scene import TABLETOP_DEPTH, mitsuba_scene
from reflest_core.synbrdf.path_tracing.sight import in_image, visible_pairs
from reflest_core.synbrdf.realism.settings import Realism
from reflest_core.synbrdf.room.room_scene import RoomBuilder
from reflest_core.synbrdf.scenes.material_sources import OPENSURFACES, Materials
from reflest_core.synbrdf.scenes.splits import Sources
from reflest_core.synbrdf.scenes.surface_points import draw_surface_points
from reflest_core.synbrdf.sequences.bag_writer import write_bag
from reflest_core.synbrdf.sequences.filming import Film, FilmSettings, Stage
from reflest_core.synbrdf.sequences.sequence_scene import (
    SequenceRefused,
    check_film,
    check_material,
)
from reflest_core.synbrdf.shapes.mesh_file import find_meshes
from reflest_core.synbrdf.shapes.procedural import KINDS
from reflest_core.synbrdf.tabletop.face_ward_bsdf import face_ward_bsdf
from reflest_core.synbrdf.tabletop.ground import Setting
from reflest_core.synbrdf.tabletop.tabletop_scene import (
    TabletopChoices,
    TabletopLight,
    TabletopScene,
    draw_tabletop,
)
from reflest_core.synbrdf.tabletop.truth import material_cards, truth_points, write_truth
from reflest_core.whole_file import whole_folder

TRUTH_POINTS, TRUTH_RANGE = 200_000, (1000, 10_000_000)
_STREAM = 0x7AB1
"""Keeps a tabletop's random numbers apart from other scenes' of the same seed."""


@dataclass(frozen=True)
class TabletopRequest:
    """What ``reflest synbrdf tabletop`` was asked for.

    Attributes:
        seed: Decides what nothing else decides.
        frames: Images.
        width: Pixels.
        height: Pixels.
        samples: Paths of a pixel, a multiple of 4.
        rate: Frames a second.
        materials: What materials are drawn from.
        choices: Setting and lighting.
        environments: Files of environment maps; None for procedural skies.
        meshes: Files of meshes; None for procedural shapes alone.
        realism: The faults of a real camera; None for a perfect one.
        truth_points: Points spread over all surfaces; the truth holds those that are seen.
    """

    seed: int
    frames: int = 48
    width: int = 640
    height: int = 480
    samples: int = 32
    rate: float = 10.0
    materials: Materials = OPENSURFACES
    choices: TabletopChoices = field(default_factory=TabletopChoices)
    environments: Path | None = None
    meshes: Path | None = None
    realism: Realism | None = None
    truth_points: int = TRUTH_POINTS

    def __post_init__(self) -> None:
        check_film(self.seed, self.frames, self.width, self.height, self.samples, self.rate)
        least, most = TRUTH_RANGE
        if not least <= self.truth_points <= most:
            raise SequenceRefused(
                f"--truth-points is {self.truth_points}, but must be {least} to {most}"
            )
        if self.choices.ground is not None:
            check_material("--table-material", self.choices.ground)
            if self.choices.setting is Setting.CORNER:
                raise SequenceRefused("--table-material needs a table, but --setting is corner")
        for thing in self.choices.objects:
            check_material("--object", thing.ward)
            if thing.shape not in KINDS:
                kinds = ", ".join(KINDS)
                raise SequenceRefused(f"--object is a {thing.shape}, but must be one of {kinds}")

    def scene(self) -> TabletopScene:
        """Draw the scene."""
        environments = (
            procedural_skies(SKIES)
            if self.environments is None
            else find_environments(self.environments)
        )
        meshes = [] if self.meshes is None else find_meshes(self.meshes)
        rng = np.random.default_rng([_STREAM, self.seed])
        sources = Sources(environments, meshes)
        return draw_tabletop(rng, sources, self.materials, self.frames, self.choices)


def write_tabletop(out: Path, request: TabletopRequest, command: str) -> None:
    """Write a bag folder; the same request gives the same bytes.

    Args:
        out: Folder to make.
        request: What to render.
        command: The command line, for the truth.

    Raises:
        SequenceRefused: The folder exists.
        OutputError: It cannot be written.
    """
    if out.exists():
        raise SequenceRefused(f"{out} exists: delete it or choose another --out")
    scene = request.scene()
    missing = len(request.choices.objects) - len(scene.shapes)
    if missing > 0:
        raise SequenceRefused(
            f"the table has no room for {missing} of the objects with --seed {request.seed}: "
            "give fewer, or another --seed"
        )
    rendered = mitsuba_tabletop(scene, request.seed)
    settings = FilmSettings(
        request.seed,
        request.width,
        request.height,
        request.samples,
        request.rate,
        request.realism,
        TABLETOP_DEPTH,
    )
    film = Film(Stage(rendered, scene.light.radiance, scene.poses, scene.room), settings)
    points = seen_points(scene, rendered, film.camera, request.seed, request.truth_points)
    with whole_folder(out) as unfinished:
        write_bag(unfinished, film.camera, tqdm(film.frames(), total=request.frames, unit="frame"))
        card = _card(request, scene, points, film.exposure, command)
        write_truth(unfinished, card, points)


def mitsuba_tabletop(scene: TabletopScene, seed: int) -> Any:
    """The scene as Mitsuba holds it: all its surfaces are one mesh.

    Args:
        scene: the scene.
        seed: of the random numbers.
    """
    bsdf, mesh = face_ward_bsdf(scene.painted), scene.painted.mesh
    if scene.room is None:
        return mitsuba_scene(mesh, bsdf, scene.light.radiance)
    return RoomBuilder().scene(mesh, bsdf, scene.room, seed % 2**31)


def seen_points(
    scene: TabletopScene,
    rendered: Any,
    camera: CameraIntrinsics,
    seed: int,
    count: int = TRUTH_POINTS,
) -> NDArray[np.void]:
    """Points spread evenly over the surfaces that at least one frame sees, with their truth.

    Args:
        scene: the scene.
        rendered: the Mitsuba scene.
        camera: intrinsics.
        seed: of the random numbers.
        count: points over all surfaces, seen or not.
    """
    rng = np.random.default_rng([_STREAM, seed, 1])
    positions, normals, faces = draw_surface_points(scene.painted.mesh, count, rng)
    views = np.zeros(len(positions), np.int64)
    for pose in scene.poses:
        within = np.flatnonzero(in_image(positions, camera, pose))
        centre = pose[None, :3, 3].astype(np.float32)
        seen, _ = visible_pairs(rendered, positions[within], normals[within], centre)
        views[within[seen]] += 1
    kept = views > 0
    return truth_points(scene.painted, positions[kept], normals[kept], faces[kept], views[kept])


def _card(
    request: TabletopRequest,
    scene: TabletopScene,
    points: NDArray[np.void],
    exposure: float,
    command: str,
) -> dict[str, Any]:
    return {
        "materials": material_cards(scene.painted, points),
        "material_source": request.materials.source.value,
        "setting": scene.setting.value,
        "light": _kind_of_light(request, scene).value,
        "shapes": scene.shapes,
        "environment": scene.light.name,
        "environment_rotation": scene.light.rotation,
        "exposure": exposure,
        "seed": request.seed,
        "frames": request.frames,
        "path_depth": TABLETOP_DEPTH,
        "true_poses": scene.poses.tolist(),
        "realism": None if request.realism is None else dataclasses.asdict(request.realism),
        "command": command,
    }


def _kind_of_light(request: TabletopRequest, scene: TabletopScene) -> TabletopLight:
    if scene.room is not None:
        return TabletopLight.NEAR
    return request.choices.light or TabletopLight.DISTANT
