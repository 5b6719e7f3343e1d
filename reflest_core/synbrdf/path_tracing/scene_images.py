# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Full images of scenes of the data set: what the sparse observations were taken from.

Importing this module loads Mitsuba.
"""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from reflest_core.brdf.gloss import to_labcd
from reflest_core.errors import ReflestError
from reflest_core.synbrdf.generation.data_set import Generation, Product
from reflest_core.synbrdf.path_tracing.full_image import FullImage, FullImageRenderer
from reflest_core.synbrdf.path_tracing.image_files import (
    write_depth,
    write_exr,
    write_mask,
    write_rgb,
)
from reflest_core.synbrdf.path_tracing.mitsuba_scene import PATH_DEPTH, TABLETOP_DEPTH
from reflest_core.synbrdf.path_tracing.sparse_scene import Overview, SparseRenderer, SparseSettings
from reflest_core.synbrdf.realism.camera_faults import CameraFaults, draw_camera_faults
from reflest_core.synbrdf.realism.settings import LOSSLESS, Effect, streams
from reflest_core.synbrdf.realism.view_images import meter
from reflest_core.synbrdf.scenes.exposure import expose
from reflest_core.synbrdf.scenes.metering import Metering, object_exposure
from reflest_core.synbrdf.scenes.scene import Scene
from reflest_core.synbrdf.scenes.seeding import Purpose, generator
from reflest_core.synbrdf.scenes.splits import Split
from reflest_core.synbrdf.scenes.views import depth_camera
from reflest_core.whole_file import whole_folder

INTRINSICS = "camera-intrinsics.txt"
SCENE = "scene.json"


class ImagesRefused(ReflestError):
    """There are other images in the place of those that were asked for."""


class SceneImages:
    """Writes folders of full images; the scenes are those of ``generation``, with its exposure.

    A folder is a 7-Scenes sequence (``frame-000000.color.png``, ``.depth.png`` in millimetres,
    ``.pose.txt`` camera to world, ``camera-intrinsics.txt``), which ``reflest replay`` reads, and
    beside it ``.hdr.exr`` (linear sRGB radiance), ``.normal.exr`` (world frame, 0 off the object),
    ``.mask.png`` and ``scene.json`` with the truth. With realism colour (a .jpg then), depth and
    pose have the faults that the sparse scene has; radiance, normals and mask stay true.
    """

    def __init__(self, generation: Generation, width: int, height: int, samples: int) -> None:
        """Prepare the renderer.

        Args:
            generation: the data set.
            width: pixels.
            height: pixels.
            samples: paths of a pixel.
        """
        self.generation = generation
        self.camera, self.samples = depth_camera(width, height), samples
        is_tabletop = generation.product is Product.TABLETOP
        depth = TABLETOP_DEPTH if is_tabletop else PATH_DEPTH
        self.renderer = FullImageRenderer(self.camera, samples, depth)
        self.sparse = SparseRenderer(SparseSettings(views=generation.views))

    def write(self, out: Path, split: Split, index: int, views: list[int]) -> Path:
        """Write some views of one scene into ``out/SPLIT-INDEX``, unless they are there.

        Args:
            out: folder of the scenes' folders.
            split: train, validation or unseen.
            index: of the scene within its split.
            views: indices of views.

        Raises:
            ImagesRefused: Other images are there.
            OutputError: They cannot be written.
        """
        folder = out / f"{split.value}-{index:05d}"
        scene = self.generation.scene(split, index)
        overview = self.overview(scene)
        card = json.dumps(self._card(scene, overview, views), indent=1) + "\n"
        if folder.exists():
            if _text(folder / SCENE) != card:
                raise ImagesRefused(
                    f"{folder} was made with other options: use the same or another --out"
                )
            return folder
        faults, noise = self.faults(scene, overview)
        with whole_folder(folder) as unfinished:
            unfinished.mkdir()
            np.savetxt(unfinished / INTRINSICS, self.camera.matrix, fmt="%.9g")
            for view in tqdm(views, desc=folder.name, unit="view", leave=False):
                image = self.render(scene, overview, view)
                self._write_frame(unfinished, view, image, scene, overview, faults, noise)
            (unfinished / SCENE).write_text(card)
        return folder

    def overview(self, scene: Scene) -> Overview:
        """The scene in Mitsuba, with the exposure that its sparse scene has.

        Args:
            scene: the scene.
        """
        overview = self.sparse.overview(scene, self.generation.seed)
        if self.generation.metering is Metering.FRAME:
            return overview
        return dataclasses.replace(overview, exposure=object_exposure(overview.thumbnails))

    def render(self, scene: Scene, overview: Overview, view: int) -> FullImage:
        """The full image of one view.

        Args:
            scene: the scene.
            overview: the scene seen coarsely, which exposure comes from.
            view: index of the view.
        """
        entropy = [self.generation.seed, scene.split.number, scene.index, view]
        seed = int(np.random.SeedSequence(entropy).generate_state(1)[0] >> 1)
        return self.renderer.render(
            overview.rendered, scene.light.radiance, scene.poses[view], seed, scene.room
        )

    def faults(
        self, scene: Scene, overview: Overview
    ) -> tuple[CameraFaults | None, list[np.random.Generator]]:
        """What the sparse scene suffers, and for each view a stream of its own noise.

        Args:
            scene: the scene.
            overview: the scene seen coarsely, which exposure comes from.
        """
        if self.generation.realism is None:
            return None, []
        rng = generator(self.generation.seed, scene.split, scene.index, Purpose.REALISM)
        stream = streams(rng)
        thumbnails = overview.thumbnails
        poses = thumbnails.T_world_camera.astype(np.float64)
        faults = draw_camera_faults(self.generation.realism, meter(thumbnails), poses, stream)
        return faults, stream[Effect.SENSOR].spawn(len(scene.poses))

    def _write_frame(
        self,
        folder: Path,
        view: int,
        image: FullImage,
        scene: Scene,
        overview: Overview,
        faults: CameraFaults | None,
        noise: list[np.random.Generator],
    ) -> None:
        stem = folder / f"frame-{view:06d}"
        write_exr(_named(stem, ".hdr.exr"), image.radiance)
        write_exr(_named(stem, ".normal.exr"), image.normals)
        write_mask(_named(stem, ".mask.png"), image.is_object)
        if faults is None:
            write_rgb(_named(stem, ".color.png"), expose(image.radiance, overview.exposure))
            depth, pose = image.depth, scene.poses[view]
        else:
            rgb = faults.shown(image.radiance, overview.exposure, view, noise[view])
            is_lossy = faults.jpeg_quality < LOSSLESS
            quality = faults.jpeg_quality if is_lossy else None
            write_rgb(_named(stem, ".color.jpg" if is_lossy else ".color.png"), rgb, quality)
            depth = faults.depth(image.depth, image.cosines, self.camera, noise[view])
            pose = faults.poses[view]
        write_depth(_named(stem, ".depth.png"), depth)
        np.savetxt(_named(stem, ".pose.txt"), pose, fmt="%.9g")

    def _card(self, scene: Scene, overview: Overview, views: list[int]) -> dict[str, Any]:
        material = scene.painted.dominant.ward
        labcd = to_labcd(material)
        return {
            "ward_variant": material.variant.value,
            "rho_d": material.rho_d,
            "rho_s": material.rho_s,
            "alpha": material.alpha,
            "lab": labcd.lab,
            "c": labcd.c,
            "d": labcd.d,
            **({} if scene.painted.is_uniform else {"materials": scene.painted.cards()}),
            "split": scene.split.value,
            "index": scene.index,
            "shape": scene.shape,
            "diameter": scene.mesh.diameter,
            "environment": scene.light.name,
            "environment_rotation": scene.light.rotation,
            "view_pattern": scene.view_pattern,
            "exposure": overview.exposure,
            "width": self.camera.width,
            "height": self.camera.height,
            "samples": self.samples,
            "views": views,
            "true_poses": scene.poses[views].tolist(),
            "manifest": self.generation.manifest(),
        }


def _named(stem: Path, ending: str) -> Path:
    return stem.with_name(stem.name + ending)


def _text(path: Path) -> str | None:
    return path.read_text() if path.is_file() else None
