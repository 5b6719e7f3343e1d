# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Speed and memory of reflest: ``python -m benchmarks`` measures and writes the results page."""
