# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Times stages inside the shipped code by wrapping the functions that do them."""

from __future__ import annotations

import contextlib
import functools
import importlib
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from benchmarks.measuring.resident_memory import forget_peak, peak_mb, resident_mb
from benchmarks.measuring.timing import Timing
from reflest_core.errors import ReflestError


class StageMoved(ReflestError):
    """The function that a stage names does not exist."""


@dataclass(frozen=True)
class Stage:
    """A stage of the path and the functions that do it.

    Attributes:
        name: As shown in tables.
        places: ``module:name`` or ``module:Class.name``, where the function is called: an imported
            function is named in the importing module.
    """

    name: str
    places: tuple[str, ...]


class StageClock:
    """Sums each stage's time between two calls of :meth:`lap`.

    With ``with_memory`` it measures instead how much each call adds to the resident memory's peak;
    durations are not valid then.
    """

    def __init__(self, stages: Sequence[Stage], with_memory: bool = False) -> None:
        self.seconds: dict[str, list[float]] = defaultdict(list)
        self.memory_mb: dict[str, float] = {}
        self._stages = stages
        self._with_memory = with_memory and forget_peak()
        self._current: dict[str, float] = defaultdict(float)
        self._running: set[str] = set()

    @contextlib.contextmanager
    def watching(self) -> Iterator[None]:
        """A context in which the stages' functions are timed."""
        with contextlib.ExitStack() as undo:
            for stage in self._stages:
                for place in stage.places:
                    owner, name = _find(stage, place)
                    original = getattr(owner, name)
                    undo.callback(setattr, owner, name, original)
                    setattr(owner, name, self._timed(stage.name, original))
            yield

    @contextlib.contextmanager
    def timing(self, name: str) -> Iterator[None]:
        """A context that is timed as a stage.

        Args:
            name: Of the stage.
        """
        started = time.perf_counter()
        try:
            yield
        finally:
            self._current[name] += time.perf_counter() - started

    def lap(self) -> dict[str, float]:
        """End a frame or an estimate.

        Returns:
            Seconds of each stage that ran since the last call.
        """
        lap = dict(self._current)
        for name, seconds in lap.items():
            self.seconds[name].append(seconds)
        self._current.clear()
        return lap

    def timings(self, memory_mb: dict[str, float] | None = None) -> list[Timing]:
        """Timings of all stages in the order in which they first ran.

        Args:
            memory_mb: Memory by stage from another clock, 10^6 bytes; None for none.
        """
        memory_mb = memory_mb or {}
        return [Timing.of(name, s, memory_mb.get(name)) for name, s in self.seconds.items()]

    def _timed(self, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        @functools.wraps(function)
        def timed(*arguments: Any, **options: Any) -> Any:
            if name in self._running:  # one function of the stage calls another
                return function(*arguments, **options)
            self._running.add(name)
            before = resident_mb() if self._with_memory and forget_peak() else 0.0
            started = time.perf_counter()
            try:
                return function(*arguments, **options)
            finally:
                self._current[name] += time.perf_counter() - started
                self._running.remove(name)
                if self._with_memory:
                    added = max(peak_mb() - before, 0.0)
                    self.memory_mb[name] = max(added, self.memory_mb.get(name, 0.0))

        return timed


def _find(stage: Stage, place: str) -> tuple[Any, str]:
    """The object that holds the function, and its name there."""
    module, _, path = place.partition(":")
    *owners, name = path.split(".")
    try:
        owner = functools.reduce(getattr, owners, importlib.import_module(module))
        getattr(owner, name)
    except (ImportError, AttributeError) as error:
        raise StageMoved(
            f"the stage {stage.name!r} is timed at {place}, which is not there ({error}): name its "
            "new place in benchmarks/measurements/stages.py"
        ) from error
    return owner, name
