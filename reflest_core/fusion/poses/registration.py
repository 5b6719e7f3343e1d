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
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from reflest_core.capture.frame import Frame
from reflest_core.fusion.poses.edge_correlation import correlations, zoomed
from reflest_core.fusion.poses.edge_maps import EdgeMaps, unit
from reflest_core.fusion.poses.stepwise import StepwiseWork

Image = NDArray[np.float32]

BURST, EVERY = 48, 480
"""So many frames in a row are compared, once in so many frames."""
FEWEST = 10
"""Frames from which on a burst is judged."""
RETRY = 2.2
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
STEPS_OF_FRAME = 2
"""Steps of a judgement that are done at each frame, of 1 ms each."""
ROWS = 24
"""Frames that are compared with all others in one step."""
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
        self._burst = _Burst()
        self._number = self._judged = 0
        self._work = StepwiseWork()

    def add(self, frame: Frame) -> None:
        """Take the next frame.

        Args:
            frame: Later than the one before.
        """
        number, self._number = self._number % EVERY, self._number + 1
        if number == 0:
            self.restart()
        if number < BURST and (maps := EdgeMaps.of(frame)) is not None:
            if not self._burst.takes(maps):
                self.restart()
            self._burst.add(maps)

    def restart(self) -> None:
        """Compare the next frame with none before it."""
        self._burst, self._judged = _Burst(), 0

    def advance(self) -> None:
        """Do a frame's share of a judgement, if enough more frames were added since the last."""
        count = self._burst.count
        is_due = count >= max(FEWEST, RETRY * self._judged) or count == BURST
        if not self._work.is_running and is_due and count > self._judged:
            self._begin()
        self._work.advance(STEPS_OF_FRAME)

    def judge(self) -> None:
        """Compare all frames that were added, at once."""
        self._work.finish()
        if self._burst.count >= FEWEST and self._burst.count > self._judged:
            self._begin()
            self._work.finish()

    def _begin(self) -> None:
        self._judged = self._burst.count
        known = self._burst.is_known[: self._judged]
        if np.count_nonzero(known) >= FEWEST:
            self._work.start(self._judge(self._burst, self._judged))

    def _judge(self, burst: _Burst, count: int) -> Iterator[None]:
        """Compare the first ``count`` frames of a burst, in steps of 1 ms."""
        known = burst.is_known[:count].copy()
        colour, depth = burst.colour[:count], burst.depth[:count]
        table = np.empty((count, count), np.float32)
        for first in range(0, count, ROWS):
            rows = slice(first, first + ROWS)
            table[rows] = correlations(depth[rows], colour)
            yield
        given = table.diagonal()[known]
        self.fit = float(given.mean())
        faults = list(_of_order(table, known))
        yield
        number = np.flatnonzero(known)
        faults += yield from _turned(colour, depth, number, given)
        faults += yield from _moved(colour, depth, number, given, burst.size)
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


class _Burst:
    """Edges of consecutive frames of one size.

    Attributes:
        colour: (BURST, h, w), the first :attr:`count` are filled in; (0, 0, 0) without frames.
        depth: The same.
        is_known: (BURST,) frames that have edges of both.
        count: Frames by now.
        size: Pixels of a frame in one of the reduced images, along each axis.
    """

    def __init__(self) -> None:
        self.colour = self.depth = np.empty((0, 0, 0), np.float32)
        self.is_known = np.zeros(BURST, np.bool_)
        self.count = self.size = 0

    def takes(self, maps: EdgeMaps) -> bool:
        """Whether a frame's maps are of the size of those before."""
        return not self.count or maps.colour.shape == self.colour.shape[1:]

    def add(self, maps: EdgeMaps) -> None:
        """Take the next frame's maps."""
        if not self.count:
            self.colour, self.depth = np.empty((2, BURST, *maps.colour.shape), np.float32)
            self.size = maps.size
        self.colour[self.count], self.depth[self.count] = maps.colour, maps.depth
        self.is_known[self.count] = maps.is_known
        self.count += 1


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
    lag, total = number - number[:, None], number + number[:, None]
    pairs = np.broadcast_to(known[:, None], table.shape)
    for found in _that_fit(table, lag, pairs & (abs(lag) <= FURTHEST) & (lag != 0), -count):
        frames = f"{abs(found)} frame{'s' if abs(found) > 1 else ''}"
        are = "lag behind" if found > 0 else "be ahead of"
        sentence = (
            f"colours seem to {are} depth by {frames}: check the stamps of both images, "
            "capture.slop and the driver's queues"
        )
        of = number + found
        chosen = known & (of >= 0) & (of < count)
        yield _Fault("order", sentence, table[number[chosen], of[chosen]], table[chosen, chosen])
    for found in _that_fit(table, total, pairs & (abs(lag) >= NEAR), 0):
        of = found - number
        chosen = known & (of >= 0) & (of < count) & (abs(of - number) >= NEAR)
        sentence = (
            "colours seem to come in reverse order: check how colour and depth images were "
            "associated"
        )
        yield _Fault("order", sentence, table[number[chosen], of[chosen]], table[chosen, chosen])


def _that_fit(
    table: NDArray[np.floating], group: NDArray[np.integer], is_in: NDArray[np.bool_], least: int
) -> list[int]:
    """Groups of a table's elements whose mean is no accident.

    Args:
        table: (N, N).
        group: (N, N) number of each element's group.
        is_in: (N, N) elements that count.
        least: The least number of a group, at most.
    """
    index = group[is_in] - least
    count = np.bincount(index)
    mean = np.bincount(index, table[is_in]) / np.maximum(count, 1)
    return (np.flatnonzero((count >= FEWEST) & (mean >= 0.99 * LEAST_FIT)) + least).tolist()


def _turned(
    colour: Image, depth: Image, number: NDArray[np.integer], given: NDArray[np.floating]
) -> Generator[None, None, list[_Fault]]:
    found = []
    for name, turn in TURNS.items():
        fits = np.array([np.vdot(depth[k], turn(colour[k])) for k in number])
        sentence = (
            f"colour images seem to be {name} against depth: turn one of them where it is taken"
        )
        found.append(_Fault("turn", sentence, fits, given))
        yield
    return found


def _moved(
    colour: Image,
    depth: Image,
    number: NDArray[np.integer],
    given: NDArray[np.floating],
    size: int,
) -> Generator[None, None, list[_Fault]]:
    """Shifts, and zooms where the best shift is not about 0."""
    chosen = np.unique(np.linspace(0, len(number) - 1, SEARCHED).astype(int))
    colour, depth, given = colour[number[chosen]], depth[number[chosen]], given[chosen]
    spectra = np.conj(fft.rfft2(depth))
    yield
    fits, shift, is_alone = _shifted(colour, depth, spectra)
    yield
    if max(map(abs, shift)) < LEAST_SHIFT and is_alone:
        return []
    across, down = shift[0] * size, shift[1] * size
    sentence = (
        f"colours seem to be shifted against depth by about {across:+d} pixels across and "
        f"{down:+d} down: check that depth is registered to colour, and the calibrations of both"
    )
    found = []
    if max(map(abs, shift)) >= LEAST_SHIFT and is_alone:
        found.append(_Fault("place", sentence, fits, given, LEAST_SEARCHED_FIT))
    middle = []
    for zoom in FINE_ZOOMS:
        middle.append((_fit_zoomed(colour, depth, zoom), zoom))
        yield
    for zoom in (*ZOOMS, max(middle)[1]):
        tried = np.stack([unit(image) for image in zoomed(colour, zoom)])
        yield
        fits, _, is_alone = _shifted(tried, depth, spectra)
        yield
        sentence = (
            f"colours seem to be {zoom[0]:.2f} times as wide and {zoom[1]:.2f} times as high as "
            "depth: check that depth is registered to colour, and of which resolutions the two are"
        )
        if is_alone:
            found.append(_Fault("place", sentence, fits, given, LEAST_SEARCHED_FIT))
    return found


def _fit_zoomed(colour: Image, depth: Image, zoom: tuple[float, float]) -> float:
    """Mean correlation of edges where a zoom about the middle is undone."""
    pairs = zip(zoomed(colour, zoom), depth, strict=True)
    return float(np.mean([np.vdot(unit(one), other) for one, other in pairs]))


def _shifted(
    colour: Image, depth: Image, spectra: NDArray[np.complexfloating]
) -> tuple[NDArray[np.floating], tuple[int, int], bool]:
    """Find the shift of colours against depth that fits best.

    Args:
        colour: (N, h, w) edges of the colours.
        depth: (N, h, w) edges of depth.
        spectra: (N, h, w // 2 + 1) conjugate spectra of the edges of depth.

    Returns:
        How well each frame fits then, the shift to the right and down, and whether no other shift
        fits nearly as well.
    """
    height, width = colour.shape[1:]
    near = np.arange(-REACH, REACH + 1)
    products = fft.rfft2(colour) * spectra
    mean = fft.irfft2(products.mean(axis=0), s=(height, width))
    mean = mean[near[:, None] % height, near[None] % width]
    row, column = np.unravel_index(int(mean.argmax()), mean.shape)
    others = mean.copy()
    others[max(row - 4, 0) : row + 5, max(column - 4, 0) : column + 5] = -1.0
    is_alone = bool(others.max() <= ALONE * mean[row, column])
    right, down = int(near[column]), int(near[row])
    back = np.roll(colour, (-down, -right), axis=(1, 2))
    return np.einsum("nij,nij->n", back, depth), (right, down), is_alone
