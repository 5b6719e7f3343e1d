# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The functions that do each stage of the live path."""

from __future__ import annotations

from benchmarks.measuring.stage_clock import Stage

ASSEMBLE = "assemble: match, decode, check"
FUSE = "fuse"
FUSE_NEW, FUSE_KNOWN, FUSE_DEPTH, FUSE_REDUNDANT = (
    "fuse, a new view",
    "fuse, adds to a stored view",
    "fuse, depth alone: colours known",
    "fuse, redundant: skipped",
)
FRAME = "frame: assemble and fuse"
ESTIMATE = "estimate"
FROM_STORE = "store to estimate"
SNAPSHOT = "snapshot"
PUBLISH = "publish"
NETWORK = "network"
SHIPPED_KIND, EAGER, COMPILED = "shipped", "PyTorch eager", "torch.compile"
"""Who runs the network."""

CAPTURE_STAGES = (
    Stage("match", ("reflest_core.capture.sync.matching:Matcher.add",)),
    Stage(
        "decode",
        (
            "reflest_core.capture.assembler:decode_colour",
            "reflest_core.capture.assembler:decode_depth",
            "reflest_core.capture.assembler:decode_mask",
        ),
    ),
    Stage(ASSEMBLE, ("reflest_core.capture.assembler:FrameAssembler.add",)),
)
FUSION_STAGES = (
    Stage(
        "classify pixels",
        tuple(
            f"reflest_core.fusion.scan:{name}"
            for name in ("object_window", "cropped", "classify_pixels")
        ),
    ),
    Stage(
        "TSDF",
        tuple(
            f"reflest_core.fusion.tsdf.volume:TsdfVolume.{name}"
            for name in ("allocate", "in_sight", "integrate", "extract")
        ),
    ),
    Stage("redundancy", ("reflest_core.fusion.scan:known_frame",)),
    Stage("F and B", ("reflest_core.fusion.scan:foreground_background_means",)),
    Stage(
        "observations",
        (
            "reflest_core.fusion.scan:visible_voxels",
            *(
                f"reflest_core.fusion.observations.observation_store:ObservationStore.{name}"
                for name in ("remove", "move", "find", "refresh", "claim", "unseen_from", "observe")
            ),
        ),
    ),
    Stage(
        "background light",
        (
            "reflest_core.fusion.scan:background_pixels",
            "reflest_core.light.light_map:LightMap.add_frame",
        ),
    ),
    Stage(
        SNAPSHOT,
        (
            "reflest_core.estimation.pipeline:Pipeline.snapshot",
            "reflest_core.estimation.pipeline:Pipeline.keyframe_snapshot",
        ),
    ),
)
ESTIMATION_STAGES = (
    Stage("voxel choice", ("reflest_core.models.predictor:choose_voxels",)),
    Stage("hemisphere images", ("reflest_core.models.hemicnn.live:hemisphere_images",)),
    Stage("grouplets", ("reflest_core.models.grouplet.live:draw_grouplets",)),
    Stage("shading", ("reflest_core.models.lightnet.live:features_of_choices",)),
    Stage(
        NETWORK,
        (
            "reflest_core.models.hemicnn.live:LiveHemiCNN.evaluate",
            "reflest_core.models.grouplet.live:LiveGrouplet.evaluate",
            "reflest_core.models.lightnet.live:LiveLightNet.evaluate_choices",
        ),
    ),
    Stage("coverage", ("reflest_core.estimation.publisher:hemisphere_coverage",)),
)
STAGES = CAPTURE_STAGES + FUSION_STAGES + ESTIMATION_STAGES

FEATURES = {"hemicnn": "hemisphere images", "grouplet": "grouplets", "lightnet": "shading"}
"""The stage that builds what each network takes."""
