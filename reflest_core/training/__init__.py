# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Training the networks on SynBRDF and measuring what they reach. Not on the live path."""
