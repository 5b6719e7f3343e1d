# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Networks that estimate a surface's BRDF: their features, forms, weights and recipes."""
