# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What the constants of realism are measured with: real fusion, a real codec."""
