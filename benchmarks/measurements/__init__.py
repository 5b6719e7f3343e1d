# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The measurements: each module has a function ``measure`` whose result fits into JSON."""
