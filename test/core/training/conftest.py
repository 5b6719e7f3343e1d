# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Tiny networks train fastest on one thread."""

import pytest
import torch


@pytest.fixture(autouse=True)
def _one_thread():
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(threads)
