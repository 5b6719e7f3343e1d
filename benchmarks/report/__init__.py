# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The results as tables, a page and plots, generated from the measurements alone."""
