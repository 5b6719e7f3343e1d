# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest synbrdf``: one module in this package for each product."""

from __future__ import annotations

import argparse
import importlib
from typing import Any

PRODUCTS = (
    "generate",
    "relight",
    "images",
    "xml",
    "render",
    "sequence",
    "tabletop",
    "measure",
    "card",
)


def add_parser(subparsers: Any) -> None:
    """Add the subcommand and its own subcommands.

    Args:
        subparsers: the subcommands of ``reflest``.
    """
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "synbrdf", help="generate SynBRDF scenes and sequences (needs the extra synbrdf)"
    )
    products = parser.add_subparsers(required=True, metavar="PRODUCT")
    for name in PRODUCTS:
        importlib.import_module(f"{__name__}.{name}").add_parser(products)
