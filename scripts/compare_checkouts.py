# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Compare every number that two checkouts give for the same input, bit for bit.

    python scripts/compare_checkouts.py OTHER_CHECKOUT [--capture PATH ...] [--model NAME ...]
    python scripts/compare_checkouts.py OTHER_CHECKOUT --time 5

Both checkouts replay the captures with each model, and estimate the scenes of the quick set, on
this machine, with this interpreter. Numbers are compared as JSON writes them, all digits; the
fields in ``IGNORED`` name versions and wordings. Exits with 1 where anything differs. With
``--time`` it compares processor time instead: both checkouts scan in turn, so often, and the
medians of a frame and of an estimate are divided.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
MODELS = ("lightnet", "hemicnn", "grouplet-fast")
IGNORED = {"schema_version", "settings", "status", "status_text", "capture", "refused", "warnings"}
"""Fields of a replay's JSON that hold versions, parameters and sentences."""
QUICK = """
import json, sys
from pathlib import Path
from reflest_core.models.predictor import Predictor
try:
    from reflest_core.training.data.sample_file import read_samples
except ImportError:
    from reflest_core.training.sample_file import read_samples
try:
    from reflest_core.evaluation.quick_check import QUICK_SET
except ImportError:
    from reflest_core.evaluation.quick_set import QUICK_SET
samples = read_samples(QUICK_SET)
samples = samples[0] if isinstance(samples, tuple) else samples
found = {}
for model in sys.argv[1:]:
    predictor = Predictor(model)
    found[model] = [predictor.predict(sample.surface).ward.tolist() for sample in samples]
print(json.dumps(found))
"""


TIMED = """
import json, sys, time
from reflest_core.capture.open_capture import open_capture
try:
    from reflest_core.estimation.pipeline import Pipeline
except ImportError:  # before it was named so
    from reflest_core.estimation.scanner import Scanner as Pipeline
from reflest_core.estimation.settings import EstimationSettings, ReflestSettings
from reflest_core.fusion.settings import RegionSettings
region = RegionSettings("sphere", (0.0, 0.0, 0.0), (0.6, 0.6, 0.6))
settings = ReflestSettings(estimation=EstimationSettings(model=sys.argv[2]), region=region)
frames = list(open_capture(sys.argv[1]))
for warm in (True, False):
    pipeline = Pipeline(settings)
    start = time.process_time()
    for frame in frames:
        pipeline.fuse(frame)
    fused = (time.process_time() - start) / len(frames)
    snapshot = pipeline.snapshot()
    start = time.process_time()
    for _ in range(1 if warm else 8):
        pipeline.estimate(snapshot)
    estimated = (time.process_time() - start) / (1 if warm else 8)
print(json.dumps([fused, estimated]))
"""


def main() -> int:
    """Compare and report; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("other", type=Path, help="a checkout of the other version")
    parser.add_argument("--capture", type=Path, action="append", help="a bag or an image folder")
    parser.add_argument("--model", action="append", help=f"default: {', '.join(MODELS)}")
    parser.add_argument("--time", type=int, metavar="RUNS", help="compare processor time instead")
    options = parser.parse_args()
    captures = options.capture or [ROOT / "captures" / "glossy-red"]
    models = options.model or list(MODELS)
    if options.time:
        return _compare_times(options.other.resolve(), captures, models, options.time)
    differences = compared = 0
    for name, numbers in _runs(options.other.resolve(), captures, models):
        ours, theirs = numbers
        found = list(_differences(ours, theirs, ""))
        count = sum(1 for _ in _leaves(ours))
        compared += count
        differences += len(found)
        print(f"{name}: {count} values, {len(found)} differ", flush=True)
        for line in found[:10]:
            print(f"  {line}")
    print(f"{compared} values compared, {differences} differ")
    return 1 if differences or not compared else 0


def _runs(
    other: Path, captures: list[Path], models: list[str]
) -> Iterator[tuple[str, tuple[Any, Any]]]:
    for capture in captures:
        for model in models:
            yield (
                f"replay {capture.name} {model}",
                (_replay(ROOT, capture, model), _replay(other, capture, model)),
            )
    quick = [model for model in models if model != "lightnet"]
    if quick:
        yield "quick set", (_python(ROOT, QUICK, quick), _python(other, QUICK, quick))


def _compare_times(other: Path, captures: list[Path], models: list[str], runs: int) -> int:
    for capture in captures:
        for model in models:
            times: dict[Path, list[list[float]]] = {ROOT: [], other: []}
            for _ in range(runs):
                for checkout, found in times.items():
                    arguments = [str(capture.resolve()), model]
                    found.append(_python(checkout, TIMED, arguments))
            ours, theirs = (
                [statistics.median(column) for column in zip(*times[checkout], strict=True)]
                for checkout in (ROOT, other)
            )
            for name, mine, before in zip(("a frame", "an estimate"), ours, theirs, strict=True):
                print(
                    f"{capture.name} {model}: {name} {1e3 * mine:.2f} ms of processor time here, "
                    f"{1e3 * before:.2f} there: {mine / before:.3f} times"
                )
    return 0


def _replay(checkout: Path, capture: Path, model: str) -> Any:
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out.json"
        arguments = ["replay", str(capture.resolve()), "--model", model, "--json", str(out)]
        _run(checkout, ["-m", "reflest_core.cli.main", *arguments])
        return json.loads(out.read_text())


def _python(checkout: Path, code: str, arguments: list[str]) -> Any:
    return json.loads(_run(checkout, ["-c", code, *arguments]).splitlines()[-1])


def _run(checkout: Path, arguments: list[str]) -> str:
    environment = {**os.environ, "PYTHONPATH": str(checkout)}
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=checkout,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        sys.exit(f"{checkout}: {' '.join(arguments)[:200]} failed:\n{done.stderr[-2000:]}")
    return done.stdout


def _differences(ours: Any, theirs: Any, place: str) -> Iterator[str]:
    if isinstance(theirs, dict) and isinstance(ours, dict):
        for key, value in theirs.items():
            if key in IGNORED:
                continue
            if key not in ours:
                yield f"{place}.{key}: missing"
            else:
                yield from _differences(ours[key], value, f"{place}.{key}")
    elif isinstance(theirs, list) and isinstance(ours, list) and len(ours) == len(theirs):
        for n, (mine, other) in enumerate(zip(ours, theirs, strict=True)):
            yield from _differences(mine, other, f"{place}[{n}]")
    elif ours != theirs:
        yield f"{place}: {ours!r} here, {theirs!r} there"


def _leaves(value: Any) -> Iterator[Any]:
    if isinstance(value, dict):
        for key, inner in value.items():
            if key not in IGNORED:
                yield from _leaves(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from _leaves(inner)
    else:
        yield value


if __name__ == "__main__":
    sys.exit(main())
