# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What each part of lightnet buys, and what a real camera's faults cost."""

from __future__ import annotations

from reflest_core.evaluation.sections.cells import Lines, Record
from reflest_core.evaluation.sections.markdown import table
from reflest_core.models.normalisation import WARD_NAMES


def realism(record: Record) -> Lines:
    """The cost of each fault."""
    networks = record["networks"]
    clean = record["rows"][0]["rmse"]
    body = []
    for row in record["rows"]:
        cells = [row["effect"]]
        for name in networks:
            error = row["rmse"][name]
            cells.append(f"{error:.3f} ({error - clean[name]:+.3f})")
        body.append(cells)
    return [
        "## What a real camera's faults cost",
        "",
        f"RMSE on {record['scenes']} validation scenes drawn by seed, with each fault of",
        "`reflest synbrdf generate --realism` alone and all together; in brackets the difference",
        "to a perfect camera.",
        "",
        *table(["fault", *networks.values()], body),
        "",
    ]


def realism_training(record: Record) -> Lines:
    """What training with faults buys and costs."""
    body = []
    for row in record["rows"]:
        without, hardened = row["without"], row["with"]
        cells = [row["network"], str(row["recipe"]["minibatches"])]
        for case in ("clean", "faults"):
            change = hardened[case] - without[case]
            cells += [f"{without[case]:.3f}", f"{hardened[case]:.3f} ({change:+.3f})"]
        body.append(cells)
    return [
        "## What training with these faults buys",
        "",
        f"RMSE on the same {record['scenes']} validation scenes, clean and with all faults, of the",
        "paper's networks trained without faults and with `reflest train --realism`, which shows",
        "them every scene a second time with the faults of a real capture. Minibatches are of the",
        "last training; what it started from had more.",
        "",
        *table(
            [
                "network",
                "minibatches with faults",
                "clean",
                "trained with faults",
                "all faults",
                "trained with faults",
            ],
            body,
        ),
        "",
    ]


def ablation(record: Record) -> Lines:
    """What is lost where one thing is left out."""
    runs = record["runs"]
    views = sorted(runs[0]["splits"]["held_out"], key=int, reverse=True)
    header = ["without", *(f"held out, {count} views" for count in views)]
    header += [f"validation, {count} views" for count in views] + [*WARD_NAMES, "minibatches"]
    whole = runs[0]["splits"]
    body = []
    for run in runs:
        cells = [run["without"]]
        for split in ("held_out", "validation"):
            for count in views:
                error = run["splits"][split][count]["rmse"]
                cells.append(f"{error:.3f} ({error - whole[split][count]['rmse']:+.3f})")
        per_parameter = run["splits"]["held_out"][views[0]]["rmse_per_parameter"]
        body.append([*cells, *per_parameter, run["minibatches"]])
    meanings = [f"- *{run['without']}*: {run['meaning']}" for run in runs if run["meaning"]]
    return [
        "## What each part of lightnet buys",
        "",
        "lightnet trained anew without one thing each, all by the same recipe on the same looks",
        f"without {', '.join(record['hold_out'])}; RMSE on training scenes under these held-out",
        "environments and on validation scenes under the others, in brackets the difference to the",
        f"whole. The parameters' columns are of held-out scenes at {views[0]} views. Where a look",
        "is at fewer views, nothing of the others is known. *Unseen* was not touched.",
        "",
        *meanings,
        "",
        *table(header, body),
        "",
    ]
