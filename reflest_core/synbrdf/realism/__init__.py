# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What real captures have and renders lack: drift, noise, compression, holes, jitter."""
