# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One module for each measurement, with a function ``measure`` that returns what fits into JSON."""
