"""How a network is trained: everything that, with the data, decides its weights."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import torch

from reflest_core.training.augmentation import Augmentation


@dataclass(frozen=True)
class Recipe:
    """Loss, optimiser and data of one training.

    ``loss``: ``rmse1``, ``rmse2`` or ``cuberoot`` (Table 1). ``colour_constancy``: lambda of E_c.
    ``optimiser``: ``rmsprop`` or ``sgd``. ``voxels``, ``nodes_per_voxel``: of one scene in a
    minibatch; fewer nodes than an estimate's 10 train faster. With ``decay`` the learning rate
    falls as a cosine to 0 over the last half.
    """

    network: str
    loss: str
    optimiser: str
    learning_rate: float
    momentum: float
    minibatches: int
    batch_size: int
    voxels: int
    colour_constancy: float = 0.0
    nodes_per_voxel: int = 5
    decay: bool = True
    seed: int = 1
    augmentation: Augmentation = dataclasses.field(default_factory=Augmentation)

    @property
    def parameters(self) -> str:
        """The parameterisation that the loss is written in."""
        return "labcd" if self.loss == "rmse2" else "ward"

    def make_optimiser(self, module: torch.nn.Module) -> torch.optim.Optimizer:
        """The optimiser of section 3.3.2's last paragraph."""
        if self.optimiser == "rmsprop":
            return torch.optim.RMSprop(
                module.parameters(), lr=self.learning_rate, momentum=self.momentum
            )
        return torch.optim.SGD(module.parameters(), lr=self.learning_rate, momentum=self.momentum)

    def learning_rate_at(self, minibatch: int) -> float:
        """The learning rate of one minibatch."""
        progress = max(2 * minibatch / self.minibatches - 1, 0.0) if self.decay else 0.0
        return self.learning_rate * float(1 + torch.cos(torch.tensor(progress * torch.pi))) / 2

    def describe(self) -> dict[str, Any]:
        """JSON values for the weight file's card."""
        return dataclasses.asdict(self)


PAPER_RECIPES = {
    "hemicnn": Recipe("hemicnn", "rmse1", "rmsprop", 1e-4, 0.0, 100_000, 32, voxels=25),
    "grouplet": Recipe("grouplet", "rmse1", "sgd", 0.01, 0.9, 13_000, 24, voxels=20),
}
"""Section 3.3.2: RMSProp 1e-4 for 100K minibatches; SGD 0.01, momentum 0.9, for 13K."""
