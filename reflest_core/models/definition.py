# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a network must say of itself to be trained, shipped and used.

Adding a network is a folder beside this file with a subclass of :class:`NetworkDefinition`, and a
line in :mod:`reflest_core.models.registry` (or an entry point of another package).

A network has two forms that share their weights: a PyTorch module that is trained, and a live form
that estimates while scanning. :meth:`NetworkDefinition.live` gives the PyTorch module on the CPU
unless a network has a live form of its own. The built-in networks have, in NumPy: a robot need not
carry PyTorch, and their estimates are faster. On one thread of a busy two-core machine features and
forward pass take, by the module and by the live form, 10.1 and 7.5 ms (lightnet), 1.2 and 0.7 ms
(HemiCNN), 3.4 and 1.7 ms (Grouplet-fast), 46 and 20 ms (Grouplet-slow);
``python -m benchmarks.network_forms`` measures it. One forward pass for both forms would give that
up, for they are written differently:

* HemiCNN's convolutions are ``conv2d`` when trained; the array API has none, and the matrix
  product over patches with the channel last, which NumPy needs, is no faster in PyTorch.
* Grouplet's live form computes each distinct observation once, and each pair of observation and
  place once; a differentiable form of that is no faster, for training draws few nodes a voxel.
* lightnet's live form runs over the observations that there are; a minibatch is padded to the
  same number of observations for every voxel.

Tests compare both forms of every network.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from reflest_core.models.recipe import Recipe
from reflest_core.parameter import ParameterError

if TYPE_CHECKING:
    import torch

    from reflest_core.inference.material import Explanation
    from reflest_core.models.minibatch import DrawnScenes, PackedScenes
    from reflest_core.models.weights import Tensors
    from reflest_core.surface.observed_surface import ObservedSurface

SHIPPED = Path(__file__).parent / "shipped"
"""Folder of the weight files that this package brings."""
SURFACE_TRAINING = "reflest_core.training.surface.method:SurfaceTraining"
LIGHT_TRAINING = "reflest_core.training.light.method:LightTraining"
"""Training methods; see :attr:`NetworkDefinition.training`."""

OURS, PAPER, SCENES = "ours", "paper", "scenes"
"""Origins of recipes: this project's, the paper's, this project's for materials of whole scenes;
see :attr:`NetworkDefinition.recipes`."""

Features = tuple[NDArray[Any], ...]
"""The arguments of a network for one surface, without the batch's axis."""


@dataclass(frozen=True)
class Model:
    """One way to estimate: a network at a number of voxels, with the weights that it takes.

    Attributes:
        name: Value of the parameter ``estimation.model``.
        voxels: N, voxels of the surface that an estimate rests on.
        weights: The weight file that is shipped; None where a user must give one.
        scene_weights: The shipped one for materials among others, whose light is known from all of
            them; None takes ``weights``.
    """

    name: str
    voxels: int
    weights: Path | None = None
    scene_weights: Path | None = None


@dataclass(frozen=True)
class Scores:
    """A network's outputs for one surface.

    Attributes:
        means: (5,) float32, z-scored parameters.
        log_variances: (5,) float32, logarithms of their variances, of z-scores too; None where the
            network gives none.
    """

    means: NDArray[np.float32]
    log_variances: NDArray[np.float32] | None = None


class LiveNetwork(Protocol):
    """A trained network together with the features that it needs."""

    def scores(
        self,
        surface: ObservedSurface,
        choices: Sequence[NDArray[np.int64]],
        found: Explanation | None = None,
    ) -> list[Scores]:
        """Estimate the z-scored parameters of a surface from each of several choices of voxels.

        Args:
            surface: A scan, or a material's part of one, upright (+z is up).
            choices: (N,) indices of voxels, all observed, of each choice.
            found: The material in the light of its scene, for networks that see light; None takes
                the surface for a scene of one material.
        """


class NetworkDefinition(ABC):
    """A network: its features, its two forms, its weights and how it is trained.

    The module of a definition is imported wherever the names of models are needed; it should import
    what computes, such as PyTorch and compiled kernels, inside its methods.

    Attributes:
        name: Of the network, as weight files and the command line name it.
        models: The ways to estimate with it.
        recipes: How it is trained, by the recipe's origin: ``ours`` at least; ``paper`` where the
            paper has one; ``scenes`` where it is trained on scanned scenes for its model's
            ``scene_weights``.
        sees_light: Whether its features use the light around the surface. If so, an estimate says
            how much of that light was seen.
        eight_bit: Whether its weight file keeps matrices as 8-bit integers.
        training: Import path ``module:class`` of its
            :class:`~reflest_core.training.method.TrainingMethod`. A path and not an object, for
            estimating never imports what trains.
    """

    name: ClassVar[str]
    models: ClassVar[tuple[Model, ...]]
    recipes: ClassVar[Mapping[str, Recipe]]
    sees_light: ClassVar[bool] = False
    eight_bit: ClassVar[bool] = False
    training: ClassVar[str] = SURFACE_TRAINING

    @abstractmethod
    def module(self) -> torch.nn.Module:
        """Make the untrained PyTorch module.

        It takes the features with a leading batch axis, in their order. It returns z-scored
        parameters (B, 5), or their means and log variances, (B, 5) each.
        """

    @abstractmethod
    def features(
        self,
        surface: ObservedSurface,
        voxels: NDArray[np.int64],
        found: Explanation | None = None,
    ) -> Features:
        """Compute the module's arguments for one surface; the same surface gives the same bits.

        Args:
            surface: A scan, or a material's part of one, upright (+z is up).
            voxels: (N,) indices of voxels, all observed.
            found: The material in the light of its scene, for networks that see light; None takes
                the surface for a scene of one material.
        """

    def shapes(self) -> Mapping[str, tuple[int, ...]]:
        """Shape of every tensor of the module, by name; weight files are checked against it."""
        return {name: tuple(tensor.shape) for name, tensor in self.module().state_dict().items()}

    def completed(self, tensors: Tensors) -> Tensors:
        """Return weights of an earlier version's file with the tensors that were added since.

        Args:
            tensors: The file's tensors by name.
        """
        return tensors

    def live(self, tensors: Tensors, threads: int) -> LiveNetwork:
        """Make the form that estimates while scanning; by default the module on the CPU.

        Args:
            tensors: The trained weights, by name, of :meth:`shapes`.
            threads: CPU threads that it may use.

        Raises:
            DeviceError: PyTorch is needed and not installed.
        """
        from reflest_core.models.torch_network import TorchNetwork

        return TorchNetwork(self, tensors, "cpu")

    def batched_features(
        self,
        packed: PackedScenes,
        drawn: DrawnScenes,
        recipe: Recipe,
        generator: torch.Generator,
    ) -> tuple[torch.Tensor, ...]:
        """Compute the module's arguments for a minibatch of training.

        By default :meth:`features` of one scene after another; a network that has features for a
        whole minibatch at once trains faster.

        Args:
            packed: All training scenes.
            drawn: Which of them, seen from which views at which voxels, how turned.
            recipe: The training's.
            generator: For what the features leave to chance, on the scenes' device.
        """
        from reflest_core.models.minibatch import stacked_features

        return stacked_features(self, packed, drawn)

    def recipe(self, origin: str) -> Recipe:
        """Return the recipe of an origin.

        Args:
            origin: One of :attr:`recipes`.

        Raises:
            ParameterError: The network has none of that origin.
        """
        if origin not in self.recipes:
            raise ParameterError(
                f"{self.name} has no recipe {origin!r}: give --recipe {' or '.join(self.recipes)}"
            )
        return self.recipes[origin]

    def model_named(self, name: str) -> Model:
        """Return the model of that name.

        Args:
            name: Of a model.

        Raises:
            KeyError: The network has no such model.
        """
        return {model.name: model for model in self.models}[name]
