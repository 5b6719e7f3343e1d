# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What ``reflest train`` does for every network: begin, train, say where the weights are."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from reflest_core.training.course import Course
    from reflest_core.training.processes import Processes
    from reflest_core.training.recipe import Recipe
    from reflest_core.training.starting_weights import StartingWeights


def started(recipe: Recipe, arguments: argparse.Namespace) -> tuple[Recipe, StartingWeights | None]:
    """The recipe with what --from says, and the weights themselves."""
    import dataclasses

    from reflest_core.training.starting_weights import StartingWeights

    if arguments.start is None:
        return recipe, None
    start = StartingWeights.read(arguments.start, recipe)
    return dataclasses.replace(recipe, start=start.name), start


def follow(
    course: Course[Any],
    examples: int,
    arguments: argparse.Namespace,
    folder: Path,
    name: str,
    processes: Processes,
    start: StartingWeights | None,
) -> None:
    """Train to the end of the course in ``folder``; ``examples``: how many it is taught from."""
    from reflest_core.training.run_folder import RunFolder
    from reflest_core.training.trainer import Trainer

    place = RunFolder(folder, name, arguments.validate_every, arguments.tensorboard)
    if processes.is_first:
        print(f"training {name} on {examples} examples: {course.recipe}", flush=True)
    path = Trainer(course, place, processes, start).run()
    if processes.is_first:
        print(f"weights: {path}", flush=True)
