# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How a kind of network is trained from the command line: its options, its data, its task."""

from __future__ import annotations

import argparse
import importlib
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, ClassVar

from reflest_core.parameter import ParameterError

if TYPE_CHECKING:
    from reflest_core.models.definition import NetworkDefinition
    from reflest_core.models.recipe import Recipe
    from reflest_core.training.processes import Processes
    from reflest_core.training.task import TrainingTask


class TrainingMethod(ABC):
    """One way to train networks; importing it must not import PyTorch.

    Attributes:
        options: Names (``dest``) of the command line's options that it understands and other
            methods may not.
    """

    options: ClassVar[tuple[str, ...]] = ()

    @abstractmethod
    def add_options(self, parser: argparse.ArgumentParser) -> None:
        """Add the method's own options to ``reflest train``; all must default to None.

        Args:
            parser: The parser of ``reflest train``.
        """

    def recipe(self, base: Recipe, arguments: argparse.Namespace) -> Recipe:
        """Return the recipe with what the method's options change.

        Args:
            base: The network's recipe with what the common options change.
            arguments: All options.

        Raises:
            ParameterError: Options contradict each other.
        """
        return base

    @abstractmethod
    def task(
        self,
        definition: NetworkDefinition,
        recipe: Recipe,
        arguments: argparse.Namespace,
        processes: Processes,
    ) -> TrainingTask[Any]:
        """Load the data and make the task.

        Args:
            definition: The network that is trained.
            recipe: The finished recipe.
            arguments: All options.
            processes: Those that train together.
        """


def training_method(path: str) -> TrainingMethod:
    """Make the method of an import path; see ``NetworkDefinition.training``.

    Args:
        path: ``module:class``.
    """
    module, _, name = path.partition(":")
    made = getattr(importlib.import_module(module), name)()
    if not isinstance(made, TrainingMethod):
        raise TypeError(f"{path} is no TrainingMethod")
    return made


def refuse_options_of_others(
    used: TrainingMethod, networks: dict[str, TrainingMethod], arguments: argparse.Namespace
) -> None:
    """Raise :class:`ParameterError` for an option that the used method does not understand.

    Args:
        used: The method of the training.
        networks: The method of every network, by the network's name.
        arguments: All options.
    """
    for other in networks.values():
        for name in other.options:
            if name in used.options or getattr(arguments, name) is None:
                continue
            option = "lambda" if name == "colour_constancy" else name.replace("_", "-")
            owners = [owner for owner, method in networks.items() if name in method.options]
            raise ParameterError(
                f"--{option} goes with --model {' or '.join(owners)}: no other network has it"
            )
