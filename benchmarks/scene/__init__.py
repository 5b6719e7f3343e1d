# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The measured scene: an object on a table, filmed by a hand-held RGB-D camera."""
