# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The observed surface, its voxel keys and what is chosen from it."""
