# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The table in docs/lightnet.md: what the physics finds by itself, before any network.

python docs/figures/fits_against_truth.py DATA [--every 24] [--panorama ENVIRONMENTS]
"""

import argparse
import dataclasses
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.environment.room import Room
from reflest_core.inference.material import Explanation, explain
from reflest_core.inference.transport.ward_lobe import ROUGHNESSES
from reflest_core.surface.selection import keep_views
from reflest_core.synbrdf.lights.environments import find_environments, load_environment, rotated
from reflest_core.synbrdf.relit.scene_light import scene_light
from reflest_core.synbrdf.scenes.scene_file import load_scenes

LEAST = 0.02
"""Albedos below it count as it in logarithms."""
GLOSSY = 0.2
"""``rho_s`` above which roughness is asked for."""
OVEREXPOSED = 1 / 3
"""Share of the observations with a channel at 255."""
FITS = ("diffuse colours", "observations with their gloss", "the same, unseen light dim")


def row(name: str, found: NDArray[np.float64], truth: NDArray[np.float64]) -> str:
    """Errors of ``rho_d`` (S, 3) as a line of the table."""
    found = np.clip(found, 0.0, 1.0)
    logs = np.log(np.maximum(found, LEAST) / np.maximum(truth, LEAST))
    rms = np.sqrt(((found - truth) ** 2).mean())
    correlation = np.corrcoef(found.ravel(), truth.ravel())[0, 1]
    return f"| {name} | {rms:.3f} | {np.median(np.abs(logs)):.2f} | {correlation:.2f} |"


def main() -> None:
    """Explain some training scenes, half of them from 20 views, and compare."""
    parser = argparse.ArgumentParser(description="What the physics finds by itself.")
    parser.add_argument("data", type=Path, help="a SynBRDF folder")
    parser.add_argument("--every", type=int, default=48, help="of the training scenes")
    parser.add_argument(
        "--panorama",
        type=Path,
        help="environments: all of the light is known, in high dynamic range",
    )
    arguments = parser.parse_args()
    lights = {}
    if arguments.panorama is not None:
        lights = {source.name: source for source in find_environments(arguments.panorama)}
    truths, found, overexposed = [], [], []
    for number, scene in enumerate(
        islice(load_scenes(arguments.data, "train"), 0, None, arguments.every)
    ):
        views = np.arange(len(scene.surface.view_centres))
        if number % 2:
            views = np.sort(np.random.default_rng(scene.index).permutation(views)[:20])
        light = scene_light(scene, views)
        if lights:
            if scene.environment not in lights:
                continue  # mixed of two: no file holds it
            room = rotated(load_environment(lights[scene.environment]), scene.environment_rotation)
            light = Room.of("panorama", room).known_light().joined(light).light
        surface = dataclasses.replace(keep_views(scene.surface, views), light=light)
        found.append(explain(surface, light))
        overexposed.append((surface.colours == 255).any(axis=1).mean())
        truth = scene.materials.dominant.ward
        truths.append([*truth.rho_d, truth.rho_s, truth.alpha])
    truth = np.array(truths)
    print(f"{len(truth)} scenes\n\n| rho_d by | RMS error | median error of its logarithm | r |")
    print("|---|---|---|---|")
    for number, name in enumerate(FITS):
        print(row(name, np.array([one.inferred[number].albedo for one in found]), truth[:, :3]))
    is_dark = np.array(overexposed) < OVEREXPOSED
    by_gloss = np.array([one.inferred[1].albedo for one in found])
    print(f"\n{FITS[1]}, {is_dark.sum()} scenes of which less than a third is overexposed:")
    print(row(FITS[1], by_gloss[is_dark], truth[is_dark, :3]))
    glossy = truth[:, 3] > GLOSSY
    gloss, roughness = (np.array(values) for values in zip(*map(_gloss, found), strict=True))
    errors = np.sqrt(((gloss - truth[:, 3]) ** 2).mean())
    rough = np.sqrt(((roughness - truth[:, 4])[glossy] ** 2).mean())
    print(f"\nrho_s, from seen light: RMS error {errors:.3f}")
    print(f"alpha, the same, where rho_s > {GLOSSY}: RMS error {rough:.3f}")


def _gloss(found: Explanation) -> tuple[float, float]:
    weight = found.gloss.weight
    return float(weight @ found.gloss.gloss), float(weight @ np.array(ROUGHNESSES))


if __name__ == "__main__":
    main()
