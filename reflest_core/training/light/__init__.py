# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Training ``lightnet``, the network that knows the light seen behind the object."""
