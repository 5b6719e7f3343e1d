# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Training of networks that see the surface alone, from scenes of SynBRDF."""

from __future__ import annotations

import argparse
import dataclasses
from typing import TYPE_CHECKING

from reflest_core.training.method import TrainingMethod

if TYPE_CHECKING:
    from reflest_core.models.definition import NetworkDefinition
    from reflest_core.models.recipe import Recipe
    from reflest_core.training.data.sample_sets import TrainingData
    from reflest_core.training.processes import Processes
    from reflest_core.training.surface.task import SurfaceTask


class SurfaceTraining(TrainingMethod):
    """Trains on the losses of Table 1; the default method of a network.

    The data are loaded once, for all networks that one command trains.
    """

    options = ("loss", "colour_constancy", "realism", "nodes_per_voxel", "views", "candidates")

    def __init__(self) -> None:
        self._loaded: TrainingData | None = None

    def add_options(self, parser: argparse.ArgumentParser) -> None:
        """Add loss, lambda and realism.

        Args:
            parser: The parser of ``reflest train``.
        """
        parser.add_argument("--loss", choices=("rmse1", "rmse2", "cuberoot"), help="default: rmse1")
        parser.add_argument(
            "--lambda",
            dest="colour_constancy",
            type=float,
            help="weight of E_c (Eq. 4); default: 0",
        )
        parser.add_argument(
            "--realism",
            nargs="*",
            metavar="EFFECT",
            help="train on every scene a second time, with the faults of a real capture; "
            "no EFFECT: all of them",
        )

    def recipe(self, base: Recipe, arguments: argparse.Namespace) -> Recipe:
        """Return the recipe with the given loss and lambda.

        Args:
            base: The network's recipe with what the common options change.
            arguments: All options.
        """
        lambda_ = arguments.colour_constancy
        return dataclasses.replace(
            base,
            loss=arguments.loss or base.loss,
            colour_constancy=base.colour_constancy if lambda_ is None else lambda_,
        )

    def data(self, arguments: argparse.Namespace) -> TrainingData:
        """Load the scenes that the options ask for.

        Args:
            arguments: All options.
        """
        from reflest_core.synbrdf.realism.settings import Realism, parse_effects
        from reflest_core.training.data.sample import Degradation
        from reflest_core.training.data.sample_sets import load_training_data

        if self._loaded is None:
            degradation = None
            if arguments.realism is not None:
                effects = parse_effects(arguments.realism or ["all"])
                seed = 1 if arguments.seed is None else arguments.seed
                degradation = Degradation(Realism.only(effects), seed)
            self._loaded = load_training_data(arguments.data, degradation)
        return self._loaded

    def task(
        self,
        definition: NetworkDefinition,
        recipe: Recipe,
        arguments: argparse.Namespace,
        processes: Processes,
    ) -> SurfaceTask:
        """Load the scenes and make the task.

        Args:
            definition: The network.
            recipe: The training's.
            arguments: All options.
            processes: Those that train together.
        """
        from reflest_core.training.surface.task import SurfaceTask

        return SurfaceTask(recipe, self.data(arguments), processes.device)
