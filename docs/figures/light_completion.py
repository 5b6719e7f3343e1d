# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The picture in docs/lightnet.md: one scene's light as seen, filled, completed, and as it was.

python docs/figures/light_completion.py DATA ENVIRONMENTS docs/images/lightnet-light.png
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.inference.material import explain
from reflest_core.light.equirectangular import equirectangular_directions
from reflest_core.light.octahedral import octahedral_texels
from reflest_core.synbrdf.lights.environments import find_environments, load_environment, rotated
from reflest_core.synbrdf.relit.scene_light import scene_light
from reflest_core.synbrdf.scenes.scene_file import load_scenes

HEIGHT = 96
DARKER = 0.25
"""Of the pictures to the sensor's exposure, so that light beyond its white can be recognised."""


def lat_long(octahedral: NDArray[np.float32]) -> NDArray[np.float32]:
    """(N, N, C) looked up as (96, 192, C)."""
    size = len(octahedral)
    texels = octahedral_texels(equirectangular_directions(HEIGHT), size)
    return octahedral.reshape(size * size, -1)[texels]


def main() -> None:
    """Draw the picture, and print what the fit makes of the albedo."""
    parser = argparse.ArgumentParser(description="The light of one scene, as a picture.")
    parser.add_argument("data", type=Path, help="a SynBRDF folder")
    parser.add_argument("environments", type=Path, help="folder of the maps it was rendered under")
    parser.add_argument("out", type=Path)
    parser.add_argument("--scene", type=int, default=1, help="of the training split")
    arguments = parser.parse_args()
    scenes = load_scenes(arguments.data, "train")
    scene = next(scene for scene in scenes if scene.index == arguments.scene)
    light = scene_light(scene, np.arange(len(scene.surface.view_centres)))
    found = explain(scene.surface, light)
    source = {source.name: source for source in find_environments(arguments.environments)}
    truth = rotated(load_environment(source[scene.environment]), scene.environment_rotation)
    pictures = {
        f"as seen ({100 * light.seen_share:.0f} % of the sphere)": lat_long(
            light.radiance * light.coverage[..., None]
        ),
        "filled smoothly": lat_long(found.filled.levels[0])[..., :3],
        "completed by what the surface sends back": lat_long(found.light.levels[0])[..., :3],
        "the light itself": truth * scene.exposure,
    }
    figure, axes = plt.subplots(2, 2, figsize=(9, 5), layout="constrained")
    for axis, (title, radiance) in zip(axes.ravel(), pictures.items(), strict=True):
        axis.imshow(srgb.encode(np.clip(radiance * DARKER, 0.0, 1.0)))
        axis.set_title(title, fontsize=10)
        axis.axis("off")
    figure.savefig(arguments.out, dpi=110)
    albedo = np.round(found.inferred[1].albedo, 3)
    truth = np.round(scene.materials.dominant.ward.rho_d, 3)
    print(f"rho_d {truth}, by the fit {albedo}, {scene.view_pattern}")


if __name__ == "__main__":
    main()
