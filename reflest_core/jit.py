# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Compilation of kernels to machine code.

The kernels run without the global interpreter lock, so that the estimator's thread goes on beside
them. Each has one order of evaluation, so that every result is bit-identical from run to run;
fusion shares its large ones out in pieces that do not depend on each other
(:mod:`reflest_core.fusion.work_sharing`). The compiled code is cached on disk; Numba notices an
edit only in the file of the kernel itself, so delete ``__pycache__`` after editing a function that
other files' kernels call.
"""

from __future__ import annotations

import contextlib
import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
import numpy as np
from numba.core import event
from numpy.typing import DTypeLike, NDArray
from tqdm import tqdm

CACHE_VARIABLE = "NUMBA_CACHE_DIR"
FIRST_RUN = "compiling kernels (first run after installation, a minute or two)"


def cache_where_possible() -> None:
    """Let Numba keep compiled kernels in a temporary folder where it has no other place.

    It keeps them beside the sources, else in the user's home; where neither can be written it
    refuses to compile at all. ``NUMBA_CACHE_DIR`` in the environment wins.
    """
    config = cast(Any, numba.config)
    if os.environ.get(CACHE_VARIABLE) or config.CACHE_DIR:
        return
    sources, home = Path(__file__).parent, Path(os.path.expanduser("~"))
    if any(os.access(folder, os.W_OK | os.X_OK) for folder in (sources, home)):
        return
    own = Path(tempfile.gettempdir()) / f"reflest-kernels-{os.getuid()}"
    with contextlib.suppress(FileExistsError):
        own.mkdir(mode=0o700)
    # Compiled code is run: it must be nobody else's.
    if own.is_symlink() or own.stat().st_uid != os.getuid() or own.stat().st_mode & 0o022:
        own = Path(tempfile.mkdtemp(prefix="reflest-kernels-"))
    config.CACHE_DIR = str(own)


cache_where_possible()

F = TypeVar("F", bound=Callable[..., object])


class _Announcement(event.Listener):
    """Says once on stderr that Numba compiles; a kernel from the cache on disk is no such event."""

    is_said = False

    def on_start(self, event: event.Event) -> None:
        if not self.is_said:
            self.is_said = True
            tqdm.write(f"reflest: {FIRST_RUN}", file=sys.stderr)
            sys.stderr.flush()

    def on_end(self, event: event.Event) -> None:
        """Nothing is left to say."""


_announcement = _Announcement()


def announce_compilation() -> None:
    """Say :data:`FIRST_RUN` on stderr when the first kernel of this process has to be compiled.

    Where all of them are cached nothing is said. May be called any number of times.
    """
    events = cast(Any, event)
    with contextlib.suppress(ValueError):  # it was not registered before
        events.unregister("numba:compile", _announcement)
    events.register("numba:compile", _announcement)


def compiled(function: F) -> F:
    """Compile a function at its first call.

    Args:
        function: Written in the subset of Python that Numba compiles.

    Returns:
        The compiled function.
    """
    return cast(F, numba.njit(cache=True, nogil=True, error_model="numpy")(function))


def vectorised(function: F) -> F:
    """Compile a function whose plain loops over finite numbers are to use vector instructions.

    No value depends on the flags but those of NaNs and the sign of zeros.

    Args:
        function: Written in the subset of Python that Numba compiles.

    Returns:
        The compiled function.
    """
    decorator = numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"nnan", "nsz"})
    return cast(F, decorator(function))


def fused(function: F) -> F:
    """Compile as :func:`vectorised` does, with products and sums in one instruction where possible.

    Last digits then depend on the processor, so that no choice may hang on them.

    Args:
        function: Written in the subset of Python that Numba compiles.

    Returns:
        The compiled function.
    """
    decorator = numba.njit(
        cache=True, nogil=True, error_model="numpy", fastmath={"nnan", "nsz", "contract"}
    )
    return cast(F, decorator(function))


def kernel_array(array: NDArray[Any], dtype: DTypeLike) -> NDArray[Any]:
    """Prepare an array for a kernel, which takes seconds to compile for every other layout.

    Images that wrap a message's buffer, for one, are read-only.

    Args:
        array: Any array.
        dtype: The type that the kernel takes.

    Returns:
        ``array`` itself or a copy: of ``dtype``, C-contiguous and writable.
    """
    if type(array) is np.ndarray and array.dtype == dtype:
        flags = array.flags
        if flags.c_contiguous and flags.writeable and flags.aligned:
            return array
    return np.require(array, dtype, ["C", "W"])
