# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a network says of a surface, before z-scores are undone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Scores:
    """``means``: (5,) z-scored parameters, float32.

    ``log_variances``: (5,) logarithms of their variances, of z-scores too; None where the network
    does not know how sure it is.
    """

    means: NDArray[np.float32]
    log_variances: NDArray[np.float32] | None = None
