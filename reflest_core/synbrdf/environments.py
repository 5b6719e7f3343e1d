# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Environment maps under the name that scripts of users import them by.

The code is in :mod:`reflest_core.synbrdf.lights.environments`.
"""

from reflest_core.synbrdf.lights.environments import (
    EnvironmentSource,
    EnvironmentUnreadable,
    find_environments,
    load_environment,
    load_environments,
)

__all__ = [
    "EnvironmentSource",
    "EnvironmentUnreadable",
    "find_environments",
    "load_environment",
    "load_environments",
]
