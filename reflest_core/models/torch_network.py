# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A network as its PyTorch module, on a CUDA device or on the CPU."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from reflest_core.errors import ReflestError
from reflest_core.models.definition import Scores
from reflest_core.models.weights import Tensors
from reflest_core.surface.observed_surface import ObservedSurface

if TYPE_CHECKING:
    from reflest_core.inference.material import Explanation
    from reflest_core.models.definition import NetworkDefinition


class DeviceError(ReflestError):
    """The device that estimation is to use cannot be used."""


class TorchNetwork:
    """A :class:`~reflest_core.models.definition.LiveNetwork` that runs the PyTorch module."""

    def __init__(self, definition: NetworkDefinition, tensors: Tensors, device: str) -> None:
        """Load the weights into the module.

        Args:
            definition: The network.
            tensors: Its weights by name.
            device: A PyTorch device.

        Raises:
            DeviceError: PyTorch is not installed, or finds no such device.
        """
        try:
            import torch
        except ImportError:
            raise DeviceError(_without_pytorch(definition.name, device)) from None
        if device == "cuda" and not torch.cuda.is_available():
            raise DeviceError(
                "estimation.device is cuda, but PyTorch finds no CUDA device: set it to cpu"
            )
        self._torch = torch
        self._device = device
        self._definition = definition
        self._module = definition.module()
        self._module.load_state_dict({n: torch.from_numpy(t) for n, t in tensors.items()})
        self._module.to(device).eval()

    def scores(
        self,
        surface: ObservedSurface,
        choices: Sequence[NDArray[np.int64]],
        found: Explanation | None = None,
    ) -> list[Scores]:
        """Estimate from the features of each choice of voxels; products are never in TF32.

        Args:
            surface: A scan, or a material's part of one, upright (+z is up).
            choices: (N,) indices of voxels, all observed, of each choice.
            found: See :class:`~reflest_core.models.definition.LiveNetwork`.
        """
        return [self._scores(surface, voxels, found) for voxels in choices]

    def _scores(
        self, surface: ObservedSurface, voxels: NDArray[np.int64], found: Explanation | None
    ) -> Scores:
        torch = self._torch
        features = self._definition.features(surface, voxels, found)
        exact = torch.backends.cudnn.flags(
            enabled=True, benchmark=False, deterministic=True, allow_tf32=False
        )
        inputs = [torch.from_numpy(values)[None].to(self._device) for values in features]
        with torch.inference_mode(), exact:
            made = self._module(*inputs)
        outputs = made if isinstance(made, tuple) else (made,)
        return Scores(*(np.asarray(output[0].cpu().numpy(), np.float32) for output in outputs))


def _without_pytorch(network: str, device: str) -> str:
    missing = "needs PyTorch, which is not installed: install reflest's extra 'training'"
    if device == "cpu":
        return f"the network {network} {missing}"
    return f"estimation.device {device} {missing} or set estimation.device to cpu"
