# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Training of ``lightnet`` from the command line."""

from __future__ import annotations

import argparse
import dataclasses
import os
from pathlib import Path
from typing import TYPE_CHECKING

from reflest_core.models.definition import SCENES
from reflest_core.parameter import ParameterError
from reflest_core.training.method import TrainingMethod

if TYPE_CHECKING:
    from reflest_core.models.definition import NetworkDefinition
    from reflest_core.models.recipe import Recipe
    from reflest_core.training.light.task import LightTask
    from reflest_core.training.processes import Processes

SCANS = 4
"""Simulated scans of each training scene, by default."""


class LightTraining(TrainingMethod):
    """Trains on simulated scans of SynBRDF scenes, each with the light that its views show."""

    options = (
        "scan_folder",
        "jobs",
        "scans",
        "hold_out",
        "calibration",
        "without",
        "observations",
    )

    def add_options(self, parser: argparse.ArgumentParser) -> None:
        """Add the options as a group.

        Args:
            parser: The parser of ``reflest train``.
        """
        group = parser.add_argument_group("lightnet", "options of --model lightnet")
        group.add_argument(
            "--scan-folder",
            type=Path,
            metavar="FOLDER",
            help="keeps simulated scans, which are made once; trainings may share it; "
            "default: OUT/scans",
        )
        group.add_argument(
            "--jobs", type=int, help="processes that simulate; default: one for each core"
        )
        group.add_argument(
            "--scans", type=int, help=f"simulated scans of each training scene; default: {SCANS}"
        )
        group.add_argument(
            "--hold-out",
            nargs="+",
            metavar="ENVIRONMENT",
            help="train without these environments, in mixtures too; measure and calibrate on them",
        )
        group.add_argument(
            "--calibration",
            type=Path,
            nargs="+",
            metavar="RUN",
            help="folders of trainings with --hold-out: calibrate on all that they held out",
        )
        group.add_argument(
            "--without",
            nargs="+",
            metavar="PART",
            help="train without light, fit, completion, visibility, shares or uncertainty",
        )
        group.add_argument("--observations", type=int, help="of one voxel in a minibatch")

    def recipe(self, base: Recipe, arguments: argparse.Namespace) -> Recipe:
        """Return the recipe with what the options change.

        Args:
            base: The network's recipe with what the common options change.
            arguments: All options.

        Raises:
            ParameterError: ``--hold-out`` and ``--calibration`` are both given, or a number is
                below 1.
        """
        for name in ("jobs", "scans", "observations"):
            number = getattr(arguments, name)
            if number is not None and number < 1:
                raise ParameterError(f"--{name} is {number}, but must be 1 or more")
        if arguments.hold_out and arguments.calibration:
            raise ParameterError(
                "--calibration goes without --hold-out: what is held out gives a calibration itself"
            )
        return dataclasses.replace(
            base,
            hold_out=tuple(sorted(arguments.hold_out or ())),
            without=tuple(sorted(arguments.without or ())),
            observations=arguments.observations or base.observations,
        )

    def task(
        self,
        definition: NetworkDefinition,
        recipe: Recipe,
        arguments: argparse.Namespace,
        processes: Processes,
    ) -> LightTask:
        """Simulate the scans that are missing, in the first process, and load all.

        Args:
            definition: The network.
            recipe: The training's.
            arguments: All options.
            processes: Those that train together.
        """
        from reflest_core.models.weights import load_weights
        from reflest_core.training.light.ablation import check_parts
        from reflest_core.training.light.data import (
            ScanFolder,
            load_light_data,
            load_scene_data,
        )
        from reflest_core.training.light.measured_scans import MeasuredScans
        from reflest_core.training.light.task import LightTask

        check_parts(recipe.without)
        measured = [MeasuredScans.read(folder) for folder in arguments.calibration or ()]
        held_out = MeasuredScans.joined(measured) if measured else None
        jobs = arguments.jobs or os.cpu_count() or 1
        place = ScanFolder(arguments.scan_folder or arguments.out / "scans", jobs)
        with processes.first_alone():
            if arguments.recipe == SCENES:
                data = load_scene_data(arguments.data, recipe, place)
            else:
                data = load_light_data(arguments.data, recipe, arguments.scans or SCANS, place)
        statistics = None
        if arguments.start is not None:
            statistics = load_weights(arguments.start)[1].statistics
        return LightTask(recipe, data, processes.device, held_out, statistics)
