# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Matching of colour, depth, calibration and pose messages by stamp."""
