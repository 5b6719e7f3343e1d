# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What an RGB-D sequence shows: everything that its seed and its user decide."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.parameters import WardParameters
from reflest_core.errors import ReflestError
from reflest_core.synbrdf.generation.data_set import SKIES
from reflest_core.synbrdf.lights.environments import (
    find_environments,
    load_environment,
    procedural_skies,
    rotated,
)
from reflest_core.synbrdf.path_tracing.path_counts import check_paths
from reflest_core.synbrdf.realism.settings import Realism
from reflest_core.synbrdf.scenes.material_sources import OPENSURFACES, Materials, NamedMaterial
from reflest_core.synbrdf.scenes.scene import Light
from reflest_core.synbrdf.sequences.trajectory import hand_held_orbit
from reflest_core.synbrdf.shapes.mesh import TriangleMesh
from reflest_core.synbrdf.shapes.mesh_file import find_meshes, load_mesh
from reflest_core.synbrdf.shapes.procedural import KINDS, draw_procedural, draw_rotation

ENVIRONMENT_HEIGHT = 256
"""Rows of the environment map: it is seen in the background, so finer than in sparse scenes."""
DIAMETERS = (0.22, 0.36)
"""Metres."""
_STREAM = 0x5E0
"""Keeps a sequence's random numbers apart from a sparse scene's of the same seed."""


class SequenceRefused(ReflestError):
    """A sequence was asked for that cannot be made."""


@dataclass(frozen=True)
class SequenceRequest:
    """What ``reflest synbrdf sequence`` was asked for; None lets the seed decide.

    Attributes:
        seed: Decides what nothing else decides.
        frames: Images.
        width: Pixels.
        height: Pixels.
        samples: Paths of a pixel, a multiple of 4.
        rate: Frames a second.
        material: Ward parameters.
        materials: What a material is drawn from.
        shape: Kind of procedural shape.
        environments: Files of environment maps; None for procedural skies.
        meshes: Files of meshes; None for procedural shapes.
        realism: The faults of a real camera; None for a perfect one.
    """

    seed: int
    frames: int = 60
    width: int = 640
    height: int = 480
    samples: int = 64
    rate: float = 10.0
    material: WardParameters | None = None
    materials: Materials = OPENSURFACES
    shape: str | None = None
    environments: Path | None = None
    meshes: Path | None = None
    realism: Realism | None = None

    def __post_init__(self) -> None:
        check_film(self.seed, self.frames, self.width, self.height, self.samples, self.rate)
        if self.shape is not None and self.shape not in KINDS:
            raise SequenceRefused(f"--shape is {self.shape}, but must be one of {', '.join(KINDS)}")
        if self.shape is not None and self.meshes is not None:
            raise SequenceRefused("--shape and --meshes exclude each other: give only one")
        if self.material is not None:
            check_material("--material", self.material)
            if self.materials != OPENSURFACES:
                raise SequenceRefused(
                    "--material and --materials exclude each other: give only one"
                )


def check_film(seed: int, frames: int, width: int, height: int, samples: int, rate: float) -> None:
    """Refuse numbers that no sequence can have.

    Args:
        seed: of the random numbers.
        frames: number of frames.
        width: pixels.
        height: pixels.
        samples: paths of a pixel or an observation.
        rate: frames a second.

    Raises:
        SequenceRefused: If one is outside its range.
        PathCountError: If the paths cannot be stratified.
    """
    bounds = {
        "seed": (seed, 0, 2**63),
        "frames": (frames, 2, 10_000),
        "width": (width, 16, 4096),
        "height": (height, 16, 4096),
        "samples": (samples, 4, 4096),
        "rate": (rate, 0.1, 1000.0),
    }
    for name, (value, low, high) in bounds.items():
        if not low <= value <= high:
            raise SequenceRefused(f"--{name} is {value}, but must be {low} to {high}")
    if samples % 4:
        raise SequenceRefused(f"--samples is {samples}, but must be a multiple of 4")
    check_paths(samples, rays=4)


def check_material(option: str, material: WardParameters) -> None:
    """Refuse a material that reflects more than it receives.

    Args:
        option: that gave it, for the sentence.
        material: Ward parameters, linear sRGB.

    Raises:
        SequenceRefused: If a value is outside its range.
    """
    rho_d, rho_s, alpha = material.rho_d, material.rho_s, material.alpha
    # Every value is compared, so that NaN passes nowhere.
    if not all(albedo >= 0.0 and albedo + rho_s <= 1.0 for albedo in rho_d) or not rho_s >= 0.0:
        raise SequenceRefused(
            f"{option} has rho_d {rho_d} and rho_s {rho_s}, but they must be 0 or more and the "
            "largest rho_d plus rho_s at most 1"
        )
    if not 1e-3 <= alpha <= 1.0:
        raise SequenceRefused(f"{option} has alpha {alpha}, but must have 0.001 to 1")


@dataclass(frozen=True)
class SequenceScene:
    """One object of one material under one light, and a camera's way round it."""

    material: WardParameters
    material_source: str
    material_name: str
    shape: str
    mesh: TriangleMesh
    light: Light
    poses: NDArray[np.float64]


def draw_sequence_scene(request: SequenceRequest) -> SequenceScene:
    """Draw the scene; choosing a material or a shape leaves the rest of it as it was.

    Args:
        request: the sequence that was asked for.
    """
    streams = np.random.SeedSequence([_STREAM, request.seed]).spawn(4)
    of_material, of_shape, of_light, of_views = map(np.random.default_rng, streams)
    mesh, name = _draw_shape(of_shape, request)
    material, source, material_name = _choose_material(of_material, request)
    return SequenceScene(
        material=material,
        material_source=source,
        material_name=material_name,
        shape=name,
        mesh=mesh,
        light=_draw_light(of_light, request.environments),
        poses=hand_held_orbit(of_views, request.frames, mesh.diameter),
    )


def _choose_material(
    rng: np.random.Generator, request: SequenceRequest
) -> tuple[WardParameters, str, str]:
    if request.material is not None:
        drawn = NamedMaterial.given(request.material)
    else:
        drawn = request.materials.draw(rng)
    return drawn.ward, drawn.source.value, drawn.name


def _draw_shape(rng: np.random.Generator, request: SequenceRequest) -> tuple[TriangleMesh, str]:
    if request.meshes is None:
        mesh, name = draw_procedural(rng, request.shape)
    else:
        sources = find_meshes(request.meshes)
        source = sources[int(rng.integers(len(sources)))]
        mesh, name = load_mesh(source), source.name
    return mesh.moved(draw_rotation(rng, upright=True), float(rng.uniform(*DIAMETERS))), name


def _draw_light(rng: np.random.Generator, environments: Path | None) -> Light:
    sources = procedural_skies(SKIES) if environments is None else find_environments(environments)
    source = sources[int(rng.integers(len(sources)))]
    angle = float(rng.uniform(0.0, 2.0 * np.pi))
    radiance = rotated(load_environment(source, ENVIRONMENT_HEIGHT), angle)
    return Light(source.name, angle, radiance)
