# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Live benchmark: a bag at camera speed to the real node, over DDS, with default settings."""
