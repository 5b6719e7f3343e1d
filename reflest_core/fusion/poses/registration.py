# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Finds colours that do not lie on the depth they came with.

The edges of a frame's colours are correlated with those of its depth (:mod:`.edge_maps`), and so
are the colours of earlier and later frames, and the frame's own mirrored, turned, shifted and
zoomed. A fault is named where that fits far better than the capture as it came, in nearly every
frame.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.fusion.poses.edge_maps import EdgeMaps, unit

Image = NDArray[np.float32]

BURST, EVERY = 48, 480
"""So many frames in a row are compared, once in so many frames."""
FEWEST = 10
"""Frames from which on a burst is judged."""
RETRY = 1.5
"""A burst is judged again when it has so many times more frames."""
LEAST_FIT = 0.08
"""Mean correlation of edges that is no accident. Right captures give 0.1 to 0.6; other frames'
colours -0.01 to 0.03, unless the frames show nearly the same."""
LEAST_SEARCHED_FIT = 0.12
"""The same of the best of many shifts and zooms."""
SURE_FIT = 0.25
"""Such a shift or zoom is a problem from this fit on, and a warning below it."""
FAR_BETTER = 1.5
"""A fault fits so many times better than the capture as it came."""
NEARLY_EVERY = 0.9
"""Share of frames that each fit better with the fault."""
AS_WELL = 0.8
"""Faults of other kinds that fit to this share of the best one are named, too."""
FURTHEST = 8
"""Frames by which colours may lag."""
NEAR = 3
"""Frames apart by less than this, which may show the same, do not show that the order is wrong."""
SEARCHED = 12
"""Frames of a burst in which shifts are searched."""
REACH = 12
"""Pixels of the reduced image by which colours may be shifted."""
LEAST_SHIFT = 2
"""Pixels of the reduced image from which on a shift is named: edges of objects are no sharper."""
ALONE = 0.6
"""What is left of the best fit more than 4 pixels away from it is less than this share."""
ZOOMS = (
    *((zoom, zoom) for zoom in (0.5, 2 / 3, 0.75, 4 / 3, 1.5, 2.0)),
    *((1.0, 0.75), (1.0, 4 / 3), (0.75, 1.0), (4 / 3, 1.0)),
)
"""Factors across and down between the images of cameras that offer several resolutions."""
FINE_ZOOMS = tuple(
    (zoom, zoom) for zoom in np.exp(np.arange(-14, 15) / 20.0).tolist() if zoom != 1.0
)
"""From a half to twice, by steps of 5 %."""
TURNS: dict[str, Callable[[Image], Image]] = {
    "upside down": lambda image: image[::-1],
    "mirrored left to right": lambda image: image[:, ::-1],
    "turned by 180 degrees": lambda image: image[::-1, ::-1],
}


@dataclass(frozen=True)
class _Fault:
    """A reading of the colours other than the given one, and how well frames fit under both."""

    kind: str
    sentence: str
    fits: NDArray[np.floating]
    given: NDArray[np.floating]
    least: float = LEAST_FIT

    @property
    def fit(self) -> float:
        """Mean correlation of edges under the fault."""
        return float(self.fits.mean()) if len(self.fits) else -1.0

    @property
    def is_found(self) -> bool:
        """Whether enough frames fit far better than as they came."""
        if len(self.fits) < FEWEST or self.fit < self.least:
            return False
        if self.fit < FAR_BETTER * float(self.given.mean()):
            return False
        return float((self.fits > self.given).mean()) >= NEARLY_EVERY


class RegistrationCheck:
    """Keeps the edges of a burst of consecutive frames.

    Attributes:
        problem: A sentence where colours do not lie on the depth they came with, or "". Once found
            it stays: the surface has these colours.
        warning: The same where edges fit too poorly to be sure.
        is_turned: Whether one of the two images is upside down, mirrored or turned.
        fit: Mean correlation of the edges of colours and depth as they came; NaN where it is
            unknown.
    """

    def __init__(self) -> None:
        self.problem = self.warning = ""
        self.is_turned = False
        self.fit = math.nan
        self._maps: list[EdgeMaps] = []
        self._number = self._judged = 0

    def add(self, frame: Frame) -> None:
        """Take the next frame.

        Args:
            frame: Later than the one before.
        """
        number, self._number = self._number % EVERY, self._number + 1
        if number == 0:
            self.restart()
        if number < BURST and (maps := EdgeMaps.of(frame)) is not None:
            if self._maps and maps.colour.shape != self._maps[0].colour.shape:
                self.restart()
            self._maps.append(maps)

    def restart(self) -> None:
        """Compare the next frame with none before it."""
        self._maps, self._judged = [], 0

    def judge(self) -> None:
        """Compare what has been added since the last call, if it is enough."""
        if len(self._maps) < max(FEWEST, RETRY * self._judged) and (
            len(self._maps) < BURST or self._judged == BURST
        ):
            return
        self._judged = len(self._maps)
        known = np.array([maps.is_known for maps in self._maps])
        if np.count_nonzero(known) < FEWEST:
            return
        colour = np.stack([maps.colour for maps in self._maps])
        depth = np.stack([maps.depth for maps in self._maps])
        table = depth.reshape(len(depth), -1) @ colour.reshape(len(colour), -1).T
        given = table.diagonal()[known]
        self.fit = float(given.mean())
        faults = [
            *_of_order(table, known),
            *_turned(colour[known], depth[known], given),
            *_moved(colour[known], depth[known], given, self._maps[0].size),
        ]
        best = _best(faults)
        if not best:
            return
        sentence = (
            f"edges of colours do not lie on those of depth (fit {self.fit:.2f}, {best[0].fit:.2f} "
            f"otherwise): {', or '.join(fault.sentence for fault in best)}"
        )
        if best[0].kind == "place" and best[0].fit < SURE_FIT:
            self.warning = sentence
        else:
            self.problem = sentence
            self.is_turned = best[0].kind == "turn"


def _best(faults: Sequence[_Fault]) -> list[_Fault]:
    """What fits best, and what of another kind fits as well; [] where nothing is found."""
    found = sorted((fault for fault in faults if fault.is_found), key=lambda fault: -fault.fit)
    best: dict[str, _Fault] = {}
    for fault in found:
        if fault.fit >= AS_WELL * found[0].fit:
            best.setdefault(fault.kind, fault)
    return list(best.values())


def _of_order(table: NDArray[np.floating], known: NDArray[np.bool_]) -> Iterator[_Fault]:
    """Colours of another frame, by how much the edges of each frame's depth fit each one's colours.

    Args:
        table: (N, N) correlation of a frame's depth, along the rows, with a frame's colours.
        known: (N,) frames that have edges.
    """
    count = len(table)
    number = np.arange(count)
    for lag in (*range(-FURTHEST, 0), *range(1, FURTHEST + 1)):
        of = number + lag
        chosen = known & (of >= 0) & (of < count)
        frames = f"{abs(lag)} frame{'s' if abs(lag) > 1 else ''}"
        are = "lag behind" if lag > 0 else "be ahead of"
        sentence = (
            f"colours seem to {are} depth by {frames}: check the stamps of both images, "
            "capture.slop and the driver's queues"
        )
        yield _Fault("order", sentence, table[number[chosen], of[chosen]], table[chosen, chosen])
    for total in range(FEWEST, 2 * count - 1):
        of = total - number
        chosen = known & (of >= 0) & (of < count) & (abs(of - number) >= NEAR)
        sentence = (
            "colours seem to come in reverse order: check how colour and depth images were "
            "associated"
        )
        yield _Fault("order", sentence, table[number[chosen], of[chosen]], table[chosen, chosen])


def _turned(colour: Image, depth: Image, given: NDArray[np.floating]) -> Iterator[_Fault]:
    for name, turn in TURNS.items():
        fits = np.array([np.vdot(b, turn(a)) for a, b in zip(colour, depth, strict=True)])
        sentence = (
            f"colour images seem to be {name} against depth: turn one of them where it is taken"
        )
        yield _Fault("turn", sentence, fits, given)


def _moved(colour: Image, depth: Image, given: NDArray[np.floating], size: int) -> Iterator[_Fault]:
    """Shifts, and zooms where the best shift is not about 0."""
    chosen = np.unique(np.linspace(0, len(given) - 1, SEARCHED).astype(int))
    colour, depth, given = colour[chosen], depth[chosen], given[chosen]
    spectra = np.conj(np.fft.rfft2(depth))
    fits, shift, is_alone = _shifted(colour, spectra)
    if max(map(abs, shift)) < LEAST_SHIFT and is_alone:
        return
    across, down = shift[0] * size, shift[1] * size
    sentence = (
        f"colours seem to be shifted against depth by about {across:+d} pixels across and "
        f"{down:+d} down: check that depth is registered to colour, and the calibrations of both"
    )
    if max(map(abs, shift)) >= LEAST_SHIFT and is_alone:
        yield _Fault("place", sentence, fits, given, LEAST_SEARCHED_FIT)
    middle = [(_fit_zoomed(colour, depth, zoom), zoom) for zoom in FINE_ZOOMS]
    for zoom in (*ZOOMS, max(middle)[1]):
        zoomed = np.stack([unit(_zoomed(image, zoom)) for image in colour])
        fits, _, is_alone = _shifted(zoomed, spectra)
        sentence = (
            f"colours seem to be {zoom[0]:.2f} times as wide and {zoom[1]:.2f} times as high as "
            "depth: check that depth is registered to colour, and of which resolutions the two are"
        )
        if is_alone:
            yield _Fault("place", sentence, fits, given, LEAST_SEARCHED_FIT)


def _fit_zoomed(colour: Image, depth: Image, zoom: tuple[float, float]) -> float:
    """Mean correlation of edges where a zoom about the middle is undone."""
    pairs = zip(colour, depth, strict=True)
    return float(np.mean([np.vdot(unit(_zoomed(one, zoom)), other) for one, other in pairs]))


def _shifted(
    colour: Image, spectra: NDArray[np.complexfloating]
) -> tuple[NDArray[np.floating], tuple[int, int], bool]:
    """Find the shift of colours against depth that fits best.

    Args:
        colour: (N, h, w) edges of the colours.
        spectra: (N, h, w // 2 + 1) conjugate spectra of the edges of depth.

    Returns:
        How well each frame fits then, the shift to the right and down, and whether no other shift
        fits nearly as well.
    """
    height, width = colour.shape[1:]
    near = np.arange(-REACH, REACH + 1)
    tables = np.fft.irfft2(np.fft.rfft2(colour) * spectra, s=(height, width))
    tables = tables[:, near[:, None] % height, near[None] % width]
    mean = tables.mean(axis=0)
    row, column = np.unravel_index(int(mean.argmax()), mean.shape)
    others = mean.copy()
    others[max(row - 4, 0) : row + 5, max(column - 4, 0) : column + 5] = -1.0
    is_alone = bool(others.max() <= ALONE * mean[row, column])
    return tables[:, row, column], (int(near[column]), int(near[row])), is_alone


def _zoomed(image: Image, zoom: tuple[float, float]) -> Image:
    """Undo a zoom about the middle: what lies outside is 0."""
    height, width = image.shape
    rows = np.round((np.arange(height) - (height - 1) / 2) * zoom[1] + (height - 1) / 2).astype(int)
    columns = np.round((np.arange(width) - (width - 1) / 2) * zoom[0] + (width - 1) / 2).astype(int)
    is_inside = ((rows >= 0) & (rows < height))[:, None] & (columns >= 0) & (columns < width)
    found = image[np.ix_(rows.clip(0, height - 1), columns.clip(0, width - 1))]
    return np.where(is_inside, found, np.float32(0.0))
