# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What the light seen in the background explains of the surface's colours."""
