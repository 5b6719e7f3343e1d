# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Quadrature over pairs of directions in half/difference angles (Rusinkiewicz 1998).

A Ward lobe is a peak in ``theta_h`` alone, so a few points there, spaced by the logarithm of
``tan theta_h``, integrate lobes from ``alpha`` = 0.001 to 1; no grid in the two directions can.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

SMALLEST_TAN = 1e-4
LARGEST_TAN = 30.0


@dataclass(frozen=True)
class HalfAngleQuadrature:
    """Nodes of ``integral g(omega_i, omega_o) cos theta_i d omega_i d omega_o`` for isotropic g.

    Attributes:
        omega_i: (Q, 3) unit directions of incidence, local frame.
        omega_o: (Q, 3) unit directions to the camera, local frame.
        weights: (Q,) with cosine and Jacobian in them; 0 where a direction is below the surface.
    """

    omega_i: torch.Tensor
    omega_o: torch.Tensor
    weights: torch.Tensor

    @staticmethod
    def make(
        half: int = 48, difference: int = 12, azimuth: int = 12, dtype: torch.dtype = torch.float32
    ) -> HalfAngleQuadrature:
        """Build the nodes.

        Args:
            half: Midpoints in ``theta_h``.
            difference: Midpoints in ``theta_d``.
            azimuth: Midpoints in ``phi_d``.
            dtype: Of the tensors.

        Returns:
            ``half`` x ``difference`` x ``azimuth`` nodes.
        """
        tan_h, d_tan_h = _log_midpoints(half)
        theta_d, d_theta_d = _midpoints(0.0, math.pi / 2, difference)
        phi_d, d_phi_d = _midpoints(0.0, math.pi, azimuth)  # mirror symmetry: half the circle
        grid = np.meshgrid(tan_h, theta_d, phi_d, indexing="ij")
        tan_h, theta_d, phi_d = (axis.reshape(-1) for axis in grid)
        widths = np.repeat(d_tan_h, difference * azimuth) * d_theta_d * (2 * d_phi_d)

        cos_h = 1 / np.sqrt(1 + tan_h**2)
        sin_h = tan_h * cos_h
        half_vector = np.stack([sin_h, np.zeros_like(sin_h), cos_h], axis=-1)
        tangent = np.stack([cos_h, np.zeros_like(sin_h), -sin_h], axis=-1)
        bitangent = np.array([0.0, 1.0, 0.0])
        offset = np.sin(theta_d)[:, None] * (
            np.cos(phi_d)[:, None] * tangent + np.sin(phi_d)[:, None] * bitangent
        )
        along = np.cos(theta_d)[:, None] * half_vector
        omega_i, omega_o = along + offset, along - offset

        # d omega_i d omega_o = 4 cos theta_d d omega_h d omega_d,
        # d omega_h = sin theta_h cos^2 theta_h d tan theta_h d phi_h.
        solid_angles = (2 * math.pi * sin_h * cos_h**2) * np.sin(theta_d) * widths
        weights = 4 * np.cos(theta_d) * solid_angles * omega_i[:, 2]
        weights[(omega_i[:, 2] <= 0) | (omega_o[:, 2] <= 0)] = 0.0
        tensors = (torch.as_tensor(array, dtype=dtype) for array in (omega_i, omega_o, weights))
        return HalfAngleQuadrature(*tensors)


def _midpoints(low: float, high: float, count: int) -> tuple[NDArray[np.float64], float]:
    width = (high - low) / count
    middle = np.linspace(low + width / 2, high - width / 2, count, dtype=np.float64)
    return middle, width


def _log_midpoints(count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Midpoints and widths of cells evenly spaced in log tan theta_h; the first begins at 0."""
    edges = np.geomspace(SMALLEST_TAN, LARGEST_TAN, count)
    edges = np.concatenate([[0.0], edges])
    return (edges[1:] + edges[:-1]) / 2, np.diff(edges)
