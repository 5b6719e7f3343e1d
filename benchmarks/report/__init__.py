# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What was measured as tables, a page and plots; nothing here is typed by hand."""
