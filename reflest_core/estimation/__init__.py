# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Store in, estimate out; and the scanner that node and replay share."""
