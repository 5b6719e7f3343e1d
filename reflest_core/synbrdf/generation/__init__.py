# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Generation of a data set, in processes or on a Dask cluster."""
