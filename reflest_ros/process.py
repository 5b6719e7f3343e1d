# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Start and end of a ROS process: a signal at any time ends it, whatever hangs."""

from __future__ import annotations

import contextlib
import ctypes
import gc
import os
import re
import signal
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import rclpy
from rclpy.signals import SignalHandlerOptions

from reflest_core.errors import ReflestError

SIGNALS = (signal.SIGINT, signal.SIGTERM)

HAND_OVER = 0.001
"""Seconds after which a thread must let another one run Python; 5 ms by default."""

CLEAN_UP_LIMIT = 20.0
"""Seconds that the clean-up may take after a signal; the process is then ended as it is."""

M_MMAP_THRESHOLD, LARGE_ARRAY = -3, 4 << 20
"""``mallopt``'s parameter, and bytes: above those of an image, below those of a scan's arrays."""

M_ARENA_MAX, ARENAS = -8, 2
"""``mallopt``'s parameter, and heaps. By default every new thread may begin one of its own, and
what one scan's threads freed is not used by those of the next."""

KILLED = 3
"""Exit code of a process whose clean-up took too long."""

PROFILE_VARIABLE = "FASTRTPS_DEFAULT_PROFILES_FILE"
PROFILE = Path(__file__).resolve().parents[1] / "config" / "fastdds_large_messages.xml"
"""Of Fast DDS, with shared memory for large messages; only in a checkout."""

PLACE = re.compile(r",? at /\S+\.(c|cpp|hpp):\d+")
"""Where in its sources the middleware found a mistake."""


class StartError(ReflestError):
    """ROS cannot be started with these arguments or in this environment."""


@contextlib.contextmanager
def ros_process(args: list[str] | None) -> Iterator[None]:
    """Hold a ROS context for the block; SIGINT and SIGTERM end the block early.

    rclpy's own handlers would invalidate the context at once, under the threads that still
    publish. Here a signal raises KeyboardInterrupt in the main thread, which leaves the block in
    order; later signals are ignored, so that nothing interrupts the clean-up.

    Args:
        args: Command line with ROS arguments; None: that of the process.

    Yields:
        Nothing.

    Raises:
        StartError: ROS cannot be started: its arguments, a parameter file or its security.
    """
    for number in SIGNALS:
        signal.signal(number, signal.default_int_handler)
    try:
        _init(args)
        yield
    except KeyboardInterrupt:
        pass
    finally:
        ignore_signals()
        rclpy.try_shutdown()


def _init(args: list[str] | None) -> None:
    """Start ROS; what it cannot use ends in one sentence."""
    try:
        rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
    except Exception as error:
        reason = PLACE.sub("", " ".join(str(error).split()))
        if os.environ.get("ROS_SECURITY_ENABLE", "").lower() == "true":
            keys = os.environ.get("ROS_SECURITY_KEYSTORE", "")
            reason += (
                f"; ROS_SECURITY_ENABLE is true and ROS_SECURITY_KEYSTORE is {keys!r}: create the "
                "node's keys with ros2 security create_enclave, or unset ROS_SECURITY_ENABLE"
            )
        raise StartError(f"ROS cannot be started: {reason}") from error


def use_private_domain() -> None:
    """Keep to this machine and off other robots' domain, unless the user chose one."""
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    os.environ.setdefault("ROS_DOMAIN_ID", str(1 + os.getpid() % 100))
    if PROFILE.exists():
        os.environ.setdefault(PROFILE_VARIABLE, str(PROFILE))


def ignore_signals() -> None:
    """Let the clean-up run to its end."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)


def limit_clean_up(seconds: float = CLEAN_UP_LIMIT) -> None:
    """End the process with exit code 3 if it still runs after ``seconds``.

    A thread that hangs in a callback, a kernel or a file system cannot be ended; without this the
    process would wait for it for ever.

    Args:
        seconds: Time that is left to the clean-up.
    """

    def end() -> None:
        running = ", ".join(
            thread.name
            for thread in threading.enumerate()
            if thread is not threading.current_thread()
        )
        print(
            f"reflest: error: the node did not end within {seconds:g} s (threads: {running}) and "
            "was stopped",
            file=sys.stderr,
            flush=True,
        )
        os._exit(KILLED)

    timer = threading.Timer(seconds, end)
    timer.daemon = True
    timer.start()


def limit_heaps() -> None:
    """Make glibc return large arrays to the system when they are freed, and keep few heaps.

    By default it stops doing so once one has been freed: the arrays of the next scan then come from
    heaps that only grow, with every page touched. Other C libraries have no such setting.
    """
    with contextlib.suppress(AttributeError, OSError):
        library = ctypes.CDLL(None)
        library.mallopt(M_MMAP_THRESHOLD, LARGE_ARRAY)
        library.mallopt(M_ARENA_MAX, ARENAS)


def give_back_memory() -> None:
    """Return what is no longer used to the system: arrays in cycles, and free pages of heaps.

    What :func:`avoid_pauses` keeps out of collections is looked at too, for a scan that was there
    then may have gone since.
    """
    was_frozen = gc.get_freeze_count() > 0
    gc.unfreeze()
    gc.collect()
    if was_frozen:
        gc.freeze()
    with contextlib.suppress(AttributeError, OSError):
        ctypes.CDLL(None).malloc_trim(0)


def avoid_pauses() -> None:
    """Make threads hand over soon, and keep loaded modules out of garbage collection.

    A collection of everything that the libraries hold stops every thread for 40 to 70 ms.
    """
    sys.setswitchinterval(HAND_OVER)
    gc.collect()
    gc.freeze()
