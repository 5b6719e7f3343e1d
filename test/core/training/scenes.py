"""Scenes whose colours simply are the material, so that a network can learn them in a moment."""

import numpy as np

from reflest_core.training.sample import Sample
from test.core.surfaces import sphere_surface


def learnable_samples(count, seed):
    rng = np.random.default_rng(seed)
    samples = []
    for _ in range(count):
        ward = np.array([*rng.uniform(0, 0.8, 3), rng.uniform(0, 0.2), rng.uniform(0.01, 0.2)])
        surface = sphere_surface(60, 30, seed=int(rng.integers(1000)))
        surface.colours[:] = np.round(ward[:3] * 255)
        samples.append(Sample(surface, ward))
    return samples
