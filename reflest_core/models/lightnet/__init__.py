# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""lightnet: features, network and its live form."""

VOXELS = 48
"""Voxels that an estimate rests on."""
