# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The capture that the demo plays: a bag, and the truth that the estimator never opens."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.parameters import WardParameters, WardVariant
from reflest_core.capture.frame import Frame
from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.refusal import CaptureError
from reflest_core.ply_file import read_vertices

CAPTURES = Path(__file__).resolve().parents[2] / "captures"
TRUTH, POINTS, SHIPPED = "truth.json", "truth.ply", "table"
CLOSE_UP = 1.5
"""Size of the close-up over that of the object."""


@dataclass(frozen=True)
class ShippedCapture:
    """A bag with its truth beside it.

    Attributes:
        bag: Folder of the recording.
        truth: Content of ``truth.json``: one BRDF in the field names of ``BrdfEstimate``, or
            ``materials``.
    """

    bag: Path
    truth: dict[str, Any]

    @property
    def name(self) -> str:
        """The capture's folder name."""
        return self.bag.name

    @property
    def has_many_materials(self) -> bool:
        """Whether the truth is of a scene of several materials, not of one object."""
        return "materials" in self.truth

    def true_points(self) -> NDArray[np.void]:
        """Points of the true surface with their materials, for :func:`.match_materials`.

        Raises:
            CaptureError: The file cannot be read.
        """
        try:
            return read_vertices(self.bag / POINTS)
        except (OSError, ValueError) as error:
            raise CaptureError(f"{self.bag / POINTS} cannot be read ({error})") from error

    def middle_frame(self) -> Frame:
        """The frame in the middle of the capture."""
        capture = open_capture(self.bag)
        middle = (capture.frame_total or 1) // 2
        return next(frame for index, frame in enumerate(capture) if index >= middle)

    @property
    def true_ward(self) -> WardParameters:
        """The material that was rendered."""
        return ward_parameters(self.truth)

    def close_up(self) -> NDArray[np.uint8]:
        """8-bit sRGB image from the middle of the capture, cut to what has depth."""
        return cut_to_object(self.middle_frame())


def cut_to_object(frame: Frame) -> NDArray[np.uint8]:
    """The part of the image, of the whole one's proportions, around the pixels with depth.

    Args:
        frame: with its region in view.
    """
    height, width = frame.depth.shape
    rows, columns = np.nonzero(frame.depth > 0)
    share = CLOSE_UP * max(np.ptp(rows) / height, np.ptp(columns) / width)
    if share >= 1:
        return frame.rgb
    cut_height, cut_width = round(share * height), round(share * width)
    top = int(np.clip((rows.min() + rows.max() - cut_height) // 2, 0, height - cut_height))
    left = int(np.clip((columns.min() + columns.max() - cut_width) // 2, 0, width - cut_width))
    return frame.rgb[top : top + cut_height, left : left + cut_width]


def find_capture(bag: Path | None) -> ShippedCapture:
    """The capture ``bag``, else the table that is shipped.

    Args:
        bag: the recording; None takes the shipped one.

    Raises:
        CaptureError: It has no readable truth.
    """
    chosen = bag or CAPTURES / SHIPPED
    try:
        truth = json.loads((chosen / TRUTH).read_text())
    except (OSError, ValueError) as error:
        raise CaptureError(
            f"{chosen / TRUTH} cannot be read ({error}): name a capture with a truth by --capture"
        ) from error
    return ShippedCapture(chosen, truth)


def ward_parameters(values: dict[str, Any]) -> WardParameters:
    """Ward parameters out of the fields of an estimate or a truth file.

    Args:
        values: as ``truth.json`` has them.
    """
    red, green, blue = values["rho_d"]
    return WardParameters(
        (red, green, blue), values["rho_s"], values["alpha"], WardVariant(values["ward_variant"])
    )
