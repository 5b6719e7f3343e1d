# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Readers of recordings: MCAP files and rosbag2 databases."""
