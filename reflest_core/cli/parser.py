# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The parser of every command: an example in its help, and the nearest word for a wrong one."""

from __future__ import annotations

import argparse
import difflib
import re
from collections.abc import Iterator
from pathlib import Path
from typing import NoReturn

from reflest_core.errors import ReflestError

EXAMPLES = {
    "": "reflest replay captures/glossy-red --report report.html",
    "replay": "reflest replay captures/glossy-red --json out.json --report report.html",
    "view": "reflest view captures/glossy-red --roi-sphere 0 0 0 0.15",
    "export": "reflest export scan.npz --format glb --out table.glb",
    "completion": "reflest completion bash > ~/.local/share/bash-completion/completions/reflest",
    "train": "reflest train synbrdf/train --variant grouplet-rmse1-ec --out trained",
    "evaluate": "reflest evaluate --quick",
    "synbrdf": "reflest synbrdf sequence --environments hdri --out scan",
    "synbrdf generate": "reflest synbrdf generate --environments hdri --out synbrdf/train",
    "synbrdf images": "reflest synbrdf images --environments hdri --scenes 0:2 --out images",
    "synbrdf xml": "reflest synbrdf xml --environments hdri --scenes 0:2 --out scenes",
    "synbrdf sequence": "reflest synbrdf sequence --environments hdri --out scan",
    "synbrdf tabletop": "reflest synbrdf tabletop --environments hdri --out table",
    "synbrdf relight": "reflest synbrdf relight synbrdf/train --out synbrdf/relit",
    "synbrdf measure": "reflest synbrdf measure jpeg --environments hdri",
    "synbrdf render": "reflest synbrdf render scene.xml --out picture.exr",
    "synbrdf card": "reflest synbrdf card --environments hdri --data synbrdf/train --out card",
}
"""A line that can be typed for each command, by its words after ``reflest``."""
NEAR = 0.6
"""Similarity from which a word is suggested, as of :func:`difflib.get_close_matches`."""


class SourceMissing(ReflestError):
    """A capture or scan that a command was given is not there."""


class Parser(argparse.ArgumentParser):
    """Parses like its base, and helps further."""

    def format_help(self) -> str:
        """The help with every option's default and the command's example.

        Returns:
            The text.
        """
        for action in self._actions:
            action.help = _with_default(action)
        example = EXAMPLES.get(self.prog.removeprefix("reflest").strip())
        text = super().format_help()
        return text if example is None else f"{text}\nexample: {example}\n"

    def error(self, message: str) -> NoReturn:
        """End with one line: what is wrong, and the nearest word that would be right.

        Args:
            message: what is wrong.
        """
        choice = re.match(r"argument (\S+): invalid choice: '(.*)' \(choose from (.*)\)", message)
        unknown = re.match(r"unrecognized arguments: (--?[\w-]+)", message)
        found: list[str] = []
        if choice is not None:
            found = _near(choice[2], re.findall(r"'([^']*)'", choice[3]))
        elif unknown is not None:
            found = _near(unknown[1], _options(self))
        hint = f"; did you mean {found[0]}?" if found else ""
        self.exit(2, f"{self.prog}: error: {message}{hint} (see `{self.prog} --help`)\n")


def _with_default(action: argparse.Action) -> str | None:
    """What an option means; its default is added where the words do not say it."""
    takes_value = bool(action.option_strings) and action.nargs != 0
    if not takes_value or action.required or "default" in (action.help or ""):
        return action.help
    value = action.default
    shown = "none" if value is None or value == [] else str(value).replace("%", "%%")
    return f"{action.help}; default: {shown}" if action.help else f"default: {shown}"


def check_source(path: Path) -> None:
    """Refuse a path that is not there, before anything slow is imported.

    Args:
        path: of a capture or a scan.

    Raises:
        SourceMissing: It does not exist, and the sentence names the nearest one beside it; or it
            cannot be reached.
    """
    folder = path.parent
    try:
        if path.exists():
            return
        if path.is_symlink():
            raise SourceMissing(f"{path} is a link to nothing: {path.readlink()} does not exist")
        beside = [one.name for one in folder.iterdir()] if folder.is_dir() else []
    except OSError as error:
        raise SourceMissing(f"{path} cannot be read: {error.strerror}") from error
    # Alike without their suffixes: red.hdr is not meant by nope.hdr.
    alike = [name for name in beside if _near(path.stem, [Path(name).stem])]
    found = _near(path.name, alike)
    hint = f"; did you mean {folder / found[0]}?" if found else ""
    raise SourceMissing(f"{path} does not exist{hint}")


def _near(word: str, known: list[str]) -> list[str]:
    return difflib.get_close_matches(word, known, n=1, cutoff=NEAR)


def _options(parser: argparse.ArgumentParser) -> list[str]:
    return [option for one in _parsers(parser) for option in one._option_string_actions]


def _parsers(parser: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    """A parser and those of its commands."""
    yield parser
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for below in action.choices.values():
                yield from _parsers(below)
