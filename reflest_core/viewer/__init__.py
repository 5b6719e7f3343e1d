# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A scan with its materials in the browser: a page that turns, and says what is under a click."""
