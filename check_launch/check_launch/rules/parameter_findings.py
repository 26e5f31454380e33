"""Findings about parameters and plugins: unknown, misplaced, of a wrong type, outside of their range."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Set
from typing import Any

from check_launch.catalogue.facts import Catalogue, Parameter, PluginSlot
from check_launch.expansion.parameter_files import UNKNOWN, GivenValue
from check_launch.misspellings import (
    all_nearest,
    did_you_mean,
    is_misspelling,
    is_near,
    is_other_axis,
    nearest,
)
from check_launch.rules.known_parameters import LoadedPlugin, ParameterView
from check_launch.rules.launch_rules import (
    MisplacedParameter,
    OldName,
    OneAxis,
    OutOfRange,
    PluginOfUnknownPackage,
    UnknownParameter,
    UnknownPlugin,
    WrongType,
    as_hint,
    as_warning,
)
from check_launch.rules.node_findings import value_findings
from check_launch.rules.stated_facts import stated_facts
from check_launch.rules.system import RunningNode, System, Use, Variants
from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.numerals import counted

_OF_LIBRARIES = re.compile(
    r"qos_overrides\..*|use_sim_time|start_type_description_service|diagnostic_updater\..*"
    r"|.*\.(?:compressed|compressedDepth|ffmpeg|theora|zstd)\..*|.*\.enable_pub_plugins"
)
"""Parameters that the client libraries, diagnostic_updater and the publishers of image_transport declare."""
_KEY = ".ros__parameters."
"""Part of the name of a parameter in a section that stands in another one."""
_TYPES: dict[str, type | tuple[type, ...]] = {"bool": bool, "integer": int, "double": float, "string": str}
_MOST_UNKNOWN = 200
"""Unknown parameters of a node that are reported one by one: each search for the likely name takes milliseconds."""
_SAME_PART, _SAME_NAME = 0.84, 0.85
"""Similarities from which the last part of a name, or a whole name, is likely a misspelling of another one."""
_MOST_PLACES = 3
"""Places of a parameter in advice; a name that stands at more of them, such as ``frame_id``, tells nothing."""
_SHORT = 8
"""Names with fewer letters may begin as another one without being meant for it."""
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
    """Return the parameters that at least one node has, or may have because nothing is known about it."""
    unknown = (node for node in system.nodes if node.view is None)
    return {
        (given.name, given.place) for node in unknown for _, section in node.sections for given in section.values
    } | {
        (given.name, given.place)
        for node in system.nodes
        if node.view is not None
        for given in node.view.given.values()
        if node.view.may_have(given.name)
    }


def parameter_findings(system: System, variants: Variants) -> Iterator[Diagnostic]:
    """Yield findings about the parameters of all nodes.

    A launch file may give a parameter to several nodes at once. That is right if one of them has it.
    """
    for node in system.nodes:
        view = node.view
        if view is None:
            continue
        general = {(given.name, given.place) for given in node.started.general_values}
        others = {
            (given.name, given.place)
            for given in view.given.values()
            if (given.name, given.place) in general  # for all nodes of a group; not each of them has it
            or ((given.name, given.place) in variants.parameters and view.known(given.name) is None)
        }
        yield from view_findings(view, node.name, others, system)
        yield from _of_arguments(node, view)
    yield from _of_general_values(system)


def view_findings(
    view: ParameterView, shown: str, without: Set[Use] = frozenset(), system: System | None = None
) -> Iterator[Diagnostic]:
    """Yield findings about the parameters and plugins of a node with the name ``shown``.

    ``without`` are parameters that are right wherever they stand. Where the node may have parameters that are not
    known, "has no" is a hint.
    """
    is_unsure = view.has_unknown or (view.is_partial and system is not None)
    for finding in _of_plugins(view):
        yield as_hint(finding) if view.is_partial and system is not None else finding
    unknown: list[GivenValue] = []
    nested: dict[str, GivenValue] = {}
    for given in view.given.values():
        if (given.name, given.place) in without:
            continue
        parameter = view.known(given.name)
        if parameter is not None:
            yield from _wrong_value(given, parameter)
        elif _KEY in given.name:
            nested.setdefault(given.name.partition(_KEY)[0], given)
        elif not _OF_LIBRARIES.fullmatch(given.name):
            unknown.append(given)
    for section, given in nested.items():
        message = f"the section '{section}' stands in the parameters of {shown}, so that it has no effect"
        own = view.loaded_node(given.name)  # whose type stands there, too, and has to stay
        help = f"give '{own}' a section of its own" if own else f"move '{section}' out of '{shown}'"
        yield MisplacedParameter.at(given.place, message, help)
    found = (view.unlisted(given.name) for given in unknown if not view.is_open(given.name))
    for group, listed in dict.fromkeys(filter(None, found)):
        inside = [given for given in unknown if given.name.startswith(f"{group}.")]
        unknown = [given for given in unknown if given not in inside]
        if inside:  # not reported with a group around this one
            finding = _of_group(group, listed, inside, view)
            yield as_hint(finding) if is_unsure else finding
    for given in unknown[:_MOST_UNKNOWN]:
        if own := view.loaded_node(given.name):
            message = f"'{given.name}' has no effect here in {shown}: '{own}' is a node of its own"
            yield MisplacedParameter.at(given.place, message, f"it belongs to the section '{own}'")
            continue
        near = view.is_misspelt(given.name)
        if view.is_open(given.name) and not near:
            continue  # perhaps a parameter of a class that is not known
        finding = _unknown(given, shown, view, system)
        yield as_hint(finding) if (is_unsure and not near) or view.is_in_sources(given.name) else finding
    if rest := [given for given in unknown[_MOST_UNKNOWN:] if not view.is_open(given.name)]:
        message = f"{shown} has no parameter '{rest[0].name}', and none of {len(rest) - 1} more"
        finding = UnknownParameter.at(rest[0].place, message)
        yield as_hint(finding) if is_unsure else finding
    yield from _of_axes(view)
    for finding in value_findings(view):
        yield as_hint(finding) if view.is_partial and system is not None else finding


def _of_group(group: str, listed: str, inside: list[GivenValue], view: ParameterView) -> Diagnostic:
    """Return the finding about parameters of an item, such as a sensor, that is not in the list of such items."""
    item = group.rpartition(".")[2]
    beginning = group.removesuffix(item)
    near = [
        one for one in view.names(listed) or () if is_misspelling(item, one) and not view.gives_below(beginning + one)
    ]
    message = f"'{item}' is not in the list '{listed}', so that it has no effect ({counted(len(inside), 'parameter')})"
    return MisplacedParameter.at(inside[0].place, message, did_you_mean(near, "add it to the list, or remove it"))


def _unknown(given: GivenValue, shown: str, view: ParameterView, system: System | None) -> Diagnostic:
    at = given.place
    known = [name for name in view.exact if name not in view.given]
    message = f"{shown} has no parameter '{given.name}'"
    for shared in view.facts.shared:
        renamed = view.catalogue.sets[shared.set].renamed
        if given.name in renamed:
            new = renamed[given.name]
            help = f"it is now '{new}'" if new else "it is gone, and nothing replaces it"
            return UnknownParameter.at(at, f"{message} any more", help)
    if new := stated_facts().new_name(given.name, lambda name: view.known(name) is not None):
        return UnknownParameter.at(at, f"{message} any more", f"it is now '{new}'")
    if near := _nearest_parameters(given.name, known):
        return UnknownParameter.at(at, message, did_you_mean(near))
    last = given.name.rpartition(".")[2]
    new = stated_facts().new_last_part(given.name)
    elsewhere = [name for name in known if name.rpartition(".")[2] in (last, new)]
    if len(elsewhere) > _MOST_PLACES:
        return UnknownParameter.at(at, message)
    if elsewhere:
        places = _listed(elsewhere)
        return MisplacedParameter.at(at, f"'{given.name}' has no effect here in {shown}", f"it belongs to {places}")
    others: list[str] = []
    for other in system.nodes if system else ():
        if other.view is None or other.view is view or other.view.known(given.name) is None:
            continue
        if other.view.facts is view.facts:  # another costmap, which loads the plugin with the parameter
            plugin = next((one for one in other.view.plugins if given.name.startswith(f"{one.name}.")), None)
            if plugin is not None:
                text = f"{shown} does not load '{plugin.name}', so that '{given.name}' has no effect"
                return MisplacedParameter.at(at, text, f"add it to '{plugin.slot.parameter}', or remove it")
        others.append(other.name)
    users = sum(given.name in facts.parameters for facts in view.catalogue.classes.values())
    if others and users <= _MOST_PLACES:
        return MisplacedParameter.at(at, message, f"it belongs to {_listed(others)}")
    lasts = {name.rpartition(".")[2] for name in known}
    near_last = nearest(last, sorted(one for one in lasts if not is_other_axis(last, one)), _SAME_PART)
    full = next((name for name in known if near_last and name.rpartition(".")[2] == near_last), "")
    return UnknownParameter.at(at, message, did_you_mean(full))


def _nearest_parameters(name: str, known: list[str]) -> list[str]:
    """Return the parameters that were likely meant: beside this one, or with a misspelt plugin in front."""
    if stated_facts().new_last_part(name):
        return []  # the old name of another parameter is no misspelling
    prefix, _, last = name.rpartition(".")
    beside = {other.rpartition(".")[2]: other for other in known if other.rpartition(".")[0] == prefix}
    others = [other for other in known if other not in beside.values()]
    near = [beside[part] for part in all_nearest(last, beside, _SAME_PART)] or all_nearest(name, others, _SAME_NAME)
    longer = [other for other in known if other.startswith(name)] if len(name) >= _SHORT else []
    return near or (longer if len(longer) <= 2 else [])


def _listed(names: Iterable[str]) -> str:
    found = list(dict.fromkeys(names))
    return " or ".join(f"'{name}'" for name in found[:_MOST_PLACES])


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
        yield _outside(given, f"the parameter '{given.name}' is {value}; it must be {_limits(low, high)}")
    if parameter.choices and value not in parameter.choices:
        known = ", ".join(str(choice) for choice in parameter.choices)
        help = did_you_mean(nearest(str(value), map(str, parameter.choices)))
        yield _outside(given, f"the parameter '{given.name}' is {value!r}; it must be one of: {known}", help)


def _outside(given: GivenValue, message: str, help: str = "") -> Diagnostic:
    """Return an error, or a warning if the node takes another value and starts."""
    finding = OutOfRange.at(given.place, message, help)
    return as_warning(finding) if stated_facts().tolerates(given.name.rpartition(".")[2]) else finding


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


def _of_plugins(view: ParameterView) -> Iterator[Diagnostic]:
    for plugin in view.plugins:
        if plugin.place is None or plugin.type is None or _is_default(plugin, view):
            continue
        at = plugin.place
        if plugin.is_spare:
            yield from _spare(plugin, view)
        elif not plugin.type:
            key = f"{plugin.name}.{plugin.slot.type_key}"
            known = sorted(
                {name.rpartition(".")[0] for name in view.given if name.endswith(f".{plugin.slot.type_key}")}
            )
            near = [name for name in known if is_misspelling(plugin.name, name)]
            help = did_you_mean([name.rpartition(".")[2] for name in near], f"set '{key}'")
            yield UnknownPlugin.at(at, f"the plugin '{plugin.name}' has no type", help)
        elif not plugin.base:
            yield _unknown_plugin(plugin, at, view.catalogue)
        elif plugin.base.rpartition("::")[2] != plugin.slot.base.rpartition("::")[2]:
            loads = f"'{plugin.slot.parameter}' loads a {plugin.slot.base}"
            yield UnknownPlugin.at(at, f"the plugin '{plugin.type}' is a {plugin.base}, but {loads}")


def _is_default(plugin: LoadedPlugin, view: ParameterView) -> bool:
    """Return true for the type that the node itself names: its package may be another version than the catalogue's."""
    declared = view.exact.get(f"{plugin.name}.{plugin.slot.parameter}".lstrip("."))
    return plugin.slot.is_type and declared is not None and declared.default == plugin.type


def _spare(plugin: LoadedPlugin, view: ParameterView) -> Iterator[Diagnostic]:
    """Yield a finding about a plugin that is not loaded: an error if it is a misspelling of one without parameters."""
    bare = [
        other.name
        for other in view.plugins
        if other.slot == plugin.slot and not other.is_spare and not view.gives_below(other.name)
    ]
    near = [name for name in bare if is_near(plugin.name, name, 2)]
    if plugin.place is not None and near:
        message = f"the plugin '{plugin.name}' is not in '{plugin.slot.parameter}'"
        yield as_warning(UnknownPlugin.at(plugin.place, message, did_you_mean(near)))


def _affixes(slot: PluginSlot) -> Iterator[tuple[str, str]]:
    """Yield what stands around a short name of a plugin in its full name."""
    for spelling in slot.spellings:
        before, _, after = spelling.partition("{}")
        yield before, after


def _unknown_plugin(plugin: LoadedPlugin, at: Span, catalogue: Catalogue) -> Diagnostic:
    """Return an error about a plugin that cannot exist, or a hint about one of a package that is not known."""
    type_ = plugin.type or ""
    base = plugin.slot.base.rpartition("::")[2]
    fitting = {name for name, known in catalogue.plugins.items() if known.base.rpartition("::")[2] == base}
    short = {
        name.removeprefix(before).removesuffix(after) for name in fitting for before, after in _affixes(plugin.slot)
    }
    message = f"unknown plugin '{type_}' for '{plugin.slot.parameter}'"
    if (new := stated_facts().renamed_plugins.get(type_, "")) in fitting:
        return OldName.of(UnknownPlugin.at(at, message, f"it is now '{new}'"))
    spelled = {re.sub("::|/", "/", name): name for name in fitting}
    if same := spelled.get(re.sub("::|/", "/", type_)):
        return UnknownPlugin.at(at, message, did_you_mean(same))
    package = re.split(r"::|/", type_)[0]
    owner = catalogue.packages.get(package)
    is_known = owner is not None and not owner.is_partial
    if likely := sorted(name for name in (*fitting, *short) if is_misspelling(type_, name)):
        finding = UnknownPlugin.at(at, message, did_you_mean(likely))
        return finding if is_known or package == type_ else as_warning(finding)
    if longer := sorted(name for name in short if type_ and name.startswith(type_)):  # without its ending, `Critic`
        return UnknownPlugin.at(at, message, did_you_mean(longer))
    if is_known or (package == type_ and not plugin.slot.spellings):
        near = all_nearest(type_, [*fitting, *short], 0.7)
        return UnknownPlugin.at(at, message, did_you_mean(near, f"plugins of this kind: {', '.join(sorted(fitting))}"))
    message = f"the plugin '{type_}' is of a package that is not in the catalogue; its parameters are not checked"
    return PluginOfUnknownPackage.at(at, message)


def _of_axes(view: ParameterView) -> Iterator[Diagnostic]:
    """Yield findings about parameters of the y axis whose counterpart of the x axis is not given."""
    for given in view.given.values():
        before, dot, last = given.name.rpartition(".")  # a name before it may be that of a joint
        counterparts = (f"{before}{dot}{last[:at]}x{last[at + 1 :]}" for at, letter in enumerate(last) if letter == "y")
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
        if not _OF_LIBRARIES.fullmatch(name):
            known = {parameter for node in nodes if node.view for parameter in node.view.exact}
            message = f"no node of this group has a parameter '{name}'"
            finding = UnknownParameter.at(place, message, did_you_mean(nearest(name, known)))
            yield as_hint(finding) if system.has_unknown else finding
