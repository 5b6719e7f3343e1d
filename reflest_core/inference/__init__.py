# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Light and material inferred from an observed surface."""
