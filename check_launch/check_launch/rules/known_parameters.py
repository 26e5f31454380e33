"""Parameters that a node has with its plugins, and the plugins that it loads."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import chain
from typing import Any

from check_launch.catalogue.facts import Catalogue, Endpoint, NodeClass, Parameter, PluginSlot
from check_launch.expansion.parameter_files import UNKNOWN, GivenValue
from check_launch.expansion.substitutions import UnknownTextError, evaluated
from check_launch.misspellings import is_misspelling, misspelt
from check_launch.rules.stated_facts import stated_facts
from roverlink.generator.diagnostics import Span

_LIST = re.compile(r"\{([^{}#*]+)\}")
_ITEM = re.compile(r"\{([^{}#*]+)\}\.([^{}]+)")
_FREE = re.compile(r"\{[#*]\}")
_VALUE = re.compile(r"\$\(([^()|]+)(?:\|([^()]*))?\)")
_NUMBER = r"(0|[1-9]\d*)"
_ANY_NAME = r"[^.]+"
_MOST_PLUGINS = 200
"""Longest list of plugins that is followed; behind a longer one, anything is possible."""


@dataclass(frozen=True, slots=True)
class LoadedPlugin:
    """A plugin that a node loads."""

    slot: PluginSlot
    name: str
    """Full name of the plugin's parameters, such as ``FollowPath.RotateToGoal``."""
    type: str | None
    """Type as the parameter or its default says; None if it is not known."""
    place: Span | None
    """Place of the parameter that decides; None if defaults decide."""
    base: str = ""
    """Base class of the plugin; empty if the plugin is not known."""
    is_spare: bool = False
    """True if the plugin has parameters, but is not in the list of those that are loaded."""


@dataclass(slots=True)
class ParameterView:
    """Parameters of one node: those that it has, and their values."""

    facts: NodeClass
    given: Mapping[str, GivenValue]
    catalogue: Catalogue
    is_partial: bool = False
    """True if the node may get more parameters than those that are given here."""
    exact: dict[str, Parameter] = field(default_factory=dict)
    """Parameters with a definite name."""
    patterns: list[tuple[re.Pattern[str], Parameter]] = field(default_factory=list)
    """Parameters whose names have parts that are not known; a group of digits is a number in the name."""
    open: list[str] = field(default_factory=list)
    """Beginnings of names behind which anything is possible, because a plugin is not known."""
    plugins: list[LoadedPlugin] = field(default_factory=list)
    endpoints: list[tuple[str, Endpoint]] = field(default_factory=list)
    """Topics of the node and its plugins, each with the beginning of its parameters."""
    _listed: set[str] = field(default_factory=set)
    """Plugins in the lists that are given."""
    _unlisted: set[str] = field(default_factory=set)
    """Beginnings of the names of plugins whose list is not given."""
    _lists: dict[tuple[str, str], str] = field(default_factory=dict)
    """Lists of sensors and plugins, by what stands before and behind an item in its parameters; empty if several."""

    def __post_init__(self) -> None:
        self._add(self.facts, "", set())
        # Another file may list other plugins, and say of which types they are.
        for prefix in self._unlisted:
            names = {key.removeprefix(prefix) for key in self.given if key.startswith(prefix)}
            groups = {prefix + name.partition(".")[0] for name in names if "." in name}
            self.open += sorted(f"{group}." for group in groups - self._listed)

    def known(self, name: str) -> Parameter | None:
        """Return the parameter with a name; None if the node has none."""
        if name in self.exact:
            return self.exact[name]
        for pattern, parameter in self.patterns:
            match = pattern.fullmatch(name)
            if match and (not match.groups() or int(match[1]) < self._count(name[: match.start(1)])):
                return parameter
        return None

    def _count(self, beginning: str) -> int:
        """Return how many parameters ``odom0``, ``odom1``... are given, without a gap: a node reads no more of them."""
        count = 0
        while f"{beginning}{count}" in self.given:
            count += 1
        return count

    def is_open(self, name: str) -> bool:
        """Return true if a parameter of this name may be one of a plugin that is not known."""
        return any(name.startswith(prefix) for prefix in self.open)

    def may_have(self, name: str) -> bool:
        """Return true for a parameter that is known, or one that an unknown class may have."""
        if self.known(name) is not None:
            return True
        return self.is_open(name) and not (self.is_misspelt(name) or self.loaded_node(name))

    def loaded_node(self, name: str) -> str:
        """Return the node to which a parameter belongs by its beginning, if this node creates it for a plugin.

        Such a node, a controller, has a section of its own.
        """
        own = name.partition(".")[0]
        is_loaded = any(inner.type_parameter.replace("{*}", own) in self.given for inner in self.facts.nodes)
        return own if "." in name and is_loaded else ""

    def unlisted(self, name: str) -> tuple[str, str] | None:
        """Return the group of a parameter, such as ``layer.scan``, and the list that lacks it; None if none does."""
        parts = name.split(".")
        for at in range(len(parts) - 1):
            beginning = "".join(f"{part}." for part in parts[:at])
            listed, group = self._lists.get((beginning, ".".join(parts[at + 1 :])), ""), beginning + parts[at]
            if listed and not any(known.startswith(f"{group}.") for known in self.exact):
                return group, listed
        return None

    def gives_below(self, name: str) -> bool:
        """Return true if a parameter of a group, such as ``voxel_layer``, is given."""
        return any(given.startswith(f"{name}.") for given in self.given)

    def is_in_sources(self, name: str) -> bool:
        """Return true if a text in the sources of the node may name the parameter in a way that was not understood."""
        return bool({name, name.rpartition(".")[2]} & self.facts.other_texts)

    def is_misspelt(self, name: str) -> bool:
        """Return true for the misspelling of a parameter that is known and not given."""
        return any(other not in self.given for other in misspelt(name, self.exact))

    @property
    def has_unknown(self) -> bool:
        """True if the node may have more parameters and topics, because it loads a plugin that is not known."""
        return bool(self.open) or self.loads_own_tree_nodes

    @property
    def loads_own_tree_nodes(self) -> bool:
        """True if the node loads nodes of behavior trees that are not those of Nav2."""
        given = self.given.get("plugin_lib_names")
        names = given.value if given is not None else []
        return not isinstance(names, list) or not set(map(str, names)) <= set(stated_facts().tree_nodes)

    def value(self, name: str) -> Any:
        """Return the value of a parameter, or its default; `UNKNOWN` if neither is known, None if there is none."""
        if name in self.given:
            return self.given[name].value
        parameter = self.known(name)
        return None if parameter is None else parameter.default

    def names(self, name: str) -> list[str] | None:
        """Return the names in the value of a parameter: those of a list, or the words of a text; None if not known."""
        value = self.value(name)
        if value is UNKNOWN:
            return None
        if isinstance(value, str):
            return value.split()
        return [str(item) for item in value] if isinstance(value, list) else []

    def text(self, text: str, prefix: str) -> str | None:
        """Replace ``$(x)`` in a text by the value of the parameter x; None if one of them is not known."""
        unknown = False

        def replaced(match: re.Match[str]) -> str:
            nonlocal unknown
            name = prefix + match[1]
            # A file that is not here may give a value, so that the default of a topic or frame is not known to hold.
            value = UNKNOWN if self.is_partial and name not in self.given else self.value(name)
            if value is None or value == "":
                value = match[2] if match[2] is not None else value
            if value is UNKNOWN or value is None:
                unknown = True
                return ""
            return str(value)

        while _VALUE.search(text) and not unknown:
            text = _VALUE.sub(replaced, text)
        return None if unknown else text

    def holds(self, condition: str, prefix: str, with_defaults: bool = True) -> bool | None:
        """Return the truth value of a condition on parameters; None if it is not known.

        Without defaults, a parameter that is not given has an unknown value: a file that is not here may give it.
        """
        if not condition:
            return True
        values: dict[str, Any] = {"true": True, "false": False, "True": True, "False": False}

        def replaced(match: re.Match[str]) -> str:
            name = prefix + match[1]
            if name not in self.given and self.known(name) is None:  # a parameter of the node around a plugin
                name = match[1]
            value = self.value(name) if with_defaults or name in self.given else UNKNOWN
            values[f"value{len(values)}"] = _Unknown() if value is UNKNOWN else "" if value is None else value
            return f"value{len(values) - 1}"

        try:
            return bool(evaluated(_VALUE.sub(replaced, condition), values))
        except (UnknownTextError, _UnknownUsedError):
            return None

    def is_given(self, text: str, prefix: str) -> GivenValue | None:
        """Return the first parameter in a text that a launch file or parameter file gives."""
        names = (prefix + match[1] for match in _VALUE.finditer(text))
        return next((self.given[name] for name in names if name in self.given), None)

    def spelled(self, text: str, prefix: str) -> Iterator[str]:
        """Yield a text once for each name that its ``{x}`` stands for: the names in the value of the parameter x."""
        match = _LIST.search(text)
        if match is None:
            yield from self._numbered(text, prefix)
            return
        for name in self.names(prefix + match[1]) or ():
            yield from self.spelled(text.replace(match[0], name), prefix)

    def _numbered(self, text: str, prefix: str) -> Iterator[str]:
        """Yield a text once for each parameter like ``odom0`` (`{#}`) or ``topics.joy.topic`` (`{*}`) that is given."""
        match, variable = _VALUE.search(text), _FREE.search(text)
        if variable is None or match is None:
            yield text
            return
        inner = _NUMBER if variable[0] == "{#}" else f"({_ANY_NAME})"
        pattern = re.compile(re.escape(prefix + match[1]).replace(re.escape(variable[0]), inner))
        for name in self.given:
            if found := pattern.fullmatch(name):
                yield text.replace(variable[0], found[1])

    def _add(self, facts: NodeClass, prefix: str, seen: set[str], parent: str = "") -> None:
        """Add the parameters of a class whose names begin with ``prefix``, and those of its plugins.

        ``parent`` is the beginning of the parameters of the plugin around it.
        """
        if prefix + facts.name in seen:
            return
        seen = seen | {prefix + facts.name}
        if facts.is_partial:
            self.open.append(prefix)
        for pattern, parameter in facts.parameters.items():
            self._add_pattern(pattern, parameter, prefix)
        for pattern, parameter in facts.of_node.items():
            self._add_pattern(pattern, parameter, "")
        for pattern, parameter in facts.of_parent.items():
            self._add_pattern(pattern, parameter, parent)
        for shared in facts.shared:
            for name, parameter in self.catalogue.sets[shared.set].parameters.items():
                if (not shared.groups or _is_of(name, shared.groups)) and not _is_of(name, shared.without):
                    self.exact.setdefault(prefix + name, parameter)
        self.endpoints += [(prefix, endpoint) for endpoint in facts.endpoints]
        for slot in facts.slots:
            self._add_slot(slot, facts, prefix, seen)

    def _add_pattern(self, pattern: str, parameter: Parameter, prefix: str) -> None:
        if "{" not in pattern:
            self.exact.setdefault(prefix + pattern, parameter)
            return
        if (item := _ITEM.fullmatch(pattern)) and self.names(prefix + item[1]) is not None:
            self._note_list(prefix, item[2], prefix + item[1])
        alternatives = [pattern.replace("{*}", f"\0{_ANY_NAME}\0")]
        for match in _LIST.finditer(pattern):
            names = self.names(prefix + match[1])
            inner = [_ANY_NAME] if names is None else [re.escape(name) for name in names]
            alternatives = [
                alternative.replace(match[0], f"\0{name}\0") for alternative in alternatives for name in inner
            ]
        for alternative in alternatives:
            parts = alternative.split("\0")
            text = "".join(re.escape(part) if index % 2 == 0 else part for index, part in enumerate(parts))
            if len(parts) <= 3 and "#" not in alternative and _ANY_NAME not in alternative:
                self.exact.setdefault(prefix + re.sub(r"\\(.)", r"\1", alternative.replace("\0", "")), parameter)
            else:
                self.patterns.append((re.compile(re.escape(prefix) + text.replace(r"\{\#\}", _NUMBER)), parameter))

    def _add_slot(self, slot: PluginSlot, facts: NodeClass, prefix: str, seen: set[str]) -> None:
        full = prefix + slot.parameter
        place = self.given[full].place if full in self.given else None
        if slot.is_type:
            value = self.value(full)
            type_ = None if value is UNKNOWN else str(value or "")
            self._load(LoadedPlugin(slot, prefix.rstrip("."), type_, place), prefix, prefix, seen)
            return
        names = self.names(full)
        if names is None or len(names) > _MOST_PLUGINS:
            self.open.append(prefix)
            return
        if full in self.given:
            self._listed |= {prefix + name for name in names}
        elif self.is_partial:
            self._unlisted.add(prefix)
        for name in names:
            inner = f"{prefix}{name}."
            type_, type_place = self._type(slot, facts, prefix, name)
            self._load(LoadedPlugin(slot, prefix + name, type_, type_place or place), inner, prefix, seen)
            for rest in [key.removeprefix(inner) for key in self.exact if key.startswith(inner)]:
                self._note_list(prefix, rest, full)
        if slot.type_key == "plugin":
            self._add_spare(slot, prefix, seen)

    def _note_list(self, before: str, behind: str, listed: str) -> None:
        if self._lists.setdefault((before, behind), listed) != listed:
            self._lists[before, behind] = ""

    def _add_spare(self, slot: PluginSlot, prefix: str, seen: set[str]) -> None:
        """Add the parameters of plugins that are configured, but not in the list of those that are loaded."""
        configured = {plugin.name for plugin in self.plugins}
        for key, given in list(self.given.items()):
            name = key.removeprefix(prefix).removesuffix(".plugin")
            if key != f"{prefix}{name}.plugin" or not name or "." in name or prefix + name in configured:
                continue
            plugin = self.catalogue.plugins.get(str(given.value))
            if plugin is not None and plugin.base.rpartition("::")[2] == slot.base.rpartition("::")[2]:
                self.exact.setdefault(key, Parameter("string"))
                spare = LoadedPlugin(slot, prefix + name, str(given.value), given.place, is_spare=True)
                self._load(spare, f"{prefix}{name}.", prefix, seen)

    def _type(self, slot: PluginSlot, facts: NodeClass, prefix: str, name: str) -> tuple[str | None, Span | None]:
        """Return the type of a plugin, and the place that states it; the type is empty if nothing states it."""
        if not slot.type_key:
            return name, None
        key = f"{prefix}{name}.{slot.type_key}"
        self.exact.setdefault(key, Parameter("string"))
        if key in self.given:
            value = self.given[key].value
            return None if value is UNKNOWN else str(value), self.given[key].place
        listed, names = facts.parameters.get(slot.parameter), self.value(prefix + slot.parameter)
        default = facts.parameters.get(f"{name}.{slot.type_key}")
        # Nodes declare types for the default list as a whole: with any other list, each plugin needs its type.
        is_default = listed is None or listed.default is None or names is UNKNOWN or names == listed.default
        if default is not None and default.default and is_default:
            return str(default.default), None
        return (name if slot.spellings else ""), None

    def _load(self, plugin: LoadedPlugin, prefix: str, parent: str, seen: set[str]) -> None:
        found = None
        if plugin.type:
            for spelling in ("{}", *plugin.slot.spellings):
                found = found or self.catalogue.plugins.get(spelling.format(plugin.type))
        self.plugins.append(replace(plugin, base=found.base if found else ""))
        if found is None and plugin.type:  # the parameters of the plugin that is likely meant; rules report the type
            names = self.catalogue.plugins
            same = (name for name in names if name.replace("::", "/") == str(plugin.type).replace("::", "/"))
            near = (name for name in names if is_misspelling(str(plugin.type), name))
            found = names.get(next(chain(same, near), ""))
        facts = self.catalogue.classes.get(found.class_name) if found else None
        if found is None:
            self.open.append(prefix)
        elif facts is not None:
            endpoints = len(self.endpoints)
            self._add(facts, prefix, seen, parent)
            if plugin.is_spare:
                del self.endpoints[endpoints:]


class _UnknownUsedError(Exception):
    """Raised when a value is used that is not known."""


class _Unknown:
    """Value in a condition that raises `_UnknownUsedError` when it is used."""

    def __bool__(self) -> bool:
        raise _UnknownUsedError

    def __eq__(self, other: object) -> bool:
        raise _UnknownUsedError

    def __gt__(self, other: object) -> bool:
        raise _UnknownUsedError

    __hash__ = None  # type: ignore[assignment]  # a class with __eq__ and no hash


@cache
def _is_of(name: str, groups: tuple[str, ...]) -> bool:
    """Return true if a name of RTAB-Map is of one of the groups, such as ``Grid``, ``Odom*`` or ``Kp/ByteToFloat``."""
    group = name.partition("/")[0]
    return any(
        name == wanted or group == wanted or (wanted.endswith("*") and name.startswith(wanted.removesuffix("*")))
        for wanted in groups
    )
