# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest completion``: what a shell needs to complete commands, options and paths."""

from __future__ import annotations

import argparse
from typing import Any

SHELLS = ("bash", "zsh", "tcsh")
EPILOG = """bash: write it to ~/.local/share/bash-completion/completions/reflest. zsh: to a file
_reflest in a folder of $fpath. tcsh: source it. Open a new shell then."""


def add_parser(subparsers: Any) -> None:
    """Add the subcommand.

    Args:
        subparsers: the subcommands of ``reflest``.
    """
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "completion",
        help="print a completion script for your shell",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("shell", choices=SHELLS)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Print the script.

    Args:
        options: the parsed command line.

    Returns:
        The exit code.
    """
    import shtab

    from reflest_core.cli.main import command_parser

    print(shtab.complete(command_parser(()), options.shell))
    return 0
