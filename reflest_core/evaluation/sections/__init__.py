# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The sections of the results page, each a function from a record to Markdown lines."""
