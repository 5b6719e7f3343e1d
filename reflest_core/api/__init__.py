# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The Python API: scan with NumPy arrays, or open a recording."""
