# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A network on a CUDA device, where PyTorch is installed and has one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.errors import ReflestError
from reflest_core.inference.material import Explanation
from reflest_core.models.quantisation import Tensors
from reflest_core.models.scores import Scores
from reflest_core.surface.observed_surface import ObservedSurface


class DeviceError(ReflestError):
    """The device that estimation is to use is not there."""


class TorchNetwork:
    """The module of :data:`.network_kind.NETWORKS` named ``network``, on ``device``."""

    def __init__(self, network: str, tensors: Tensors, device: str) -> None:
        """``device``: a PyTorch device; :class:`DeviceError` says why it cannot be used."""
        try:
            import torch
        except ImportError:
            raise DeviceError(
                f"estimation.device {device} needs PyTorch, which is not installed: install "
                "reflest's extra 'training' or set estimation.device to cpu"
            ) from None
        if device == "cuda" and not torch.cuda.is_available():
            raise DeviceError(
                "estimation.device is cuda, but PyTorch finds no CUDA device: set it to cpu"
            )
        from reflest_core.models.registry import NETWORKS

        self._torch = torch
        self._device = device
        self._kind = NETWORKS[network]
        self._module = self._kind.make()
        self._module.load_state_dict({n: torch.from_numpy(t) for n, t in tensors.items()})
        self._module.to(device).eval()

    def scores(
        self,
        surface: ObservedSurface,
        voxels: NDArray[np.int64],
        found: Explanation | None = None,
    ) -> Scores:
        """The parameters of the surface, from the features of ``voxels``."""
        from reflest_core.models.registry import LIVE_DRAW

        torch = self._torch
        inputs = self._kind.features(surface, voxels, LIVE_DRAW, found)
        exact = torch.backends.cudnn.flags(
            enabled=True, benchmark=False, deterministic=True, allow_tf32=False
        )
        with torch.inference_mode(), exact:
            found = self._module(*(values[None].to(self._device) for values in inputs))
        outputs = found if isinstance(found, tuple) else (found,)
        return Scores(*(np.asarray(output[0].cpu().numpy(), np.float32) for output in outputs))
