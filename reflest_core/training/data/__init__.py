# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Samples: scenes as a network is trained on them."""
