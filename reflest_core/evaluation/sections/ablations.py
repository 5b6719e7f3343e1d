# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Sections: the parts of lightnet, and the faults of real cameras."""

from __future__ import annotations

from reflest_core.evaluation.sections.markdown import Lines, Record, table
from reflest_core.models.card import WARD_NAMES


def realism(record: Record) -> Lines:
    """Section: the error that each fault of a real camera adds.

    Args:
        record: Result of :func:`.measure_realism`.
    """
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
        "## Faults of real cameras",
        "",
        f"RMSE on {record['scenes']} validation scenes drawn by seed, with each fault of",
        "`reflest synbrdf generate --realism` alone and all together; in brackets the difference",
        "to a perfect camera.",
        "",
        *table(["fault", *networks.values()], body),
        "",
    ]


def realism_training(record: Record) -> Lines:
    """Section: errors of networks trained with and without these faults.

    Args:
        record: Result of :func:`.measure_realism_training`.
    """
    body = []
    for row in record["rows"]:
        without, hardened = row["without"], row["with"]
        cells = [row["network"], str(row["recipe"]["minibatches"])]
        for case in ("clean", "faults"):
            change = hardened[case] - without[case]
            cells += [f"{without[case]:.3f}", f"{hardened[case]:.3f} ({change:+.3f})"]
        body.append(cells)
    return [
        "## Training with faults",
        "",
        f"RMSE on the same {record['scenes']} validation scenes, clean and with all faults, of the",
        "paper's networks trained without faults and with `reflest train --realism`, which adds",
        "every scene a second time with the faults of a real capture. Minibatches are of the last",
        "training alone, which started from trained weights.",
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
    """Section: the error where one part of lightnet is left out.

    Args:
        record: Result of :func:`.collect_ablation`.
    """
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
        "## The parts of lightnet",
        "",
        "lightnet trained again without one part each, by the same recipe on the same scenes and",
        f"views, with the environments {', '.join(record['hold_out'])} held out. RMSE on training",
        "scenes under these environments and on validation scenes under the others, in brackets",
        "the difference to the whole network. The parameters' columns are of held-out scenes at",
        f"{views[0]} views. A smaller number of views is all that the network gets: no observation",
        "and no light of the other views. The *unseen* split was not used.",
        "",
        *meanings,
        "",
        *table(header, body),
        "",
    ]
