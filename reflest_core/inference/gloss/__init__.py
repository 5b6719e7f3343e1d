# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The posterior of a surface's roughness, from the observations that hold most information."""
