# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Runs each measurement in a process of its own, with a fixed number of cores and threads.

``python -m benchmarks.measuring.fresh_process MODULE ARGUMENTS OUT`` is that process: it calls
``MODULE.measure(**arguments)`` and writes the result as JSON.
"""

from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from benchmarks.measuring.machine import ROOT
from reflest_core.errors import ReflestError

THREAD_VARIABLES = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "NUMBA_NUM_THREADS",
)


class MeasurementFailed(ReflestError):
    """A measurement's process ended with an error, which it printed."""


def measured(module: str, cores: int | None = None, **arguments: Any) -> dict[str, Any]:
    """Call ``module.measure(**arguments)`` in a fresh process.

    Args:
        module: Name of the module.
        cores: Cores of the process and threads of its libraries; None for no limit.
        arguments: JSON values.

    Returns:
        What the function returned.

    Raises:
        MeasurementFailed: the process ended with an error.
    """
    environment = {**os.environ}
    command = [sys.executable, "-m", "benchmarks.measuring.fresh_process"]
    if cores is not None:
        environment |= dict.fromkeys(THREAD_VARIABLES, str(cores))
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "result.json"
        command += [module, json.dumps(arguments), str(out), str(cores or 0)]
        done = subprocess.run(command, cwd=ROOT, env=environment)
        if done.returncode != 0:
            raise MeasurementFailed(f"{module} ended with exit code {done.returncode}")
        result: dict[str, Any] = json.loads(out.read_text())
        return result


def _main() -> int:
    module, arguments, out, cores = sys.argv[1:]
    if int(cores):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[: int(cores)])
    try:
        result = importlib.import_module(module).measure(**json.loads(arguments))
    except ReflestError as error:
        print(f"reflest: error: {error}", file=sys.stderr)
        return 2
    Path(out).write_text(json.dumps(result, allow_nan=False))
    return 0


if __name__ == "__main__":
    sys.exit(_main())
