# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What one frame shows: foreground, visible voxels and background."""
