"""Findings about sections of parameter files: the launch files decide which node reads a section."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from check_launch.catalogue.facts import Catalogue, NodeClass
from check_launch.expansion.parameter_files import GivenValue, Section
from check_launch.misspellings import did_you_mean, is_misspelling
from check_launch.rules.known_parameters import ParameterView
from check_launch.rules.launch_rules import RepeatedParameter, SectionWithoutNode, WrongType, as_hint
from check_launch.rules.parameter_findings import view_findings
from check_launch.rules.stated_facts import stated_facts
from check_launch.rules.system import RunningNode, System
from roverlink.generator.diagnostics import Diagnostic, Span

_KINDS = {bool: "truth values", int: "whole numbers", float: "floating point numbers", list: "lists"}
"""Types of the items of a list, in messages."""
_ENOUGH = 0.5
"""Share of a section's parameters that a node has to have, so that the section is that node's."""


@dataclass(slots=True)
class _Loaded:
    """A section of a parameter file that a launch file gives to nodes."""

    section: Section
    nodes: dict[tuple[Span, str], RunningNode] = field(default_factory=dict)
    """Nodes that get the file, by their places and names."""
    is_read: bool = False
    """True if a node reads the section, or may read it."""


class Sections:
    """Sections of parameter files, and the nodes that read them in all launch files of a check."""

    def __init__(self, catalogue: Catalogue) -> None:
        self._catalogue = catalogue
        self._classes = _by_name(catalogue)
        self._loaded: dict[tuple[str, str, Span], _Loaded] = {}
        self._reading: set[tuple[Span, str, str]] = set()
        self.of_others: set[Span] = set()
        """Places of parameters for all nodes in sections of which a node has less than half: they serve other nodes."""
        self.read_files: set[str] = set()
        """Files with a section that a known node reads."""

    @property
    def files(self) -> set[str]:
        """Files that nodes of launch files get."""
        return {shown for shown, _, _ in self._loaded}

    def add(self, system: System) -> None:
        """Note which nodes of a system get and read which sections."""
        for node in system.nodes:
            read = {(section.pattern, section.place) for _, section in node.sections}
            for use in node.started.files:
                for section in use.sections:
                    # A file that the launch file writes has its sections at the places of the nodes that get it.
                    is_written = use.shown == node.started.place.file
                    key = (use.shown, section.pattern, Span(use.shown) if is_written else section.place)
                    loaded = self._loaded.setdefault(key, _Loaded(section))
                    loaded.nodes.setdefault((node.started.place, node.full_name), node)
                    if section.node_name == "**" and node.facts and self._fits(section.values, node.facts) < _ENOUGH:
                        self.of_others |= {given.place for given in section.values}
                    if (section.pattern, section.place) in read:
                        loaded.is_read = True
                        if node.facts is not None:
                            self.read_files.add(use.shown)
                        if section.node_name != "**":
                            self._reading.add((node.started.place, node.full_name, use.shown))
                    elif not node.has_known_name:
                        loaded.is_read = True  # perhaps by this node

    def findings(self) -> Iterator[Diagnostic]:
        """Yield findings about the sections of all files that launch files give to nodes."""
        for (shown, _, _), loaded in self._loaded.items():
            yield from _of_file(loaded.section, any(not node.started.plugin for node in loaded.nodes.values()))
            if not loaded.is_read:
                yield from self._unread(loaded.section, shown, list(loaded.nodes.values()))

    def _unread(self, section: Section, shown: str, nodes: list[RunningNode]) -> Iterator[Diagnostic]:
        at, name = section.place, section.node_name
        if "*" in name:
            return
        same = next((node for node in nodes if node.name == name), None)
        if same is not None:
            full = same.full_name
            help = f"write '{full}', or '/**/{name}' for any namespace"
            yield SectionWithoutNode.at(at, f"the section '{section.pattern}' is not for the node '{full}'", help)
            return
        message = f"no node that gets this file has the name '{name}'"
        # A node that gets the file and reads nothing of it: the section was meant for it.
        is_alone = len(nodes) == 1 and self._count(shown) == 1
        starved = {
            node.name: self._fits(section.values, node.facts) if node.facts is not None else 1.0
            for node in nodes
            if (node.started.place, node.full_name, shown) not in self._reading
            and self._is_meant(section, node, is_alone)
        }
        if starved:
            best = [name for name, share in starved.items() if share == max(starved.values())]
            yield SectionWithoutNode.at(at, message, did_you_mean(best[:3]))
            return
        near = sorted({node.name for node in nodes if is_misspelling(name, node.name)})
        if near and name not in self._classes:
            yield SectionWithoutNode.at(at, message, did_you_mean(near))
            return
        for finding in self._of_name(section):  # of a node that is started elsewhere
            yield as_hint(finding)

    def _count(self, shown: str) -> int:
        return sum(file == shown for file, _, _ in self._loaded)

    def _is_meant(self, section: Section, node: RunningNode, is_alone: bool) -> bool:
        """Return true if a section was meant for a node that gets the file; ``is_alone`` if both are the only ones."""
        if node.facts is None or node.facts.is_partial:  # perhaps it has any parameter
            return is_alone and section.node_name not in self._classes
        usual = self._classes.get(section.node_name)
        if usual is not None and usual.name == node.facts.name:
            return True
        is_other = usual is not None and usual.name.rpartition("::")[0] != node.facts.name.rpartition("::")[0]
        return not is_other and self._fits(section.values, node.facts) >= _ENOUGH

    def standalone(self, sections: Iterable[Section], shown: str, is_unused: bool) -> Iterator[Diagnostic]:
        """Yield findings about the sections of a file that no launch file of the check gives to a node.

        A section is that of the node whose usual name it has, if the node also has its parameters. With ``is_unused``,
        there are launch files that could have used the file, and the findings are hints.
        """
        for section in sections:
            facts = self._classes.get(section.node_name)
            if facts is not None and self._fits(section.values, facts) > 0:
                self.read_files.add(shown)
            for finding in (*_of_file(section), *self._of_name(section)):
                yield as_hint(finding) if is_unused else finding

    def _of_name(self, section: Section) -> Iterator[Diagnostic]:
        facts = self._classes.get(section.node_name)
        if facts is None:
            near = sorted(name for name in self._classes if is_misspelling(section.node_name, name))
            fitting = [name for name in near if self._fits(section.values, self._classes[name]) >= _ENOUGH]
            if fitting and "*" not in section.node_name:
                message = f"no node has the usual name '{section.node_name}'"
                yield as_hint(SectionWithoutNode.at(section.place, message, did_you_mean(fitting)))
            return
        share = self._fits(section.values, facts)
        if share == 0:
            return  # it is another node with the same name
        for finding in view_findings(self._view(section.values, facts), section.node_name):
            yield finding if share >= _ENOUGH else as_hint(finding)

    def _view(self, values: Iterable[GivenValue], facts: NodeClass) -> ParameterView:
        return ParameterView(facts, {given.name: given for given in values}, self._catalogue, is_partial=True)

    def _fits(self, values: tuple[GivenValue, ...], facts: NodeClass) -> float:
        """Return the share of parameters that a node has, had with another name, or would have if spelled rightly."""
        view = self._view(values, facts)
        own = [given.name for given in values if given.name != "use_sim_time"]
        known = [
            name
            for name in own
            if view.known(name) is not None
            or view.is_open(name)
            or stated_facts().new_name(name, lambda new: view.known(new) is not None)
            or view.is_misspelt(name)
        ]
        return len(known) / len(own) if own else 0.0


def _by_name(catalogue: Catalogue) -> dict[str, NodeClass]:
    """Return the class of each node by its usual names: of the program, of the node, and of nodes in other nodes."""
    found = {}
    for package in catalogue.packages.values():
        for executable, class_name in package.executables.items():
            if class_name in catalogue.classes:
                usual = stated_facts().usual_names.get(f"{package.name}/{executable}", executable)
                found[usual] = found[executable] = catalogue.classes[class_name]
    for facts in list(catalogue.classes.values()):
        if facts.default_name:
            found[facts.default_name] = facts
        for inner in facts.nodes:
            if inner.class_name in catalogue.classes:
                found[inner.name] = catalogue.classes[inner.class_name]
    return found


def _of_file(section: Section, is_of_program: bool = True) -> Iterator[Diagnostic]:
    """Yield findings that hold whatever node reads a section; ``is_of_program`` if one is not in a container."""
    seen: dict[str, Span] = {}
    for given in section.values:
        if given.name in seen:
            message = f"the parameter '{given.name}' stands again further down, and only the last one has an effect"
            yield RepeatedParameter.at(seen[given.name], message)
        seen[given.name] = given.place
        # `Sequence should be of same type`, or `Sequences cannot be key` after a list in a list (rcl_yaml_param_parser)
        kinds = {type(item) for item in given.value} if is_of_program and isinstance(given.value, list) else set()
        if len(kinds) > 1 or list in kinds:
            message = (
                f"the list '{given.name}' contains {' and '.join(sorted(_KINDS.get(kind, 'texts') for kind in kinds))}"
            )
            help = f"write {list(map(float, given.value))}" if kinds == {int, float} else ""
            yield WrongType.at(given.place, f"{message}; ROS 2 reads lists of values of one type only", help)
