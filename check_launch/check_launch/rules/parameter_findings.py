"""Findings about parameters and plugins: unknown, misplaced, of a wrong type, outside of their range."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from typing import Any

from check_launch.catalogue.facts import Catalogue, NodeClass, Parameter
from check_launch.expansion.parameter_files import UNKNOWN, GivenValue, Section
from check_launch.misspellings import did_you_mean, is_near, nearest
from check_launch.rules.known_parameters import LoadedPlugin, ParameterView
from check_launch.rules.launch_rules import (
    MisplacedParameter,
    OneAxis,
    OutOfRange,
    PluginOfUnknownPackage,
    RepeatedParameter,
    SectionWithoutNode,
    UnknownParameter,
    UnknownPlugin,
    WrongType,
)
from check_launch.rules.system import RunningNode, System, Use, Variants
from roverlink.generator.diagnostics import Diagnostic, Span

_OF_RCL = re.compile(r"(?:qos_overrides\..*|use_sim_time)")
"""Parameters that the client libraries declare."""
_TYPES: dict[str, type | tuple[type, ...]] = {"bool": bool, "integer": int, "double": float, "string": str}
_SPELLED = {
    bool: "a truth value",
    int: "a whole number",
    float: "a floating point number",
    str: "a text",
    list: "a list",
}
_WANTED = {
    "bool": "true or false",
    "integer": "a whole number, such as 5",
    "double": "a floating point number, such as 0.5",
    "string": "a text, in quotation marks if it looks like a number or a truth value",
}
_CORE = re.compile(r"--([A-Za-z0-9]+/[A-Za-z0-9]+)(?:=.*)?$")
"""An argument that sets a parameter of RTAB-Map's library."""


def used_parameters(system: System) -> set[Use]:
    """Return the parameters that at least one node has."""
    return {
        (given.name, given.place)
        for node in system.nodes
        if node.view is not None
        for given in node.view.given.values()
        if node.view.known(given.name) is not None or node.view.is_open(given.name)
    }


def used_sections(system: System) -> set[Use]:
    """Return the sections of parameter files that are for at least one node."""
    return {(section.pattern, section.place) for node in system.nodes for _, section in node.sections}


def parameter_findings(system: System, catalogue: Catalogue, variants: Variants) -> Iterator[Diagnostic]:
    """Yield findings about the parameters of all nodes.

    A launch file may give a parameter to several nodes at once. That is right if one of them has it.
    """
    for node in system.nodes:
        view = node.view
        if view is None:
            continue
        yield from _of_plugins(view, catalogue)
        general = {given.name for given in node.started.general_values}
        for given in view.given.values():
            if given.name in general and given in node.started.general_values:
                continue  # for all nodes of a group; not each of them has it
            if (given.name, given.place) not in variants.parameters or view.known(given.name) is not None:
                yield from _of_value(given, node, view, system)
        yield from _of_axes(view)
        yield from _of_arguments(node, view)
    yield from _of_general_values(system)
    yield from _of_sections(system, catalogue, variants)


def standalone_findings(sections: Iterable[Section], catalogue: Catalogue) -> Iterator[Diagnostic]:
    """Yield findings about the sections of a parameter file that no launch file uses.

    A section is checked if its name is that of a node or program in the catalogue.
    """
    classes = _by_name(catalogue)
    for section in sections:
        yield from _repeated(section)
        if (facts := classes.get(section.node_name)) is None:
            yield from _of_unknown_section(section, classes)
            continue
        view = ParameterView(facts, {given.name: given for given in section.values}, catalogue)
        yield from _of_plugins(view, catalogue)
        for given in section.values:
            yield from _of_value(given, None, view, None, section.node_name)
        yield from _of_axes(view)


def _by_name(catalogue: Catalogue) -> dict[str, NodeClass]:
    """Return the class of each node by its usual names: of the program, of the node, and of nodes in other nodes."""
    found = {}
    for package in catalogue.packages.values():
        for executable, class_name in package.executables.items():
            if class_name in catalogue.classes:
                found[executable] = catalogue.classes[class_name]
    for facts in list(catalogue.classes.values()):
        if facts.default_name:
            found[facts.default_name] = facts
        for inner in facts.nodes:
            if inner.class_name in catalogue.classes:
                found[inner.name] = catalogue.classes[inner.class_name]
    return found


def _of_value(
    given: GivenValue, node: RunningNode | None, view: ParameterView, system: System | None, name: str = ""
) -> Iterator[Diagnostic]:
    shown = node.name if node is not None else name
    parameter = view.known(given.name)
    if parameter is None:
        if not view.is_open(given.name) and not _OF_RCL.fullmatch(given.name):
            yield _unknown(given, shown, node, view, system)
        return
    yield from _wrong_value(given, parameter)


def _unknown(
    given: GivenValue, shown: str, node: RunningNode | None, view: ParameterView, system: System | None
) -> Diagnostic:
    at = given.place
    known = list(view.exact)
    message = f"{shown} has no parameter '{given.name}'"
    for shared in view.facts.shared:
        renamed = view.catalogue.sets[shared.set].renamed
        if given.name in renamed:
            new = renamed[given.name]
            help = f"it is now '{new}'" if new else "it is gone, and nothing replaces it"
            return UnknownParameter.at(at, f"{message} any more", help)
    if near := nearest(given.name, known, 0.75):
        return UnknownParameter.at(at, message, did_you_mean(near))
    last = given.name.rpartition(".")[2]
    elsewhere = [name for name in known if name.rpartition(".")[2] == last]
    if elsewhere:
        places = _listed(elsewhere)
        return MisplacedParameter.at(at, f"'{given.name}' has no effect here in {shown}", f"it belongs to {places}")
    others = [other.name for other in system.nodes if _has(other, given.name) and other is not node] if system else []
    if others:
        return MisplacedParameter.at(at, message, f"it belongs to {_listed(others)}")
    near = nearest(last, dict.fromkeys(name.rpartition(".")[2] for name in known))
    full = next((name for name in known if near and name.rpartition(".")[2] == near), "")
    return UnknownParameter.at(at, message, did_you_mean(full))


def _has(node: RunningNode, name: str) -> bool:
    return node.view is not None and node.view.known(name) is not None


def _listed(names: Iterable[str]) -> str:
    found = list(dict.fromkeys(names))
    return " or ".join(f"'{name}'" for name in found[:3])


def _wrong_value(given: GivenValue, parameter: Parameter) -> Iterator[Diagnostic]:
    value, at = given.value, given.place
    if value is UNKNOWN or value is None or value == []:
        return
    if parameter.type and not _fits(value, parameter.type):
        wanted = _wanted(parameter.type)
        message = f"the parameter '{given.name}' is {_described(value)}; it must be {wanted}"
        yield WrongType.at(at, message, _spelling(value, parameter.type))
        return
    low, high = parameter.minimum, parameter.maximum
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if is_number and ((low is not None and value < low) or (high is not None and value > high)):
        yield OutOfRange.at(at, f"the parameter '{given.name}' is {value}; it must be {_limits(low, high)}")
    if parameter.choices and value not in parameter.choices:
        known = ", ".join(str(choice) for choice in parameter.choices)
        help = did_you_mean(nearest(str(value), map(str, parameter.choices)))
        yield OutOfRange.at(at, f"the parameter '{given.name}' is {value!r}; it must be one of: {known}", help)


def _limits(low: float | None, high: float | None) -> str:
    if low is not None and high is not None:
        return f"from {low:g} to {high:g}"
    return f"at least {low:g}" if low is not None else f"at most {high:g}"


def _fits(value: Any, type_: str) -> bool:
    if type_.endswith("_array"):
        inner = type_.removesuffix("_array")
        return isinstance(value, list) and all(_fits(item, inner) for item in value)
    wanted = _TYPES.get(type_)
    if wanted is None:
        return True
    return isinstance(value, wanted) and (type_ == "bool" or not isinstance(value, bool))


def _described(value: Any) -> str:
    text = str(value).lower() if isinstance(value, bool) else repr(value)
    return f"{text} ({_SPELLED.get(type(value), type(value).__name__)})"


def _wanted(type_: str) -> str:
    if type_.endswith("_array"):
        return f"a list, with each item {_WANTED.get(type_.removesuffix('_array'), '')}"
    return _WANTED[type_]


def _spelling(value: Any, type_: str) -> str:
    """Return how to write a value so that it has the wanted type; empty if that is not clear."""
    if type_ == "double" and isinstance(value, int) and not isinstance(value, bool):
        return f"write {value}.0"
    if type_ == "string" and isinstance(value, bool | int | float):
        return f'write "{str(value).lower() if isinstance(value, bool) else value}"'
    if type_ == "double_array" and isinstance(value, list) and all(isinstance(item, int | float) for item in value):
        return f"write [{', '.join(str(float(item)) for item in value)}]"
    if type_ in ("bool", "integer", "double") and isinstance(value, str):
        return "remove the quotation marks" if re.fullmatch(r"[-+\d.eE]+|true|false|True|False", value) else ""
    return ""


def _of_plugins(view: ParameterView, catalogue: Catalogue) -> Iterator[Diagnostic]:
    for plugin in view.plugins:
        if plugin.place is None or plugin.type is None:
            continue
        at = plugin.place
        if plugin.is_spare:
            yield from _spare(plugin, view)
        elif not plugin.type:
            key = f"{plugin.name}.{plugin.slot.type_key}"
            known = sorted(
                {name.rpartition(".")[0] for name in view.given if name.endswith(f".{plugin.slot.type_key}")}
            )
            help = did_you_mean(nearest(plugin.name, known).rpartition(".")[2], f"set '{key}'")
            yield UnknownPlugin.at(at, f"the plugin '{plugin.name}' has no type", help)
        elif not plugin.base:
            yield from _unknown_plugin(plugin, at, catalogue)
        elif plugin.base.rpartition("::")[2] != plugin.slot.base.rpartition("::")[2]:
            loads = f"'{plugin.slot.parameter}' loads a {plugin.slot.base}"
            yield UnknownPlugin.at(at, f"the plugin '{plugin.type}' is a {plugin.base}, but {loads}")


def _spare(plugin: LoadedPlugin, view: ParameterView) -> Iterator[Diagnostic]:
    """Yield a finding about a plugin that is not loaded: an error if it is a misspelling of one without parameters."""
    bare = [
        other.name
        for other in view.plugins
        if other.slot == plugin.slot
        and not other.is_spare
        and not any(key.startswith(f"{other.name}.") for key in view.given)
    ]
    near = [name for name in bare if is_near(plugin.name, name, 2)]
    if plugin.place is not None and near:
        message = f"the plugin '{plugin.name}' is not in '{plugin.slot.parameter}'"
        yield UnknownPlugin.at(plugin.place, message, did_you_mean(near[0]))


def _unknown_plugin(plugin: LoadedPlugin, at: Any, catalogue: Catalogue) -> Iterator[Diagnostic]:
    type_ = plugin.type or ""
    base = plugin.slot.base.rpartition("::")[2]
    fitting = {name for name, known in catalogue.plugins.items() if known.base.rpartition("::")[2] == base}
    short = {name.rpartition("::")[2]: name for name in fitting}
    near = nearest(type_, [*fitting, *short], 0.7)
    package = re.split(r"::|/", type_)[0]
    if near or package in catalogue.packages or plugin.slot.spellings:
        help = did_you_mean(near, f"plugins of this kind: {', '.join(sorted(fitting))}")
        yield UnknownPlugin.at(at, f"unknown plugin '{type_}' for '{plugin.slot.parameter}'", help)
    else:
        yield PluginOfUnknownPackage.at(
            at, f"the plugin '{type_}' is of a package that is not in the catalogue; its parameters are not checked"
        )


def _of_axes(view: ParameterView) -> Iterator[Diagnostic]:
    """Yield findings about parameters of the y axis whose counterpart of the x axis is not given."""
    for given in view.given.values():
        counterparts = (
            f"{given.name[:at]}x{given.name[at + 1 :]}" for at, letter in enumerate(given.name) if letter == "y"
        )
        for x in counterparts:
            if x in view.exact and given.name in view.exact and x not in view.given:
                yield OneAxis.at(given.place, f"'{given.name}' is given, but '{x}' is not", did_you_mean(x))


def _of_arguments(node: RunningNode, view: ParameterView) -> Iterator[Diagnostic]:
    """Yield findings about parameters of RTAB-Map's library that arguments set: ``--Grid/CellSize 0.05``."""
    if node.is_inner or not view.facts.shared:
        return
    sets = [view.catalogue.sets[shared.set] for shared in view.facts.shared]
    for argument in node.started.arguments:
        for word in (argument or "").split():
            match = _CORE.match(word)
            if match is None or any(match[1] in group.parameters or match[1] in group.renamed for group in sets):
                continue
            near = nearest(match[1], [name for group in sets for name in group.parameters])
            help = did_you_mean(near and f"--{near}")
            yield UnknownParameter.at(
                node.started.place, f"{node.name} has no parameter '{match[1]}' (argument '{word}')", help
            )


def _of_general_values(system: System) -> Iterator[Diagnostic]:
    """Yield findings about parameters for all nodes of a group that no node has."""
    users: dict[tuple[str, Span], list[RunningNode]] = {}
    for node in system.nodes:
        for given in node.started.general_values:
            users.setdefault((given.name, given.place), []).append(node)
    for (name, place), nodes in users.items():
        if any(node.view is None or node.view.known(name) or node.view.is_open(name) for node in nodes):
            continue
        if not _OF_RCL.fullmatch(name):
            known = {parameter for node in nodes if node.view for parameter in node.view.exact}
            message = f"no node of this group has a parameter '{name}'"
            yield UnknownParameter.at(place, message, did_you_mean(nearest(name, known)))


def _of_sections(system: System, catalogue: Catalogue, variants: Variants) -> Iterator[Diagnostic]:
    """Yield findings about sections of parameter files that no node of the launch file uses."""
    sections: dict[tuple[str, Use], tuple[Section, list[RunningNode]]] = {}
    for node in system.nodes:
        for use in node.started.files:
            for section in use.sections:
                key = (use.shown, (section.pattern, section.place))
                sections.setdefault(key, (section, []))[1].append(node)
    classes: dict[str, NodeClass] | None = None
    for (_, use_of_section), (section, nodes) in sections.items():
        yield from _repeated(section)
        if use_of_section not in variants.sections:
            classes = classes if classes is not None else _by_name(catalogue)
            known = [node for node in nodes if node.facts is not None]
            yield from _of_unused_section(section, known, classes, catalogue)


def _of_unused_section(
    section: Section, nodes: list[RunningNode], classes: dict[str, NodeClass], catalogue: Catalogue
) -> Iterator[Diagnostic]:
    at = section.place
    same = [node for node in nodes if node.name == section.node_name]
    if same:
        full = same[0].full_name
        help = f"write '{full}', or '/**/{section.node_name}' for any namespace"
        yield SectionWithoutNode.at(at, f"the section '{section.pattern}' is not for the node '{full}'", help)
        return
    if section.node_name in classes:
        yield from standalone_findings([section], catalogue)  # for a node that another launch file starts
        return
    if near := nearest(section.node_name, [node.name for node in nodes], 0.7):
        yield SectionWithoutNode.at(at, f"no node has the name '{section.node_name}'", did_you_mean(near))
    else:
        yield from _of_unknown_section(section, classes)


def _of_unknown_section(section: Section, classes: dict[str, NodeClass]) -> Iterator[Diagnostic]:
    if "*" in section.node_name:
        return
    if near := nearest(section.node_name, classes, 0.85):
        yield SectionWithoutNode.at(section.place, f"no node has the name '{section.node_name}'", did_you_mean(near))


def _repeated(section: Section) -> Iterator[Diagnostic]:
    counts = Counter(given.name for given in section.values)
    for given in section.values:
        if counts[given.name] > 1:
            counts[given.name] -= 1
            yield RepeatedParameter.at(
                given.place,
                f"the parameter '{given.name}' stands again further down, and only the last one has an effect",
            )
