# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The studies on the results page: each measures one part's record."""
