# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A sheet on which texts and pictures are placed in inches from its left and its top."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

DPI = 100


class Sheet:
    """One page of Matplotlib."""

    def __init__(self, width: float, height: float, paper: str, ink: str) -> None:
        """Begin an empty sheet.

        Args:
            width: inches.
            height: inches.
            paper: colour of the background.
            ink: colour of texts.
        """
        self._width, self._height = width, height
        self._paper, self._ink = paper, ink
        self._figure = Figure(figsize=(width, height), dpi=DPI, facecolor=paper)

    def axes(self, left: float, top: float, width: float, height: float) -> Axes:
        """Add axes.

        Args:
            left: inches.
            top: inches.
            width: inches.
            height: inches.
        """
        bottom = self._height - top - height
        place = (left / self._width, bottom / self._height)
        return self._figure.add_axes((*place, width / self._width, height / self._height))

    def write(self, left: float, top: float, text: str, **style: Any) -> None:
        """Add a text.

        Args:
            left: inches.
            top: of its base line, inches.
            text: what to write.
            **style: of Matplotlib's text.
        """
        style = {"fontsize": 12, "color": self._ink, **style}
        self._figure.text(left / self._width, 1 - top / self._height, text, **style)

    def show(
        self, left: float, top: float, width: float, height: float, picture: NDArray[np.uint8]
    ) -> None:
        """Add a picture.

        Args:
            left: inches.
            top: inches.
            width: inches.
            height: inches.
            picture: (H, W, 3) 8-bit sRGB.
        """
        axes = self.axes(left, top, width, height)
        axes.imshow(picture, interpolation="lanczos")
        axes.set_axis_off()

    def save(self, path: Path) -> None:
        """Write a PNG; its folder is made where it does not exist.

        Args:
            path: the file.
        """
        path.parent.mkdir(parents=True, exist_ok=True)
        self._figure.savefig(path, facecolor=self._paper)
