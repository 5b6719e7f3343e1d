# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The results page's sections, each written from one record; no figure is typed."""
