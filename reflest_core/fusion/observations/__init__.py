# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The observation store: what each voxel looked like from each view."""
