# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Draws the messages of the views as a display would: a cloud and markers in perspective."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from numpy.typing import NDArray
from sensor_msgs.msg import PointCloud2
from visualization_msgs.msg import Marker, MarkerArray

from reflest_ros.outputs.voxel_cloud import POINT

Points = NDArray[np.float64]

BACKGROUND = "#303030"


@dataclass(frozen=True)
class Viewpoint:
    """A perspective camera; z of the world points up in the picture.

    Attributes:
        eye: (3,) its position in the world frame, metres.
        target: (3,) the point in the middle of the picture, metres.
        width: what the picture shows from left to right at the target, metres.
    """

    eye: Points
    target: Points
    width: float

    def project(self, points: Points) -> tuple[Points, NDArray[np.float64]]:
        """Project points on the plane through the target.

        Args:
            points: (N, 3) world frame, metres.

        Returns:
            (N, 2) places on that plane, right and up of the target, metres; (N,) depths over that
            of the target.
        """
        ahead = self.target - self.eye
        reach = float(np.linalg.norm(ahead))
        ahead = ahead / reach
        right = np.cross(ahead, [0.0, 0.0, 1.0])
        right /= np.linalg.norm(right)
        in_view = (points - self.eye) @ np.stack([right, np.cross(right, ahead), ahead]).T
        return in_view[:, :2] / in_view[:, 2:] * reach, in_view[:, 2] / reach


def prepare(axes: Axes, viewpoint: Viewpoint, aspect: float) -> None:
    """Make an empty picture.

    Args:
        axes: of Matplotlib.
        viewpoint: where the drawing looks from.
        aspect: height over width.
    """
    half = viewpoint.width / 2
    axes.set(xlim=(-half, half), ylim=(-half * aspect, half * aspect), aspect="equal")
    axes.set_xticks([])
    axes.set_yticks([])
    axes.set_facecolor(BACKGROUND)
    axes.spines[:].set_visible(False)


def draw_cloud(axes: Axes, cloud: PointCloud2, viewpoint: Viewpoint, size: float) -> None:
    """Draw the points as discs of ``size`` metres, the nearest on top.

    Args:
        axes: of Matplotlib.
        cloud: as it is published.
        viewpoint: where the drawing looks from.
        size: of a dot.
    """
    records = np.frombuffer(cloud.data, POINT)
    positions = np.stack([records[name] for name in "xyz"], axis=-1).astype(np.float64)
    places, distances = viewpoint.project(positions)
    order = np.argsort(-distances)
    bits = records["rgb"]
    colours = np.stack([bits >> 16 & 255, bits >> 8 & 255, bits & 255], axis=-1) / 255
    points_per_metre = axes.bbox.width / axes.figure.dpi * 72 / viewpoint.width
    diameter = size * points_per_metre / distances[order]
    across, up = places[order].T
    axes.scatter(across, up, s=diameter**2, c=colours[order], linewidths=0)


def draw_markers(axes: Axes, markers: MarkerArray, viewpoint: Viewpoint) -> None:
    """Draw line lists and texts.

    Args:
        axes: of Matplotlib.
        markers: as they are published.
        viewpoint: where the drawing looks from.
    """
    for marker in markers.markers:
        if marker.action != Marker.ADD:
            continue
        if marker.type == Marker.LINE_LIST:
            ends = np.array([[point.x, point.y, point.z] for point in marker.points])
            places, _ = viewpoint.project(ends)
            colours = [(one.r, one.g, one.b, one.a) for one in marker.colors[::2]]
            axes.add_collection(
                LineCollection(list(places.reshape(-1, 2, 2)), colors=colours, linewidths=0.9)
            )
        elif marker.type == Marker.TEXT_VIEW_FACING:
            at = marker.pose.position
            (place,), _ = viewpoint.project(np.array([[at.x, at.y, at.z]]))
            colour = marker.color
            points = marker.scale.z * axes.bbox.width / axes.figure.dpi * 72 / viewpoint.width
            axes.text(
                place[0],
                place[1],
                marker.text,
                color=(colour.r, colour.g, colour.b),
                fontsize=points,
                ha="center",
                va="center",
                family="DejaVu Sans",
            )
