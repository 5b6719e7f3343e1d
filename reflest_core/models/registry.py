# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which networks there are: the built-in ones, and those that other packages register.

A package registers a network by an entry point of the group ``reflest.networks`` whose value is the
import path of a :class:`~reflest_core.models.definition.NetworkDefinition`, as in its
``pyproject.toml``::

    [project.entry-points."reflest.networks"]
    mynet = "my_package.mynet:MyNet"
"""

from __future__ import annotations

import warnings
from functools import cache
from importlib.metadata import EntryPoint, entry_points

from reflest_core.errors import ReflestError
from reflest_core.models.definition import Model, NetworkDefinition

GROUP = "reflest.networks"
BUILT_IN = (
    "reflest_core.models.lightnet.definition:LightNetDefinition",
    "reflest_core.models.hemicnn.definition:HemiCNNDefinition",
    "reflest_core.models.grouplet.definition:GroupletDefinition",
)
"""Import paths of the networks of this package, the default one first."""
DEVICES = ("cpu", "cuda")
"""Where a network can run."""


class RegistryError(ReflestError):
    """A network cannot be used, or is not registered."""


@cache
def networks() -> dict[str, NetworkDefinition]:
    """Every network by its name: the built-in ones, then others in the order of their names.

    An entry point that cannot be used is left out, with a warning that says why.
    """
    found = {made.name: made for made in (_loaded(path, path) for path in BUILT_IN)}
    for entry in sorted(entry_points(group=GROUP), key=lambda entry: entry.name):
        try:
            definition = _loaded(entry.name, entry.value)
            _check_names(definition, found)
        except RegistryError as error:
            warnings.warn(str(error), RuntimeWarning, stacklevel=2)
            continue
        found[definition.name] = definition
    return found


def network_named(name: str) -> NetworkDefinition:
    """Return the network of that name.

    Args:
        name: Of a network.

    Raises:
        RegistryError: There is none; the sentence lists those that there are.
    """
    known = networks()
    if name not in known:
        raise RegistryError(f"there is no network {name!r}; choose one of {', '.join(known)}")
    return known[name]


def models() -> dict[str, Model]:
    """Every model of every network, by the model's name."""
    return {model.name: model for network in networks().values() for model in network.models}


def network_of_model(name: str) -> NetworkDefinition:
    """Return the network that a model uses.

    Args:
        name: Of a model.

    Raises:
        RegistryError: There is no model of that name; the sentence lists those that there are.
    """
    for network in networks().values():
        if any(model.name == name for model in network.models):
            return network
    raise RegistryError(f"there is no model {name!r}; choose one of {', '.join(models())}")


def shipped_models() -> tuple[str, ...]:
    """Names of the models whose weights this installation holds."""
    return tuple(
        name
        for name, model in models().items()
        if model.weights is not None and model.weights.is_file()
    )


def _loaded(name: str, value: str) -> NetworkDefinition:
    """Import the definition of an entry point ``name = value`` and make it."""
    place = f"the network of the entry point {name} = {value}"
    try:
        made = EntryPoint(name, value, GROUP).load()()
    except Exception as error:
        raise RegistryError(
            f"{place} cannot be loaded ({type(error).__name__}: {error}): repair or uninstall its "
            "package"
        ) from error
    if not isinstance(made, NetworkDefinition):
        raise RegistryError(f"{place} is no NetworkDefinition: repair or uninstall its package")
    return made


def _check_names(definition: NetworkDefinition, others: dict[str, NetworkDefinition]) -> None:
    taken = {model.name for other in others.values() for model in other.models}
    if definition.name in others or taken & {model.name for model in definition.models}:
        raise RegistryError(
            f"the network {definition.name} of another package has a name, or a model with a name, "
            "that is taken: rename it or uninstall its package"
        )
