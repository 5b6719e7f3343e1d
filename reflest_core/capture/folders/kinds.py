# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The kinds of folders, recognised by their files' names: a new loader is one entry here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from reflest_core.capture.folders.apc import INFO, open_apc
from reflest_core.capture.folders.files import Pinhole
from reflest_core.capture.folders.frame_folder import FrameFolder
from reflest_core.capture.folders.icl_nuim import TRAJECTORY, open_icl_nuim
from reflest_core.capture.folders.nerfstudio import TRANSFORMS, open_nerfstudio
from reflest_core.capture.folders.record3d import METADATA, open_record3d
from reflest_core.capture.folders.replica import IMAGES, open_replica
from reflest_core.capture.folders.replica import TRAJECTORY as REPLICA_TRAJECTORY
from reflest_core.capture.folders.scannet import COLOUR, DEPTH, POSE, open_scannet
from reflest_core.capture.folders.seven_scenes import COLOUR_NAME, open_seven_scenes
from reflest_core.capture.folders.stray_scanner import ODOMETRY, open_stray_scanner
from reflest_core.capture.folders.tum import (
    OPENLORIS_LISTS,
    TUM_LISTS,
    TumFolder,
    open_openloris,
    open_tum,
)

OpenFolder = Callable[[Path, Pinhole | None], FrameFolder | TumFolder]


@dataclass(frozen=True)
class FolderKind:
    """One format.

    Attributes:
        name: What sentences call it, with the files that identify it.
        is_it: Whether these names, of a folder's entries, are of this format.
        open: Opens a folder, with fx, fy, cx, cy in pixels where the user gave them.
    """

    name: str
    is_it: Callable[[set[str]], bool]
    open: OpenFolder


KINDS = (
    FolderKind(f"nerfstudio ({TRANSFORMS})", lambda names: TRANSFORMS in names, open_nerfstudio),
    FolderKind(f"Stray Scanner ({ODOMETRY})", lambda names: ODOMETRY in names, open_stray_scanner),
    FolderKind(
        f"Record3D ({METADATA}, rgb, depth)",
        lambda names: METADATA in names and bool(names & {"rgb", "EXR_RGBD"}),
        open_record3d,
    ),
    FolderKind(
        f"Replica ({REPLICA_TRAJECTORY}, {IMAGES})",
        lambda names: {REPLICA_TRAJECTORY, IMAGES} <= names,
        open_replica,
    ),
    FolderKind(
        f"ICL-NUIM (*{TRAJECTORY})",
        lambda names: any(name.endswith(TRAJECTORY) for name in names),
        open_icl_nuim,
    ),
    FolderKind(
        f"ScanNet ({COLOUR}, {DEPTH}, {POSE})",
        lambda names: {COLOUR, DEPTH, POSE} <= names,
        open_scannet,
    ),
    FolderKind(
        f"OpenLORIS ({', '.join(OPENLORIS_LISTS.values())})",
        lambda names: {"color.txt", "aligned_depth.txt"} <= names,
        open_openloris,
    ),
    FolderKind(
        f"TUM ({', '.join(TUM_LISTS.values())})",
        lambda names: bool(set(TUM_LISTS.values()) & names),
        open_tum,
    ),
    FolderKind(f"APC ({INFO})", lambda names: INFO in names, open_apc),
    FolderKind(
        "7-Scenes or 3RScan (frame-*.color.*)",
        lambda names: any(COLOUR_NAME.fullmatch(name) for name in names),
        open_seven_scenes,
    ),
)
