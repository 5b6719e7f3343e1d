# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Equal seeds draw the scenes that they have always drawn, whatever lightings are added."""

import pytest

from reflest_core.synbrdf.lights.environments import procedural_skies
from reflest_core.synbrdf.scenes.scene import Lighting, draw_scene
from reflest_core.synbrdf.scenes.splits import Sources, Split

NATURAL, DIVERSE = Lighting.NATURAL, Lighting.DIVERSE
DRAWN = {
    (Split.TRAIN, 7, NATURAL): (
        ("sweep", "orbit", "sky-1+sky-0"),
        (0.2294769100150387, 0.021138930708024764, 0.11362918380252611, 4.365806975095037),
        (0.45047554947132085, 0.34152123615614804, 0.10876153286060314),
    ),
    (Split.UNSEEN, 2, NATURAL): (
        ("lathe", "cap", "sky-0"),
        (0.08385768254546626, 0.03697177388286411, 0.1647726902738027, 6.1069412221703185),
        (1.067777003770819, 0.494867748431732, 1.0258211078943045),
    ),
    (Split.TRAIN, 7, DIVERSE): (
        ("lathe", "orbit", "diverse+sky-0+sky-1"),
        (0.29287366265700077, 0.7071263373429992, 0.035722665892599856, 0.0),
        (1.0878033933300155, 0.3134232913182989, -0.9854737166511043),
    ),
}
"""Words; rho_d's red, rho_s, alpha, the light's turn; its mean, the diameter, a camera's y: all as
the code drew them before there were rooms, but the names of what diverse light mixes."""


@pytest.mark.parametrize("which", DRAWN)
def test_far_light_is_drawn_as_before(which):
    split, index, lighting = which
    scene = draw_scene(5, split, index, Sources(procedural_skies(3), []), 6, lighting)
    words, material, rest = DRAWN[which]
    truth, light = scene.painted.dominant.ward, scene.light
    assert (scene.shape, scene.view_pattern, light.name) == words
    drawn = truth.rho_d[0], truth.rho_s, truth.alpha, light.rotation
    assert drawn == pytest.approx(material, rel=1e-9)
    found = light.radiance.mean(dtype=float), scene.mesh.diameter, scene.poses[4, 1, 3]
    assert found == pytest.approx(rest, rel=1e-5)
    assert scene.room is None
