# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The scanned surface, its materials and its light as files of other programs."""
