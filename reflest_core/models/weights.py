# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Weight files: safetensors with everything that is needed to use and to trust them."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save

from reflest_core.brdf.parameters import WardVariant
from reflest_core.errors import ReflestError
from reflest_core.models.calibration import Calibration
from reflest_core.models.model_choice import MODELS
from reflest_core.models.normalisation import ParameterStatistics
from reflest_core.models.quantisation import Tensors, dequantise, quantise
from reflest_core.whole_file import write_whole

FORMAT = "reflest-weights-1"
SHIPPED = Path(__file__).parent / "shipped"


class WeightsError(ReflestError):
    """A weight file is missing, damaged or made for something else."""


@dataclass(frozen=True)
class WeightsCard:
    """What a network's outputs mean and how it came to be.

    ``network``: ``hemicnn``, ``grouplet`` or ``lightnet``. ``parameters``: ``ward`` or ``labcd``,
    the meaning of the five outputs after their z-score is undone. ``statistics``: the training
    set's, for both parameterisations. ``recipe``: data, loss, optimiser, seed.

    ``calibration``: of the standard deviations of a network that says how sure it is, fitted on
    environments kept from training.
    """

    network: str
    parameters: str
    variant: WardVariant
    statistics: dict[str, ParameterStatistics]
    recipe: dict[str, Any]
    calibration: Calibration = field(default_factory=Calibration)

    @property
    def output_statistics(self) -> ParameterStatistics:
        """The statistics by which the network's outputs are z-scored."""
        return self.statistics[self.parameters]


def save_weights(
    path: Path, tensors: Mapping[str, Any], card: WeightsCard, eight_bit: bool
) -> None:
    """Write arrays or PyTorch tensors atomically.

    ``eight_bit`` stores matrices as int8 (see :mod:`.quantisation`).
    """
    stored = {name: _as_array(tensor) for name, tensor in tensors.items()}
    if eight_bit:
        stored = quantise(stored)
    described = json.dumps(
        {
            "network": card.network,
            "parameters": card.parameters,
            "variant": card.variant.value,
            "statistics": {
                name: {"mean": known.mean.tolist(), "stddev": known.stddev.tolist()}
                for name, known in card.statistics.items()
            },
            "recipe": card.recipe,
            "stddev_factors": card.calibration.factors.tolist(),
            "stddev_powers": card.calibration.powers.tolist(),
            "error_correlation": card.calibration.correlation.tolist(),
        },
        sort_keys=True,
    )
    metadata = {"format": FORMAT, "card": described, "sha256": content_hash(stored, described)}
    write_whole(path, save(stored, metadata))


def load_weights(path: Path) -> tuple[Tensors, WeightsCard, str]:
    """Float32 tensors, the card and the checked hash (hex); :class:`WeightsError` otherwise."""
    if not path.is_file():
        raise WeightsError(f"there is no weight file {path}; correct estimation.weights")
    try:
        with safe_open(path, framework="np") as file:
            metadata = file.metadata() or {}
            stored = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
    except (SafetensorError, OSError) as error:
        raise WeightsError(f"{path} is not a readable safetensors file ({error})") from error
    if metadata.get("format") != FORMAT:
        raise WeightsError(
            f"{path} has format {metadata.get('format')!r}, not {FORMAT!r}; "
            "use weights written by this version of reflest"
        )
    digest = content_hash(stored, metadata["card"])
    if digest != metadata["sha256"]:
        raise WeightsError(f"{path} does not match its own hash: it is damaged; install it again")
    return dequantise(stored), _read_card(metadata["card"]), digest


def shipped_models() -> tuple[str, ...]:
    """Keys of :data:`MODELS` whose weights this installation holds."""
    return tuple(name for name, choice in MODELS.items() if (SHIPPED / choice.file).is_file())


def check_fits(tensors: Tensors, shapes: Mapping[str, tuple[int, ...]], path: Path) -> None:
    """Raise :class:`WeightsError` unless ``tensors`` are those of the network with ``shapes``."""
    for name in sorted(shapes.keys() | tensors.keys()):
        found = tensors[name].shape if name in tensors else None
        if found != shapes.get(name):
            raise WeightsError(
                f"{path} does not fit its network: {name} has shape {found}, not "
                f"{shapes.get(name)}; use weights written by this version of reflest"
            )


def content_hash(stored: Tensors, card: str) -> str:
    """SHA-256 (hex) over the card and every tensor's name, type, shape and bytes, by name.

    Types are spelt as PyTorch does, which wrote the first files.
    """
    digest = hashlib.sha256(card.encode())
    for name in sorted(stored):
        tensor = stored[name]
        digest.update(f"{name} torch.{tensor.dtype} {tensor.shape}".encode())
        digest.update(tensor.tobytes())
    return digest.hexdigest()


def _as_array(tensor: Any) -> NDArray[Any]:
    if hasattr(tensor, "detach"):
        tensor = tensor.detach().cpu()
    return np.ascontiguousarray(tensor)


def _read_card(described: str) -> WeightsCard:
    card = json.loads(described)
    statistics = {
        name: ParameterStatistics(np.array(known["mean"]), np.array(known["stddev"]))
        for name, known in card["statistics"].items()
    }
    return WeightsCard(
        card["network"],
        card["parameters"],
        WardVariant(card["variant"]),
        statistics,
        card["recipe"],
        Calibration(
            np.array(card.get("stddev_factors", np.ones(5))),
            np.array(card.get("stddev_powers", np.ones(5))),
            np.array(card.get("error_correlation", np.eye(5))),
        ),
    )
