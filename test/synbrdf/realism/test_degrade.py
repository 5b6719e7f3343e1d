# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Each fault of a real capture does to a sparse scene what it does to a capture."""

import dataclasses

import numpy as np
import pytest

from reflest_core.brdf import srgb
from reflest_core.light import rgbe
from reflest_core.synbrdf.realism.degrade import degrade
from reflest_core.synbrdf.realism.settings import Effect, Realism, RealismError, parse_effects
from reflest_core.synbrdf.scenes.exposure import expose
from test.synbrdf.realism.sparse_scenes import EXPOSURE, ball_scene


def rng(seed=1):
    return np.random.default_rng(seed)


def arrays(scene):
    held = {f"surface.{k}": v for k, v in vars(scene.surface).items()}
    held |= {f"thumbnails.{k}": v for k, v in vars(scene.thumbnails).items()}
    return {**held, "radiance": scene.radiance}


def changed(before, after):
    old, new = arrays(before), arrays(after)
    return {k for k in old if not np.array_equal(old[k], new[k])}


@pytest.fixture(scope="module")
def scene():
    return ball_scene()


def test_a_perfect_camera_changes_nothing(scene):
    assert changed(scene, degrade(scene, Realism.only([]), rng())) == set()


def test_equal_seeds_give_equal_scenes(scene):
    one, same, other = (degrade(scene, Realism(), rng(seed)) for seed in (1, 1, 2))
    assert changed(one, same) == set()
    assert len(changed(one, other)) > 8
    assert one.materials is scene.materials
    assert one.exposure == scene.exposure


COLOURS = {"surface.colours"}
MEANS = {"surface.view_foreground", "surface.view_background"}
DRIFT = COLOURS | MEANS | {"thumbnails.rgbe", "radiance"}


@pytest.mark.parametrize(
    ("effect", "touched"),
    [
        (Effect.EXPOSURE, DRIFT),
        (Effect.WHITE_BALANCE, DRIFT),
        (Effect.SENSOR, COLOURS),
        (Effect.JPEG, COLOURS),
        (Effect.DEPTH, COLOURS | {"surface.offsets", "surface.view_indices", "radiance"}),
        (Effect.POSE, {"surface.view_centres", "thumbnails.T_world_camera"}),
        (Effect.NORMALS, {"surface.positions", "surface.normals"}),
    ],
)
def test_an_effect_touches_what_it_should(scene, effect, touched):
    after = degrade(scene, Realism.only([effect]), rng())
    # F and B are averaged again, through a table of the sRGB curve.
    for name in MEANS:
        np.testing.assert_allclose(
            arrays(after)[name], arrays(scene)[name], atol=60 if touched == DRIFT else 0.3
        )
    assert changed(scene, after) - MEANS == touched - MEANS


def test_one_effect_leaves_anothers_draws_alone(scene):
    alone = degrade(scene, Realism.only([Effect.POSE]), rng())
    together = degrade(scene, Realism(), rng())
    np.testing.assert_array_equal(alone.surface.view_centres, together.surface.view_centres)


def test_drift_scales_colours_thumbnails_and_means_alike(scene):
    after = degrade(scene, Realism.only([Effect.EXPOSURE, Effect.WHITE_BALANCE]), rng(3))
    surface = after.surface
    gains = after.radiance.astype(float) / scene.radiance.astype(float)
    by_view = np.stack(
        [
            np.median(gains[surface.view_indices == w], axis=0)
            for w in range(len(surface.view_centres))
        ]
    )
    # Green shows the exposure alone; neighbouring views are alike, far ones are not.
    assert np.ptp(np.log2(by_view[:, 1])) > 0.1
    assert np.abs(np.diff(np.log(by_view[:, 0] / by_view[:, 1]))).max() < 0.05
    np.testing.assert_allclose(gains, by_view[surface.view_indices], rtol=3e-3)
    np.testing.assert_allclose(
        surface.colours, expose(after.radiance.astype(np.float32), EXPOSURE), atol=1
    )
    before, now = rgbe.decode(scene.thumbnails.rgbe), rgbe.decode(after.thumbnails.rgbe)
    np.testing.assert_allclose((now / before).mean(axis=(1, 2)), by_view, rtol=0.01)
    shown = expose(now, EXPOSURE)
    for view in (0, 7, 20):
        inside = scene.thumbnails.is_object[view]
        f, b = surface.view_foreground[view], surface.view_background[view]
        np.testing.assert_allclose(shown[view][inside].mean(axis=0), f, atol=0.6)
        np.testing.assert_allclose(shown[view][~inside].mean(axis=0), b, atol=0.6)


def test_auto_exposure_makes_up_for_bright_views(scene):
    images = scene.thumbnails.radiance()
    images[:15] *= 4.0
    lit = dataclasses.replace(
        scene, thumbnails=dataclasses.replace(scene.thumbnails, rgbe=rgbe.encode(images))
    )
    only_metering = dataclasses.replace(Realism.only([]), metering=0.6)
    after = degrade(lit, only_metering, rng(5))
    gains = after.radiance.astype(float)[:, 1] / lit.radiance.astype(float)[:, 1]
    bright = after.surface.view_indices < 15
    ratio = np.median(gains[~bright]) / np.median(gains[bright])
    assert 1.02 < ratio < 4**0.6 + 0.01


def test_noise_has_the_stated_variance_and_grows_with_light():
    scene = ball_scene(points=2000, views=40)
    realism = dataclasses.replace(Realism.only([]), shot_noise=0.04, read_noise=0.006)
    signal = scene.radiance.astype(float) * EXPOSURE
    ratios = []
    for seed in range(30):
        after = degrade(scene, realism, rng(seed))
        noisy = srgb.decode(after.surface.colours / 255.0)
        error = noisy - signal
        expected = np.sqrt(0.04**2 * signal + 0.006**2)
        bright, dark = signal > 0.3, signal < 0.1
        ratios.append(error[bright].std() / expected[bright].mean())
        assert error[bright].std() > 1.4 * error[dark].std()
    # A scene's gain is even in [0, 1].
    assert max(ratios) == pytest.approx(0.97, abs=0.05)
    assert np.mean(ratios) == pytest.approx(0.5, abs=0.15)


def test_grazed_points_lose_observations_first(scene):
    surface = scene.surface
    after = degrade(scene, Realism.only([Effect.DEPTH]), rng(4)).surface
    assert 0 < len(after.colours) < len(surface.colours)

    def cosines(of):
        point_of = np.repeat(np.arange(of.voxel_count), of.observation_counts)
        return np.einsum("ij,ij->i", of.view_directions(), of.normals[point_of])

    kept = [np.sum(cosines(s) < 0.3) for s in (after, surface)]
    straight = [np.sum(cosines(s) > 0.8) for s in (after, surface)]
    assert kept[0] / kept[1] < 0.9
    assert straight[0] / straight[1] > 0.99
    assert after.offsets[-1] == len(after.colours) == len(after.view_indices)


def test_normals_tilt_by_degrees_and_stay_unit(scene):
    angles = []
    for seed in range(20):
        after = degrade(scene, Realism.only([Effect.NORMALS]), rng(seed)).surface
        np.testing.assert_allclose(np.linalg.norm(after.normals, axis=1), 1.0, atol=1e-6)
        cosine = np.einsum("ij,ij->i", after.normals, scene.surface.normals)
        angles.append(np.rad2deg(np.arccos(np.clip(cosine, -1, 1))).mean())
    assert max(angles) < 10.0
    assert np.ptp(angles) > 1.0


def test_poses_stay_rigid_and_near(scene):
    after = degrade(scene, Realism.only([Effect.POSE]), rng())
    poses = after.thumbnails.T_world_camera
    np.testing.assert_array_equal(poses[:, :3, 3], after.surface.view_centres)
    rotations = poses[:, :3, :3]
    np.testing.assert_allclose(
        rotations @ rotations.transpose(0, 2, 1),
        np.broadcast_to(np.eye(3), rotations.shape),
        atol=1e-5,
    )
    moved = np.linalg.norm(poses[:, :3, 3] - scene.thumbnails.T_world_camera[:, :3, 3], axis=1)
    assert 0 < moved.max() < 0.02


def test_effects_are_named():
    assert parse_effects(["pose", "exposure"]) == [Effect.EXPOSURE, Effect.POSE]
    assert parse_effects(["all"]) == list(Effect)
    with pytest.raises(RealismError, match="lens-flare"):
        parse_effects(["lens-flare"])
    with pytest.raises(RealismError, match="jpeg_quality"):
        Realism(jpeg_quality=101)
    with pytest.raises(RealismError, match="shot_noise"):
        Realism(shot_noise=float("nan"))
