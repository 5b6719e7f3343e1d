# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A bag at camera speed to the real node: own processes, real DDS, default settings."""
