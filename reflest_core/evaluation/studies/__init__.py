# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The studies that the results page reports."""
