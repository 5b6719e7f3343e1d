# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What the networks reach: the paper's tables and figures, measured again. Not on the live path."""
