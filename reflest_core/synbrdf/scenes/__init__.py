# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a scene of SynBRDF is, how it is drawn and stored."""
