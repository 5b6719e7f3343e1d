# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What docs/lightnet.md says of light beyond white, and of the hue of light that was not seen.

python docs/figures/light_statistics.py DATA ENVIRONMENTS [--every 12]
"""

import argparse
from collections import defaultdict
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.environment.room import Room
from reflest_core.inference.light_prior import LEVEL
from reflest_core.light import rgbe
from reflest_core.light.completion import complete
from reflest_core.light.octahedral import octahedral_directions, octahedral_solid_angles
from reflest_core.synbrdf.lights.environments import find_environments, load_environment, rotated
from reflest_core.synbrdf.relit.scene_light import scene_light
from reflest_core.synbrdf.scenes.exposure import expose
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene, load_scenes

CHANNELS = ("red", "green", "blue")


def beyond_white(scene: SynbrdfScene) -> Iterator[tuple[int, int, NDArray[np.float64]]]:
    """Of background pixels by how many of their channels were clipped, and for each of these.

    How many, the channel, and by how much they pass white, in units of it.
    """
    radiance = rgbe.decode(scene.thumbnails.rgbe)[~scene.thumbnails.is_object]
    is_clipped = expose(radiance, scene.exposure) == 255
    count = is_clipped.sum(axis=1)
    for number in (1, 2, 3):
        for channel in range(3):
            chosen = (count == number) & is_clipped[:, channel]
            yield number, channel, np.maximum(radiance[chosen, channel] * scene.exposure - 1.0, 0.0)


def hue_above(scene: SynbrdfScene, panorama: NDArray[np.float32]) -> NDArray[np.float64] | None:
    """(3,): logarithm of unseen light above over its fill, beside the mean of the channels."""
    light = scene_light(scene, np.arange(len(scene.surface.view_centres)))
    size = len(light.coverage)
    is_chosen = (light.coverage == 0.0) & (octahedral_directions(size)[..., 2] > LEVEL)
    known = Room.of("panorama", panorama).known_light().joined(light)
    if known.problem or not is_chosen.any():
        return None
    weight = octahedral_solid_angles(size)[is_chosen][:, None]
    truth = (weight * known.light.radiance[is_chosen]).sum(axis=0)
    fill = (weight * complete(light).levels[0][is_chosen, :3]).sum(axis=0)
    logs = np.log(truth / fill)
    return np.asarray(logs - logs.mean(), np.float64)


def main() -> None:
    """Print both, from every some training scene under one environment."""
    parser = argparse.ArgumentParser(description="Light beyond white, and unseen light's hue.")
    parser.add_argument("data", type=Path, help="a SynBRDF folder")
    parser.add_argument("environments", type=Path, help="those that it was generated with")
    parser.add_argument("--every", type=int, default=12, help="of the training scenes")
    arguments = parser.parse_args()
    lights = {source.name: source for source in find_environments(arguments.environments)}
    excess, hues = defaultdict(list), defaultdict(list)
    for scene in islice(load_scenes(arguments.data, "train"), 0, None, arguments.every):
        if scene.environment not in lights:
            continue  # mixed of two: no file holds it
        for number, channel, values in beyond_white(scene):
            excess[number, channel].append(values)
        room = load_environment(lights[scene.environment])
        hue = hue_above(scene, rotated(room, scene.environment_rotation))
        if hue is not None:
            hues[scene.environment].append(hue)
    print("| channels clipped | in | pixels | mean beyond white |\n|---|---|---|---|")
    for (number, channel), parts in sorted(excess.items()):
        values = np.concatenate(parts)
        print(f"| {number} | {CHANNELS[channel]} | {len(values)} | {values.mean():.2f} |")
    # A pixel counts once, whichever of its channels were clipped.
    pixels = {
        number: sum(len(values) for channel in range(3) for values in excess[number, channel])
        / number
        for number in (1, 2, 3)
    }
    print(f"\nnot clipped in all three: {1 - pixels[3] / sum(pixels.values()):.0%} of the clipped")
    mean = np.mean([np.mean(found, axis=0) for found in hues.values()], axis=0)
    print(f"\nhue of unseen light above, {len(hues)} lights: {np.exp(mean).round(2).tolist()}")


if __name__ == "__main__":
    main()
