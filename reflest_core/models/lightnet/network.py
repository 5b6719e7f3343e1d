# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""lightnet's PyTorch module: a network over ratios of observations to the known light.

Every input compares an observation with what the light seen in the background would do there
(:mod:`reflest_core.models.lightnet.features`), or is a result of the physics with its deviation
(:mod:`reflest_core.models.lightnet.scene_statistics`). The three colour channels pass through the
same weights and meet only in means and maxima, so that none is special.
"""

from __future__ import annotations

import torch
from torch import nn

from reflest_core.brdf.parameters import RHO_D, RHO_S
from reflest_core.light.completion import CLIPPED, RADIANCE, SEEN
from reflest_core.models.lightnet.live import FLOOR, FURTHEST
from reflest_core.models.lightnet.shapes import (
    FOUND_STRENGTHS,
    HEADS,
    ONE_LAYER,
    ROUGHNESS_COUNT,
    STANDARDS,
    TWO_LAYERS,
    UPDATE_HEADS,
    VOXEL,
)

DROPPED = 0.3
"""Share of a scene's numbers that is left out at a time while training."""
FOUND_SCALE = (5.0, 3.5, 15.0)
"""At the start of training, what turns ``rho_d``, ``rho_s`` and ``alpha`` into standard units."""
MOMENTUM = 0.01
"""Share of a minibatch in the running means of :class:`Standard`."""


class LightNet(nn.Module):
    """From the arrays of ``LightFeatures`` to means and log variances of z-scored parameters."""

    def __init__(self) -> None:
        super().__init__()
        self.observation = _two_layers("observation")
        self.voxel = _two_layers("voxel")
        self.attention = nn.Linear(*ONE_LAYER["attention"])
        self.of_channel = Standard(STANDARDS["of_channel"])
        self.of_all = Standard(STANDARDS["of_all"])
        self.channel = _two_layers("channel")
        self.gloss = _two_layers("gloss")
        self.diffuse = _two_layers("diffuse")
        self.diffuse_head = nn.Linear(*ONE_LAYER["diffuse_head"])
        self.strength_head = nn.Linear(*ONE_LAYER["strength_head"])
        self.roughness_head = nn.Linear(*ONE_LAYER["roughness_head"])
        self.found_scale = nn.Parameter(torch.tensor(FOUND_SCALE))
        self.update = nn.Linear(*ONE_LAYER["update"])
        self.update_gloss = nn.Linear(*ONE_LAYER["update_gloss"])
        self.update_albedo = nn.Linear(*ONE_LAYER["update_albedo"])
        for name in UPDATE_HEADS:
            nn.init.zeros_(getattr(self, name).weight)
            nn.init.zeros_(getattr(self, name).bias)
        self.dropout = nn.Dropout(DROPPED)

    def forward(
        self,
        is_seen: torch.Tensor,
        apparent: torch.Tensor,
        clipped: torch.Tensor,
        cosine: torch.Tensor,
        lobe: torch.Tensor,
        lobe_seen: torch.Tensor,
        lobe_clipped: torch.Tensor,
        normals: torch.Tensor,
        diffuse_light: torch.Tensor,
        diffuse_seen: torch.Tensor,
        diffuse_clipped: torch.Tensor,
        voxel_fit: torch.Tensor,
        scene_fit: torch.Tensor,
        zones: torch.Tensor,
        channel_statistics: torch.Tensor,
        statistics: torch.Tensor,
        found_albedo: torch.Tensor,
        found_gloss: torch.Tensor,
        gloss_evidence: torch.Tensor,
        gloss_answers: torch.Tensor,
    ) -> tuple[torch.Tensor, torch.Tensor]:
        """Estimate B surfaces; voxels without observations are padding.

        The arguments are described at
        :class:`~reflest_core.models.lightnet.features.LightFeatures`.

        Args:
            is_seen: (B, V, O) bool.
            apparent: (B, V, O, 3).
            clipped: (B, V, O, 3).
            cosine: (B, V, O).
            lobe: (B, V, O, K, 3).
            lobe_seen: (B, V, O, K).
            lobe_clipped: (B, V, O, K).
            normals: (B, V, 3).
            diffuse_light: (B, V, 3).
            diffuse_seen: (B, V).
            diffuse_clipped: (B, V).
            voxel_fit: (B, V, 3, K, 3).
            scene_fit: (B, 3, K, 3).
            zones: (B, 8, 5).
            channel_statistics: (B, 3, C).
            statistics: (B, S).
            found_albedo: (B, 3, A).
            found_gloss: (B, G).
            gloss_evidence: (B, E).
            gloss_answers: (B, 2).

        Returns:
            Means and log variances, (B, 5) each, of z-scored ``rho_d`` (3), ``rho_s``, ``alpha``.
        """
        per_channel = (*apparent.shape[:3], 3)
        observations = torch.cat(
            [
                _log(apparent)[..., None],
                clipped[..., None],
                cosine[..., None, None].expand(*per_channel, 1),
                _log(lobe).transpose(3, 4),
                lobe_seen[..., None, :].expand(*per_channel, ROUGHNESS_COUNT),
                lobe_clipped[..., None, :].expand(*per_channel, ROUGHNESS_COUNT),
            ],
            dim=-1,
        )
        seen = is_seen[..., None, None].float()
        count = seen.sum(dim=2)
        described = pooled(self.observation(observations), seen, count)

        is_voxel = is_seen.any(dim=2)[..., None, None].float()
        mean_light = (diffuse_light * is_voxel[..., 0]).sum(1) / is_voxel[..., 0].sum(1).clamp(
            min=1
        )
        of_voxel = (*per_channel[:2], 3)
        voxels = self.voxel(
            torch.cat(
                [
                    described,
                    _log(diffuse_light / mean_light[:, None])[..., None],
                    (count / is_seen.shape[2]).expand(*of_voxel, 1),
                    normals[:, :, None].expand(*of_voxel, 3),
                    diffuse_seen[..., None, None].expand(*of_voxel, 1),
                    diffuse_clipped[..., None, None].expand(*of_voxel, 1),
                    voxel_fit.flatten(3),
                ],
                dim=-1,
            )
        )
        weights = torch.softmax(self.attention(voxels) + (is_voxel - 1.0) * 1e4, dim=1)
        weighed = (weights.repeat_interleave(VOXEL // HEADS, dim=-1) * voxels).sum(dim=1)
        spread = _deviation(voxels, is_voxel, is_voxel.sum(dim=1))

        zone_light = _log(zones[..., RADIANCE] / mean_light[:, None]).transpose(1, 2)
        of_channel = self.of_channel(
            torch.cat([channel_statistics, scene_fit.flatten(2), zone_light], dim=-1)
        )
        of_all = self.of_all(torch.cat([statistics, zones[..., SEEN], zones[..., CLIPPED]], dim=-1))
        beside = torch.cat([of_channel.mean(dim=1), of_all], dim=-1)
        channels = self.channel(
            self.dropout(
                torch.cat([weighed, spread, of_channel, beside[:, None].expand(-1, 3, -1)], dim=-1)
            )
        )
        gloss = self.gloss(
            self.dropout(torch.cat([channels.mean(dim=1), channels.amax(dim=1)], dim=-1))
        )
        diffuse = self.diffuse_head(
            self.diffuse(
                self.dropout(torch.cat([channels, gloss[:, None].expand(channels.shape)], dim=-1))
            )
        )
        scale = self.found_scale
        strength, roughness = found_gloss[:, :FOUND_STRENGTHS], found_gloss[:, FOUND_STRENGTHS:]
        answers = [
            _answer(diffuse, found_albedo * scale[0]),
            _answer(self.strength_head(gloss)[:, None], strength[:, None] * scale[1]),
            _answer(self.roughness_head(gloss)[:, None], roughness[:, None] * scale[2]),
        ]
        means, log_variances = (torch.cat(parts, dim=1) for parts in zip(*answers, strict=True))
        return self._updated(means, log_variances, gloss_evidence, gloss_answers * scale[1:])

    def _updated(
        self,
        means: torch.Tensor,
        log_variances: torch.Tensor,
        evidence: torch.Tensor,
        answers: torch.Tensor,
    ) -> tuple[torch.Tensor, torch.Tensor]:
        """The answer (B, 5) each, given the posterior of roughness and its ``answers`` (B, 2)."""
        beside = torch.cat([evidence, means[:, RHO_S:], log_variances[:, RHO_S:]], dim=-1)
        hidden = nn.functional.silu(self.update(beside))
        weights, added, widened = self.update_gloss(hidden).split(2, dim=-1)
        gloss = means[:, RHO_S:] + weights * (answers - means[:, RHO_S:]) + added
        own = torch.stack([means[:, RHO_D], log_variances[:, RHO_D]], dim=-1)
        albedo = self.update_albedo(torch.cat([hidden[:, None].expand(-1, 3, -1), own], dim=-1))
        return (
            torch.cat([means[:, RHO_D] + albedo[..., 0], gloss], dim=1),
            log_variances + torch.cat([albedo[..., 1], widened], dim=1),
        )


class Standard(nn.Module):
    """Inputs less their mean, over their standard deviation, within +-4.

    While training, running means over the minibatches; unlike batch normalisation the same
    numbers are used in training and afterwards.
    """

    mean: torch.Tensor
    variance: torch.Tensor
    seen: torch.Tensor

    def __init__(self, inputs: int) -> None:
        """Begin with mean 0 and variance 1.

        Args:
            inputs: N, how many there are.
        """
        super().__init__()
        self.register_buffer("mean", torch.zeros(inputs))
        self.register_buffer("variance", torch.ones(inputs))
        self.register_buffer("seen", torch.zeros(1))

    def forward(self, values: torch.Tensor) -> torch.Tensor:
        """Compute standard scores.

        Args:
            values: (..., N).
        """
        if self.training:
            self._follow(values.detach().flatten(0, -2))
        scores = (values - self.mean) / torch.sqrt(self.variance + 1e-4)
        return scores.clamp(-FURTHEST, FURTHEST)

    def _follow(self, values: torch.Tensor) -> None:
        share = max(MOMENTUM, 1.0 / (float(self.seen) + 1.0))
        offset = values.mean(dim=0) - self.mean
        spread = values.var(dim=0, unbiased=False) + (1.0 - share) * offset**2
        self.mean += share * offset
        self.variance += share * (spread - self.variance)
        self.seen += 1.0


def _answer(head: torch.Tensor, found: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    """Mean and log variance, (B, N) each, of N parameters.

    ``head``: (B, N, 3 + A), a head's outputs. ``found``: (B, N, A), answers of the physics, of
    which a weighted mean is added to the head's own.
    """
    weights = torch.softmax(head[..., 2:], dim=-1)[..., :-1]
    return head[..., 0] + (weights * found).sum(dim=-1), head[..., 1]


def pooled(x: torch.Tensor, seen: torch.Tensor, count: torch.Tensor) -> torch.Tensor:
    """Compute mean, standard deviation and maximum over the observations (dim 2) that were seen.

    Args:
        x: (B, V, O, C, W).
        seen: (B, V, O, 1, 1), 1 or 0.
        count: (B, V, 1, 1), observations of each voxel.
    """
    mean = (x * seen).sum(dim=2) / count.clamp(min=1)
    squares = ((x - mean[:, :, None]) ** 2 * seen).sum(dim=2) / count.clamp(min=1)
    greatest = torch.where(count > 0, (x + (seen - 1.0) * 1e4).amax(dim=2), 0.0)
    return torch.cat([mean, torch.sqrt(squares + 1e-6), greatest], dim=-1)


def _deviation(x: torch.Tensor, weight: torch.Tensor, total: torch.Tensor) -> torch.Tensor:
    mean = (x * weight).sum(dim=1) / total.clamp(min=1)
    squares = ((x - mean[:, None]) ** 2 * weight).sum(dim=1) / total.clamp(min=1)
    return torch.sqrt(squares + 1e-6)


def _log(ratio: torch.Tensor) -> torch.Tensor:
    return torch.log(ratio + FLOOR)


def _two_layers(name: str) -> nn.Sequential:
    inputs, width, outputs = TWO_LAYERS[name]
    return nn.Sequential(nn.Linear(inputs, width), nn.SiLU(), nn.Linear(width, outputs), nn.SiLU())
