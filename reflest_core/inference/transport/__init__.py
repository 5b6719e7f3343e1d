# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How light arrives at a voxel and how it is reflected."""
