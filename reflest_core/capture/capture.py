# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A recorded capture: iterate over it once to get its frames."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Protocol

from reflest_core.capture.assembler import FrameAssembler, RefusalListener
from reflest_core.capture.frame import Frame
from reflest_core.capture.messages import Role, SensorMessage
from reflest_core.capture.refusal import FrameRefused, RefusalLog
from reflest_core.capture.settings import CaptureSettings


class MessageSource(Protocol):
    """What a capture is read from: messages of each role in recorded order."""

    @property
    def name(self) -> str:
        """The path as the user gave it."""
        ...

    @property
    def topics(self) -> Mapping[Role, str]:
        """What to call each role's stream in a sentence."""
        ...

    @property
    def rgb_total(self) -> int | None:
        """Number of colour images, None if unknown."""
        ...

    @property
    def depth_scale(self) -> float | None:
        """Metres in one unit of 16-bit depth where the format fixes it, else None."""
        ...

    @property
    def depth_encoding(self) -> str | None:
        """How the format stores 16-bit depth, where it fixes that, else None."""
        ...

    @property
    def damage(self) -> str | None:
        """A sentence on what could not be read, as far as is known by now; else None."""
        ...

    def messages(
        self, refuse: Callable[[FrameRefused], None]
    ) -> Iterator[tuple[Role, SensorMessage]]:
        """Yield every message; those that cannot be decoded go to ``refuse``.

        Args:
            refuse: called with each message that cannot be used.
        """
        ...


class Capture:
    """Frames of one recording, with what was refused on the way.

    Attributes:
        name: The path as the user gave it.
        settings: As they are used, with the depth unit of the capture.
        frame_total: Number of colour images, None if unknown.
        frames_seen: Colour images read so far, used or not.
    """

    def __init__(
        self,
        source: MessageSource,
        settings: CaptureSettings,
        on_refusal: RefusalListener | None = None,
        on_clock_jump: Callable[[str], None] = lambda _: None,
        on_warning: Callable[[str], None] = lambda _: None,
    ) -> None:
        """Prepare to read; no image is read yet.

        Args:
            source: Where the messages come from.
            settings: Matching, units and calibration; a unit that is set wins over the format's.
            on_refusal: Called with each refusal and whether it is the first of its cause.
            on_clock_jump: Called between two frames where stamps start again.
            on_warning: Called with sentences on what is used though it may not be meant.
        """
        usual = source.depth_scale
        encoding = settings.depth_encoding
        if encoding == "auto":
            encoding = source.depth_encoding or "plain"
        settings = replace(settings, depth_encoding=encoding)
        settings = replace(settings, depth_scale=settings.depth_unit(usual))
        if usual is not None and not math.isclose(settings.depth_scale, usual, rel_tol=1e-3):
            on_warning(
                f"capture.depth_scale {settings.depth_scale:g} m is used for {source.name}; "
                f"captures of this format usually count {usual:g} m"
            )
        self._source = source
        self._assembler = FrameAssembler(
            settings, source.topics, on_refusal, on_clock_jump, on_warning
        )
        self.settings = settings
        self.name = source.name
        self.frame_total = source.rgb_total
        self.frames_seen = 0

    @property
    def refusals(self) -> RefusalLog:
        """Refusals so far, by cause."""
        return self._assembler.refusals

    @property
    def damage(self) -> str | None:
        """A sentence on how far a damaged recording could be read; else None."""
        return self._source.damage

    def refuse(self, refusal: FrameRefused) -> None:
        """Count a frame that a later stage refused.

        Args:
            refusal: with its cause and sentence.
        """
        self._assembler.refuse(refusal)

    def __iter__(self) -> Iterator[Frame]:
        """Yield the frames in stamp order."""
        for role, message in self._source.messages(self._assembler.refuse):
            self.frames_seen += role is Role.RGB
            yield from self._assembler.add(role, message)
        yield from self._assembler.flush()
