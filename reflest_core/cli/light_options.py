# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Options of ``reflest train`` that ``lightnet`` alone has."""

from __future__ import annotations

import argparse
import dataclasses
import os
from pathlib import Path
from typing import TYPE_CHECKING

from reflest_core.parameter import ParameterError

if TYPE_CHECKING:
    from reflest_core.training.light.light_course import LightCourse
    from reflest_core.training.processes import Processes
    from reflest_core.training.recipe import Recipe

LOOKS = 4


def add_light_options(parser: argparse.ArgumentParser) -> None:
    """Add them, as a group."""
    group = parser.add_argument_group("lightnet", "options of --model lightnet")
    group.add_argument(
        "--shadings",
        type=Path,
        metavar="FOLDER",
        help="what shading finds in the scenes, made once; runs may share it; "
        "default: OUT/shadings",
    )
    group.add_argument("--jobs", type=int, help="processes that shade; default: one for each core")
    group.add_argument("--looks", type=int, help=f"at each training scene; default: {LOOKS}")
    group.add_argument(
        "--hold-out",
        nargs="+",
        metavar="ENVIRONMENT",
        help="train without these environments, in mixtures too; measure and calibrate on them",
    )
    group.add_argument(
        "--calibration",
        type=Path,
        nargs="+",
        metavar="RUN",
        help="folders of trainings with --hold-out: calibrate on all that they held out",
    )
    group.add_argument(
        "--without",
        nargs="+",
        metavar="PART",
        help="light, fit, completion, shares, uncertainty: see what each buys",
    )
    group.add_argument("--observations", type=int, help="of one voxel in a minibatch")


def refuse_light_options(arguments: argparse.Namespace) -> None:
    """Raise :class:`ParameterError` if one was given for another network."""
    names = ("shadings", "jobs", "looks", "hold_out", "calibration", "without", "observations")
    for name in names:
        if getattr(arguments, name) is not None:
            option = name.replace("_", "-")
            raise ParameterError(f"--{option} goes with --model lightnet: no other network has it")


def light_recipe(recipe: Recipe, arguments: argparse.Namespace) -> Recipe:
    """``recipe`` with what was given; refuses what ``lightnet`` does not have."""
    for name in ("loss", "colour_constancy", "realism"):
        if getattr(arguments, name) is not None:
            raise ParameterError(
                "--loss, --lambda and --realism are not lightnet's: its loss is a likelihood, and "
                "half of its looks have faults anyway"
            )
    for name in ("nodes_per_voxel", "views", "candidates"):
        if getattr(arguments, name) is not None:
            option = name.replace("_", "-")
            raise ParameterError(f"lightnet has no --{option}: its looks are drawn when shaded")
    if arguments.recipe == "paper":
        raise ParameterError("the paper has no recipe for lightnet: leave --recipe out")
    if arguments.hold_out and arguments.calibration:
        raise ParameterError(
            "--calibration goes without --hold-out: what is held out gives a calibration itself"
        )
    return dataclasses.replace(
        recipe,
        hold_out=tuple(sorted(arguments.hold_out or ())),
        without=tuple(sorted(arguments.without or ())),
        observations=arguments.observations or recipe.observations,
    )


def light_course(
    recipe: Recipe, arguments: argparse.Namespace, processes: Processes
) -> LightCourse:
    """Shade what is missing, in the first process, and load it."""
    from reflest_core.training.light.ablation import check_parts
    from reflest_core.training.light.light_course import LightCourse
    from reflest_core.training.light.light_data import ShadingPlace, load_light_data
    from reflest_core.training.light.measured_looks import MeasuredLooks

    check_parts(recipe.without)
    measured = [MeasuredLooks.read(folder) for folder in arguments.calibration or ()]
    held_out = MeasuredLooks.joined(measured) if measured else None
    jobs = arguments.jobs or os.cpu_count() or 1
    place = ShadingPlace(arguments.shadings or arguments.out / "shadings", jobs)
    with processes.first_alone():
        data = load_light_data(arguments.data, recipe, arguments.looks or LOOKS, place)
    return LightCourse(recipe, data, processes.device, held_out)
