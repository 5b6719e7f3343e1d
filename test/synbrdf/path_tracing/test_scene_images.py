# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Full images of the data set's scenes against its sparse observations of the same pixels."""

import json

import cv2
import numpy as np
import pytest

pytest.importorskip("mitsuba")

from reflest_core.capture.open_capture import open_capture
from reflest_core.cli.main import main
from reflest_core.light.environment_reader import read_radiance
from reflest_core.synbrdf.generation.data_set import Generation
from reflest_core.synbrdf.path_tracing.sparse_scene import SparseRenderer, SparseSettings
from reflest_core.synbrdf.realism.degrade import degrade
from reflest_core.synbrdf.realism.settings import Realism
from reflest_core.synbrdf.scenes.exposure import expose
from reflest_core.synbrdf.scenes.seeding import Purpose, generator
from reflest_core.synbrdf.scenes.splits import Split

COUNTS = {"train": 4, "validation": 2, "unseen": 2}
VIEWS, WIDTH, HEIGHT = 8, 320, 240
FRAMES = [1, 4, 7]
OPTIONS = ["--seed", "3", "--views", str(VIEWS), "--width", str(WIDTH), "--height", str(HEIGHT)]
OPTIONS += ["--samples", "64", "--frames", "1:8:3", "--split", "validation", "--scenes", "1"]
OPTIONS += [word for name, count in COUNTS.items() for word in (f"--{name}", str(count))]


@pytest.fixture(scope="module")
def images(tmp_path_factory):
    out = tmp_path_factory.mktemp("images")
    assert main(["synbrdf", "images", "--out", str(out), *OPTIONS]) == 0
    return out / "validation-00001"


@pytest.fixture(scope="module")
def sparse():
    generation = Generation(3, COUNTS, views=VIEWS)
    renderer = SparseRenderer(SparseSettings(points=400, views=VIEWS, samples=256))
    return renderer.render(generation.scene(Split.VALIDATION, 1), generation.seed)


def image(folder, view, ending):
    path = folder / f"frame-{view:06d}{ending}"
    return read_radiance(path).radiance if ending.endswith("exr") else cv2.imread(str(path), -1)


def pixels_of(sparse, view, pose):
    """Observations of a view: their rows, the pixels that they lie in, depths and normals."""
    surface = sparse.surface
    rows = np.nonzero(surface.view_indices == view)[0]
    point_of = np.repeat(np.arange(surface.voxel_count), surface.observation_counts)[rows]
    local = (surface.positions[point_of] - pose[:3, 3]) @ pose[:3, :3]
    focal = 525 / 640 * WIDTH
    u = local[:, 0] / local[:, 2] * focal + (WIDTH - 1) / 2
    v = local[:, 1] / local[:, 2] * focal + (HEIGHT - 1) / 2
    pixel = np.rint(np.stack([v, u], axis=1)).astype(int)
    inside = (pixel >= 0).all(axis=1) & (pixel < [HEIGHT, WIDTH]).all(axis=1)
    return rows[inside], pixel[inside].T, local[inside, 2], surface.normals[point_of][inside]


@pytest.mark.parametrize("view", FRAMES)
def test_sparse_observations_are_the_pixels_of_full_images(images, sparse, view):
    pose = np.loadtxt(images / f"frame-{view:06d}.pose.txt")
    np.testing.assert_allclose(pose, sparse.thumbnails.T_world_camera[view], atol=1e-6)
    rows, pixel, z, normals = pixels_of(sparse, view, pose)
    assert len(rows) > 50
    depth = image(images, view, ".depth.png")[tuple(pixel)] / 1000.0
    # Half a pixel to the side a slanted surface is deeper.
    assert np.quantile(np.abs(depth - z), 0.9) < 4e-3
    shown = image(images, view, ".normal.exr")[tuple(pixel)]
    assert np.median(np.einsum("ij,ij->i", shown, normals)) > 0.998
    radiance = image(images, view, ".hdr.exr")[tuple(pixel)]
    expected = sparse.radiance[rows].astype(np.float32)
    error = np.abs(radiance - expected) / (expected + 0.02 * expected.mean())
    assert np.median(error) < 0.05
    colour = image(images, view, ".color.png")[..., ::-1][tuple(pixel)]
    assert np.median(np.abs(colour.astype(int) - sparse.surface.colours[rows])) <= 4


def test_files_of_a_view_agree_with_each_other(images):
    card = json.loads((images / "scene.json").read_text())
    for view in FRAMES:
        hdr, normal = (image(images, view, f".{kind}.exr") for kind in ("hdr", "normal"))
        mask, depth = (image(images, view, f".{kind}.png") for kind in ("mask", "depth"))
        assert hdr.shape == normal.shape == (HEIGHT, WIDTH, 3)
        assert (mask.dtype, depth.dtype) == (np.uint8, np.uint16)
        assert set(np.unique(mask)) == {0, 255}
        np.testing.assert_array_equal(mask == 255, depth > 0)
        length = np.linalg.norm(normal, axis=-1)
        np.testing.assert_allclose(length, mask / 255.0, atol=1e-5)
        colour = image(images, view, ".color.png")[..., ::-1]
        np.testing.assert_array_equal(colour, expose(hdr, card["exposure"]))


def test_the_card_holds_the_truth_and_the_sparse_exposure(images, sparse):
    card = json.loads((images / "scene.json").read_text())
    assert card["rho_d"] == list(sparse.materials.dominant.ward.rho_d)
    assert (card["rho_s"], card["alpha"]) == (
        sparse.materials.dominant.ward.rho_s,
        sparse.materials.dominant.ward.alpha,
    )
    assert card["exposure"] == sparse.exposure
    assert card["views"] == FRAMES
    assert card["environment"] == sparse.environment


def test_our_own_reader_takes_a_folder(images):
    frames = list(open_capture(images))
    assert len(frames) == len(FRAMES)
    assert frames[0].rgb.shape == (HEIGHT, WIDTH, 3)
    assert frames[0].intrinsics.fx == pytest.approx(525 / 640 * WIDTH)


def test_realism_is_that_of_the_sparse_scene(images, sparse, tmp_path):
    words = ["--out", str(tmp_path), *OPTIONS, "--realism"]
    assert main(["synbrdf", "images", *words]) == 0
    folder = tmp_path / images.name
    rng = generator(3, Split.VALIDATION, 1, Purpose.REALISM)
    degraded = degrade(sparse, Realism(), rng)
    for view in FRAMES:
        pose = np.loadtxt(folder / f"frame-{view:06d}.pose.txt")
        np.testing.assert_allclose(pose, degraded.thumbnails.T_world_camera[view], atol=1e-6)
        # The same drift: where the background is seen, F and B aside, colours scale alike.
        clean, shown = image(images, view, ".color.png"), image(folder, view, ".color.jpg")
        off = image(images, view, ".mask.png") == 0
        means = shown[off].mean(axis=0)[::-1]
        np.testing.assert_allclose(means, degraded.surface.view_background[view], rtol=0.15, atol=6)
        assert not np.array_equal(clean, shown)
        np.testing.assert_array_equal(
            image(folder, view, ".hdr.exr"), image(images, view, ".hdr.exr")
        )
        depth, truth = image(folder, view, ".depth.png"), image(images, view, ".depth.png")
        assert (depth == 0).sum() > (truth == 0).sum()


def test_a_folder_that_is_there_is_kept_or_refused(images, capsys):
    before = {path.name: path.stat().st_mtime_ns for path in images.iterdir()}
    out = ["--out", str(images.parent)]
    assert main(["synbrdf", "images", *out, *OPTIONS]) == 0
    assert main(["synbrdf", "images", *out, *OPTIONS, "--frames", "0"]) == 2
    assert "made with other options" in capsys.readouterr().err
    assert {path.name: path.stat().st_mtime_ns for path in images.iterdir()} == before
