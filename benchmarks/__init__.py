# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How fast reflest is and what it costs: ``python -m benchmarks`` measures and writes the page."""
