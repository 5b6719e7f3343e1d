# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What one visitor sees in three dimensions: surface, cameras, arrows, the light around."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from reflest_core.light.completion import LightPyramid
from reflest_core.light.equirectangular import equirectangular_directions
from reflest_core.light.octahedral import octahedral_texels
from reflest_core.surface.upright import rotation_to_z
from reflest_core.viewer.next_views import Suggestion
from reflest_core.viewer.shading import displayed
from reflest_core.viewer.shown_scan import ShownScan
from reflest_core.viewer.source import Keyframe
from reflest_core.viewer.unlit_mesh import unlit_glb

OVERLAP_S = 0.25
"""The old surface stays until the browser has read the new one, which would flicker otherwise."""
LONGEST_ARROW = 0.5
"""Of the distance from its end at the surface, in diagonals of the scan's box."""
MOST_FRUSTA = 48
"""Cameras that are drawn; of more an even choice."""
CAMERA, CHOSEN, ARROW, MARKER = (0, 114, 178), (230, 159, 0), (230, 159, 0), (213, 94, 0)
"""8-bit sRGB (Okabe and Ito 2008)."""
SKY_ROWS = 48
"""Of the mesh that shows the light."""
SKY_SIZE = 5.0
"""Its radius, in those of the scan."""


class Drawing:
    """Nodes of one client's scene."""

    def __init__(self, scene: Any) -> None:
        """Begin with nothing.

        Args:
            scene: viser's ``SceneApi`` of a client.
        """
        self._scene = scene
        self._surface: Any = None
        self._turn = 0
        self._nodes: dict[str, list[Any]] = {}

    def show_surface(
        self, scan: ShownScan, colours: NDArray[np.uint8], is_shown: NDArray[np.bool_] | None
    ) -> None:
        """Replace the surface.

        Args:
            scan: its mesh.
            colours: (N, 3) sRGB of the vertices.
            is_shown: (N,) vertices that are drawn; None for all.
        """
        faces = scan.faces
        if is_shown is not None:
            faces = faces[is_shown[faces].all(axis=1)]
        old = self._surface
        self._surface = None
        if len(faces):
            self._turn += 1
            content = unlit_glb(scan.vertices, faces, colours)
            name = f"/surface/{self._turn % 4}"
            self._surface = self._scene.add_glb(
                name, content, cast_shadow=False, receive_shadow=False
            )
        if old is not None:
            time.sleep(OVERLAP_S)
            old.remove()

    def show_cameras(self, keyframes: Sequence[Keyframe], chosen: int | None, size: float) -> None:
        """Draw the camera's path and some of the cameras.

        Args:
            keyframes: in time; none draws nothing.
            chosen: one that is drawn with its picture.
            size: of the scan, metres.
        """
        self._clear("cameras")
        if not keyframes:
            return
        nodes = self._nodes["cameras"] = []
        centres = np.array([one.T_world_camera[:3, 3] for one in keyframes], np.float32)
        if len(centres) > 1:
            segments = np.stack([centres[:-1], centres[1:]], axis=1)
            nodes.append(
                self._scene.add_line_segments(
                    "/cameras/path", segments, CAMERA, thickness=2.0, thickness_units="screen"
                )
            )
        every = max(len(keyframes) // MOST_FRUSTA, 1)
        for index, one in enumerate(keyframes):
            is_chosen = index == chosen
            if index % every and not is_chosen:
                continue
            nodes.append(
                self._scene.add_camera_frustum(
                    f"/cameras/{index}",
                    one.fov,
                    one.aspect,
                    scale=(0.16 if is_chosen else 0.06) * size,
                    thickness=1.5,
                    thickness_units="screen",
                    color=CHOSEN if is_chosen else CAMERA,
                    image=one.picture if is_chosen else None,
                    wxyz=_quaternion(one.T_world_camera[:3, :3]),
                    position=one.T_world_camera[:3, 3],
                    cast_shadow=False,
                    receive_shadow=False,
                )
            )

    def show_eyes(self, scan: ShownScan, size: float) -> None:
        """Draw where the views were taken from, where their directions are not known.

        Args:
            scan: what is shown.
            size: of the scan, metres.
        """
        surface = scan.found.surface
        eyes = surface.view_centres[surface.is_observing]
        if len(eyes):
            node = self._scene.add_point_cloud(
                "/cameras/eyes", eyes, CAMERA, point_size=0.005 * size, point_shape="circle"
            )
            self._nodes["cameras"] = [node]

    def show_arrows(self, suggestions: Sequence[Suggestion], size: float) -> None:
        """Draw where to look from next.

        Args:
            suggestions: none draws nothing.
            size: of the scan, metres.
        """
        self._clear("arrows")
        nodes = self._nodes["arrows"] = []
        for number, one in enumerate(suggestions, 1):
            away = one.start - one.end
            away *= min(1.0, LONGEST_ARROW * size / float(np.linalg.norm(away)))
            points = np.stack([one.end + away, one.end + 0.35 * away])[None]
            nodes.append(
                self._scene.add_arrows(
                    f"/arrows/{number}",
                    points,
                    ARROW,
                    shaft_radius=0.004 * size,
                    head_radius=0.013 * size,
                    head_length=0.04 * size,
                )
            )
            label = f"/arrow-words/{number}"
            nodes.append(self._scene.add_label(label, str(number), position=one.end + away))

    def show_marker(self, point: NDArray[np.floating] | None, size: float) -> None:
        """Mark the click.

        Args:
            point: (3,) world frame, metres; None draws nothing.
            size: of the scan, metres.
        """
        self._clear("marker")
        if point is not None:
            self._nodes["marker"] = [
                self._scene.add_icosphere(
                    "/marker", 0.008 * size, color=MARKER, position=point, cast_shadow=False
                )
            ]

    def show_sky(self, light: LightPyramid | None, scan: ShownScan, stops: float) -> None:
        """Draw the light on a sphere around the scan.

        Args:
            light: +z up; None draws nothing.
            scan: what it lights.
            stops: exposure.
        """
        self._clear("sky")
        if light is None:
            return
        directions = equirectangular_directions(SKY_ROWS)
        level = light.levels[0]
        colours = level.reshape(-1, level.shape[-1])[octahedral_texels(directions, len(level))]
        radius = SKY_SIZE * scan_size(scan) / 2.0
        centre = scan.vertices.mean(axis=0)
        turned = directions.reshape(-1, 3) @ rotation_to_z(scan.up)
        rows, columns = directions.shape[:2]
        index = np.arange(rows * columns, dtype=np.int32).reshape(rows, columns)
        right = np.roll(index, -1, axis=1)
        corners = (index[:-1], index[1:], right[1:], right[:-1])
        a, b, c, d = (corner.reshape(-1) for corner in corners)
        faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
        content = unlit_glb(
            (centre + radius * turned).astype(np.float32),
            faces,
            displayed(colours[..., :3].reshape(-1, 3), stops),
        )
        self._nodes["sky"] = [
            self._scene.add_glb("/sky", content, cast_shadow=False, receive_shadow=False)
        ]

    def _clear(self, name: str) -> None:
        for node in self._nodes.pop(name, []):
            node.remove()


def scan_size(scan: ShownScan) -> float:
    """The diagonal of a scan's box, metres.

    Args:
        scan: what is shown.
    """
    return float(np.linalg.norm(np.ptp(scan.vertices, axis=0)))


def _quaternion(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """(4,) w x y z."""
    x, y, z, w = Rotation.from_matrix(rotation).as_quat()
    return np.array([w, x, y, z])
