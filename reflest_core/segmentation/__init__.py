# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Segments of one colour, materials of one gloss, and their ids over a scan."""
