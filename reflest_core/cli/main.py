# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest``: the command line, one module in this package for each subcommand."""

from __future__ import annotations

import importlib
import os
import re
import sys
from collections.abc import Sequence
from decimal import Decimal

from reflest_core import __version__
from reflest_core.cli.parser import Parser
from reflest_core.errors import ReflestError

COMMANDS = ("replay", "view", "export", "synbrdf", "train", "evaluate", "completion")
USER_ERROR = 2
INTERRUPTED = 130  # as shells report SIGINT
EXPONENT = re.compile(r"-(\d+\.?\d*|\.\d+)[eE][+-]?\d{1,2}")
EXTRAS = {
    "torch": "training",
    "tensorboard": "training",
    "matplotlib": "training",
    "skimage": "training",
    "flip_evaluator": "training",
    "mitsuba": "synbrdf",
    "drjit": "synbrdf",
    "pyoidn": "synbrdf",
    "dask": "cluster",
    "distributed": "cluster",
    "shtab": "completion",
}
"""Libraries that commands are built on, and the extra that brings them."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run ``reflest`` and return its exit code; 2 for a user's error.

    Args:
        arguments: the words after ``reflest``; None takes those of the process.

    Returns:
        The exit code.
    """
    given = [_without_exponent(word) for word in (sys.argv[1:] if arguments is None else arguments)]
    try:
        options = command_parser(given).parse_args(given)
        code: int = options.run(options)
        sys.stdout.flush()
        return code
    except ReflestError as error:
        print(f"reflest: error: {error}", file=sys.stderr)
        return USER_ERROR
    except ModuleNotFoundError as error:
        extra = EXTRAS.get((error.name or "").split(".")[0])
        if extra is None:
            raise
        print(
            f"reflest: error: this command needs {error.name}, which is not installed: "
            f"pip install 'reflest-ros[{extra}]'",
            file=sys.stderr,
        )
        return USER_ERROR
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:
        # The reader has gone (`reflest replay ... | head`); Python must not flush into it again.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1


def _without_exponent(word: str) -> str:
    """Write a negative number out: argparse takes -1e-3 for an option, but not -0.001."""
    return format(Decimal(word), "f") if EXPONENT.fullmatch(word) else word


def command_parser(given: Sequence[str]) -> Parser:
    """Make the parser of a command line.

    Args:
        given: its words. A command that is named is imported alone, so that it starts without the
            others' imports.

    Returns:
        The parser.
    """
    parser = Parser(prog="reflest", description="Estimates how a scanned surface reflects light.")
    parser.add_argument("--version", action="version", version=f"%(prog)s {__version__}")
    subparsers = parser.add_subparsers(metavar="COMMAND", required=True)
    named = [name for name in COMMANDS if name in given[:1]]
    for name in named or COMMANDS:
        importlib.import_module(f"reflest_core.cli.{name}").add_parser(subparsers)
    return parser


if __name__ == "__main__":
    sys.exit(main())
