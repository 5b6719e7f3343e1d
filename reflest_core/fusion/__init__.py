# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""From frames to the observed surface: TSDF volume, voxel observation store, F and B."""
