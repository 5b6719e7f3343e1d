# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``make demo``: a shipped capture through the real node, compared with its truth."""
