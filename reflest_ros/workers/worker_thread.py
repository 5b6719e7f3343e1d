# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A thread whose unexpected end is never silent."""

from __future__ import annotations

import threading
from collections.abc import Callable


def worker_thread(
    name: str, run: Callable[[], None], on_crash: Callable[[BaseException], None]
) -> threading.Thread:
    """Return a thread, not started, that runs ``run`` and hands what it raises to ``on_crash``."""

    def guarded() -> None:
        try:
            run()
        except BaseException as error:
            on_crash(error)

    return threading.Thread(target=guarded, name=name, daemon=True)
