"""The system that a launch file starts: nodes with their parameters, topics and transforms."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Set
from dataclasses import dataclass, field
from itertools import pairwise

from check_launch.catalogue.facts import WORKSPACE_SOURCE, Catalogue, Endpoint, NodeClass, Package
from check_launch.expansion.expander import Expansion, FileUse, StartedNode, StartedRemapping, joined
from check_launch.expansion.parameter_files import UNKNOWN, GivenValue, Section
from check_launch.misspellings import all_nearest, did_you_mean, misspelt, nearest
from check_launch.rules.known_parameters import ParameterView
from check_launch.rules.launch_rules import (
    MisspeltPackage,
    OldName,
    UnknownExecutable,
    UnknownPackage,
    UnknownPlugin,
    as_hint,
    as_warning,
)
from check_launch.rules.rviz_files import read_rviz_file
from check_launch.rules.stated_facts import stated_facts
from roverlink.generator.diagnostics import Diagnostic, Span

_WITHOUT_NODES = frozenset({"rclcpp_components"})
_CONTAINERS = ("component_container", "component_container_mt", "component_container_isolated")
_SYSTEM_DEFAULT = "0"
_QOS_VALUES = {"1": "reliable", "2": "best_effort"}
"""Values of RTAB-Map's parameters such as `qos_image` (rmw_qos_reliability_policy_t)."""
_QOS_DEFAULTS = {"$(qos_camera_info)": "$(qos_image)"} | {
    f"$(qos_{name})": "$(qos)" for name in ("odom", "image", "scan", "user_data", "sensor_data")
}
"""Parameters of RTAB-Map whose values are the defaults of others (rtabmap_sync/src/CommonDataSubscriber.cpp)."""
_QOS_PROFILES = {"SENSOR_DATA": "best_effort"}
"""Names of QoS profiles of the RealSense driver that are not reliable."""
MAP_UPDATES = "map_msgs/msg/OccupancyGridUpdate"
"""Type of the messages with which a publisher changes a part of a map."""


@dataclass(frozen=True, slots=True)
class Connection:
    """A topic, service or action of a running node, with its full name."""

    node: RunningNode
    endpoint: Endpoint
    topic: str | None
    """Full name after remappings; None if it is known at run time only."""
    place: Span
    """Place that decides the name: that of the remapping, the parameter, or the node."""
    is_named: bool
    """True if a launch file or parameter file names the topic."""
    reliability: str
    durability: str
    is_needed: bool


@dataclass(eq=False, slots=True)
class RunningNode:
    """A node that runs, or one that another node creates in its process."""

    started: StartedNode
    facts: NodeClass | None
    """None if the node is not in the catalogue."""
    name: str
    namespace: str
    is_inner: bool = False
    """True for a node that another node creates."""
    is_certain: bool = False
    """True if the catalogue describes the node, all its parameters are here, and no argument is varied to start it."""
    has_known_name: bool = True
    """False if the node's program gives a name that is not known, or if it is known at run time only."""
    view: ParameterView | None = None
    connections: list[Connection] = field(default_factory=list)
    connections_before: list[str] = field(default_factory=list)
    """Full names of all topics, services and actions that the node may have, before remappings."""
    transforms: list[tuple[str, str]] = field(default_factory=list)
    frames: list[tuple[str, Span]] = field(default_factory=list)
    tree: str = "/tf"
    """Topic of the node's transforms after remappings: robots with different topics have different trees."""
    sections: list[tuple[FileUse, Section]] = field(default_factory=list)
    """Sections of parameter files that are for the node."""

    @property
    def full_name(self) -> str:
        """The node's name with its namespace."""
        return f"{self.namespace}/{self.name}"

    @property
    def is_static_transform(self) -> bool:
        """True for a program that publishes one transform, which its arguments give."""
        return (self.started.package, self.started.executable) == ("tf2_ros", "static_transform_publisher")


@dataclass(slots=True)
class System:
    """All nodes of a launch file."""

    nodes: list[RunningNode] = field(default_factory=list)
    findings: list[Diagnostic] = field(default_factory=list)
    has_unknown: bool = False
    """True if nodes run that the catalogue does not know, or that were not expanded."""


def of_nodes(finding: Diagnostic, *nodes: RunningNode) -> Diagnostic:
    """Return an error about what nodes do together, or a warning if something about one of them is not certain.

    `launch`, a parser or a node refuses what one file says. That data does not flow follows from facts about each node,
    and those that are read from the sources of a workspace, or that hold with a varied argument only, may be wrong.
    """
    return finding if all(node.is_certain for node in nodes) else as_warning(finding)


Use = tuple[str, Span]
"""A name, such as that of a parameter, and the place where a file uses it."""


@dataclass(frozen=True, slots=True)
class Variants:
    """Facts that hold with some values of a launch file's arguments, and not only with those of one system."""

    parameters: frozenset[Use]
    """Given parameters that a node has."""
    remappings: frozenset[Use]
    """Remappings that have an effect."""
    ends: frozenset[tuple[str, str]]
    """Kind and topic of each publisher and subscriber."""


def system_of(expansion: Expansion, catalogue: Catalogue, is_varied: bool = False) -> System:
    """Return the nodes that an expanded launch file starts, and findings about packages and executables.

    ``is_varied`` says that one argument has another value than its default, which nobody has asked for.
    """
    system = System(has_unknown=bool(expansion.skipped) or expansion.runs_programs)
    for started in expansion.nodes:
        facts = _facts(started, catalogue, system, expansion.dependencies)
        usual = _usual_name(started, facts)
        name = started.name or usual or (started.executable or started.plugin or "node").rpartition("::")[2]
        namespace = started.namespace if started.namespace is not None else ""
        is_known = started.namespace is not None and bool(started.name or (started.name == "" and usual))
        source = catalogue.packages[started.package or ""].source if facts else WORKSPACE_SOURCE
        is_certain = source != WORKSPACE_SOURCE and not (is_varied or started.has_unknown_files)
        node = RunningNode(started, facts, name, _absolute(namespace), False, is_certain, is_known)
        system.nodes.append(node)
        for inner in facts.nodes if facts else ():
            inner_facts = catalogue.classes.get(inner.class_name)
            if not inner.type_parameter:
                inner_namespace = joined(node.namespace, inner.namespace)
                system.nodes.append(
                    RunningNode(started, inner_facts, inner.name, inner_namespace, True, is_certain, is_known)
                )
    for node in system.nodes:  # grows: a node may load others
        node.sections = [
            (use, section) for use in node.started.files for section in use.sections if section.matches(node.full_name)
        ]
        if node.facts is not None:
            _complete(node, node.facts, catalogue)
            system.nodes += _loaded_nodes(node, catalogue, system)
    for node in system.nodes:
        node.transforms = list(_with_frames_of_topics(node, system))
        if node.facts is not None and node.facts.has_open_topics:
            _complete_rviz(node, catalogue, system)
    return system


def _loaded_nodes(node: RunningNode, catalogue: Catalogue, system: System) -> Iterator[RunningNode]:
    """Yield the nodes that a node creates for plugins that its parameters name, such as a controller manager."""
    # A spawner can give another name or namespace to a controller (controller_manager/spawner.py of Jazzy).
    spawners = [other.started.arguments for other in system.nodes if other.started.executable == "spawner"]
    renamed = {word for words in spawners if "--controller-ros-args" in words for word in words}
    for inner in node.facts.nodes if node.facts else ():
        if not inner.type_parameter or node.view is None:
            continue
        pattern = re.compile(re.escape(inner.type_parameter).replace(r"\{\*\}", r"([^.]+)"))
        for name, given in node.view.given.items():
            if match := pattern.fullmatch(name):
                plugin = catalogue.plugins.get(str(given.value))
                if plugin is None and (near := misspelt(str(given.value), catalogue.plugins)):
                    message = f"unknown plugin '{given.value}' for '{name}'"
                    system.findings.append(UnknownPlugin.at(given.place, message, did_you_mean(near)))
                facts = catalogue.classes.get(plugin.class_name) if plugin else None
                is_known = match[1] not in renamed
                yield RunningNode(node.started, facts, match[1], node.namespace, True, node.is_certain, is_known)


def _complete_rviz(node: RunningNode, catalogue: Catalogue, system: System) -> None:
    """Find the topics and frames of RViz in its configuration, and displays that do not exist."""
    words = node.started.arguments
    paths = [file for option, file in pairwise(words) if option in ("-d", "--display-config")]
    read = read_rviz_file(paths[0], node.started.shown(paths[0])) if paths and paths[0] else None
    is_open = bool(paths) if read is None else any(plugin not in catalogue.plugins for plugin, _ in read.plugins)
    if node.view and is_open:
        node.view.open.append("")  # a display that is not known, such as that of MoveIt, may read any parameter
    if read is None:
        return
    for plugin, place in read.plugins:
        if plugin not in catalogue.plugins and (near := all_nearest(plugin, catalogue.plugins, 0.85)):
            inner = plugin.partition("/")[2]
            same = [name for name in catalogue.plugins if name.endswith(f"/{inner}")]  # of another package
            longer = [name for name in catalogue.plugins if name.startswith(plugin) or plugin.startswith(name)]
            message = f"RViz has no display or tool '{plugin}'"
            finding = UnknownPlugin.at(place, message, did_you_mean(same or longer or near))
            system.findings.append(as_warning(finding))  # RViz starts in spite of it
    for rviz_topic in read.topics:
        known = catalogue.plugins.get(rviz_topic.plugin)
        type_ = known.message_types[0] if known and len(known.message_types) == 1 else ""
        type_ = MAP_UPDATES if rviz_topic.is_update else type_
        type_ = type_ if rviz_topic.is_enabled else ""  # a display that is off subscribes to nothing, of no type
        kind = "publisher" if rviz_topic.is_published else "subscription"
        endpoint = Endpoint(kind, rviz_topic.topic, type_, rviz_topic.reliability, rviz_topic.durability)
        topic = full_name(rviz_topic.topic, node)
        rule = next((rule for rule in node.started.remappings if topic in sources_of(rule, node)), None)
        topic = full_name(rule.target, node) if rule and rule.target else topic
        node.connections.append(
            Connection(
                node, endpoint, topic, rviz_topic.place, True, rviz_topic.reliability, rviz_topic.durability, False
            )
        )
    if read.fixed_frame:
        node.frames.append(read.fixed_frame)


def _with_frames_of_topics(node: RunningNode, system: System) -> Iterator[tuple[str, str]]:
    """Yield a node's transforms, with frames in place of topics: ``@odom`` is the frame of the messages on odom.

    That frame is the parent in the transforms of the node that publishes the topic.
    """
    for parent, child in node.transforms:
        if not child.startswith("@"):
            yield parent, child
            continue
        topics = {end.topic for end in node.connections if end.endpoint.name == child[1:]}
        publishers = (
            other
            for other in system.nodes
            if any(end.topic in topics and end.endpoint.kind == "publisher" for end in other.connections)
        )
        frames = [transform[0] for other in publishers for transform in other.transforms if transform[0][0] != "@"]
        yield from ((parent, frame) for frame in frames[:1])


def _absolute(namespace: str) -> str:
    return f"/{namespace.strip('/')}" if namespace.strip("/") else ""


def _usual_name(started: StartedNode, facts: NodeClass | None) -> str:
    """Return the name of a node to which a launch file gives none; empty if it is not known."""
    stated = stated_facts().usual_names.get(f"{started.package}/{started.executable}", "")
    return stated or (facts.default_name if facts is not None else "")


def _facts(started: StartedNode, catalogue: Catalogue, system: System, dependencies: Set[str]) -> NodeClass | None:
    """Return the facts about a started node; report unknown packages and executables.

    ``dependencies`` are packages that manifests name, so that they exist.
    """
    package, executable = started.package, started.executable
    if package is None or (executable is None and not started.plugin):
        system.has_unknown = True
        return None
    known = catalogue.packages.get(package)
    at = started.place
    if known is None:
        if package in _WITHOUT_NODES and executable in _CONTAINERS:
            return None
        system.has_unknown = True
        if package not in dependencies and (near := misspelt(package, {*catalogue.packages, *dependencies})):
            system.findings.append(MisspeltPackage.at(at, f"unknown package '{package}'", did_you_mean(near)))
        else:
            system.findings.append(
                UnknownPackage.at(at, f"the package '{package}' is not in the catalogue; its nodes are not checked")
            )
        return None
    if known.is_partial and not (started.plugin or executable in known.executables):
        system.has_unknown = True
        if (executable or "").removesuffix(".py") in known.executables:
            system.findings.append(_unknown_executable(executable or "", known, at))
        return None
    if started.plugin:
        return _component(started.plugin, known, catalogue, system, at)
    if not executable:
        system.findings.append(UnknownExecutable.at(at, "the launch file names no executable for this node"))
        system.has_unknown = True
        return None
    if executable not in known.executables:
        finding = _unknown_executable(executable, known, at)
        system.findings.append(as_hint(finding) if executable in known.build_words else finding)
        system.has_unknown = True
        return None
    facts = catalogue.classes.get(known.executables[executable])
    words = [(word or "").partition("=")[0] for word in started.arguments]
    if facts is not None and any(facts.arguments.get(word) == "" for word in words):
        facts = None  # another node
    system.has_unknown |= facts is None or facts.is_partial
    return facts


def _unknown_executable(executable: str, package: Package, at: Span) -> Diagnostic:
    names, bare = ", ".join(package.executables) or "none", executable.removesuffix(".py")
    is_old = bare in package.executables and package.source != WORKSPACE_SOURCE  # as spawner.py before Humble
    near = bare if bare in package.executables else nearest(executable, package.executables)
    help = did_you_mean(near, f"executables of {package.name}: {names}")
    finding = UnknownExecutable.at(at, f"the package '{package.name}' has no executable '{executable}'", help)
    return OldName.of(finding) if is_old else finding


def _component(plugin: str, package: Package, catalogue: Catalogue, system: System, at: Span) -> NodeClass | None:
    if plugin in package.components or package.is_partial:
        facts = catalogue.classes.get(package.components.get(plugin, plugin))
        system.has_unknown |= facts is None or facts.is_partial
        return facts
    names = ", ".join(package.components) or "none"
    help = did_you_mean(nearest(plugin, package.components), f"nodes of {package.name} for containers: {names}")
    system.findings.append(
        UnknownExecutable.at(at, f"the package '{package.name}' has no node '{plugin}' for a container", help)
    )
    system.has_unknown = True
    return None


def _complete(node: RunningNode, facts: NodeClass, catalogue: Catalogue) -> None:
    """Find the parameters, topics and transforms of a node."""
    started = node.started
    given: dict[str, GivenValue] = {value.name: value for value in started.general_values}
    for _, section in node.sections:
        given |= {value.name: value for value in section.values}
    if not node.is_inner:
        given |= {value.name: value for value in started.values}
    given |= {value.name: value for value in _of_arguments(started, facts.arguments)}
    view = node.view = ParameterView(facts, given, catalogue, started.has_unknown_files)
    for prefix, endpoint in view.endpoints:
        node.connections += _connections(node, view, prefix, endpoint, started.remappings)
    of_tree = next((rule for rule in started.remappings if rule.target and "/tf" in sources_of(rule, node)), None)
    # A node in another node's process listens to transforms with the namespace of the process.
    process = RunningNode(started, None, "", _absolute(started.namespace or ""))
    node.tree = full_name(of_tree.target or "", process) if of_tree else "/tf"
    for transform in facts.transforms:
        parent, child = view.text(transform.parent, ""), view.text(transform.child, "")
        if parent and child and view.holds(transform.when, "") is not False:
            node.transforms.append((parent.strip("/"), child.strip("/")))
    for frame in facts.frames:
        text, named = view.text(frame, ""), view.is_given(frame, "")
        if text:
            node.frames.append((text.strip("/"), named.place if named else started.place))


def _of_arguments(started: StartedNode, arguments: Mapping[str, str]) -> Iterator[GivenValue]:
    """Yield parameters that a node takes from its command line, such as the frames of a static transform."""
    if not arguments:
        return
    words = started.arguments
    for option, value in pairwise(words):
        if option in arguments and option is not None:
            yield GivenValue(arguments[option], UNKNOWN if value is None else value, started.place)
    for word in words:
        for option, name in arguments.items():
            if option.endswith(":") and word and word.startswith(option):
                yield GivenValue(name, word.removeprefix(option), started.place)
    plain = [word for word in words if word is None or not word.startswith("--")]
    if words and len(plain) == len(words) and len(words) in (8, 9):  # the older spelling: x y z angles parent child
        for name, value in zip(arguments.values(), words[-2:], strict=False):
            yield GivenValue(name, UNKNOWN if value is None else value, started.place)


def _connections(
    node: RunningNode, view: ParameterView, prefix: str, endpoint: Endpoint, rules: Iterable[StartedRemapping]
) -> Iterator[Connection]:
    for spelled, when, needed in _spellings(view, prefix, endpoint):
        named = view.is_given(spelled, prefix)
        name = view.text(spelled, prefix)
        if name == "":
            continue
        place = named.place if named else node.started.place
        topic = name and full_name(name.replace("{node}", node.name), node)
        if topic:
            node.connections_before.append(topic)
        if view.holds(when, prefix, with_defaults=not view.is_partial) is False:
            continue
        rule = next(
            (rule for rule in rules if topic and rule.source is not None and topic in sources_of(rule, node)), None
        )
        if rule is not None:
            topic = full_name(rule.target, node) if rule.target is not None else None
            place = rule.target_place
        is_named = bool(named) or (rule is not None and not rule.is_general)
        yield Connection(
            node,
            endpoint,
            topic,
            place,
            is_named,
            _reliability(view, prefix, endpoint),
            _durability(view, prefix, endpoint),
            bool(needed) and view.holds(needed, prefix) is True,
        )


def _spellings(view: ParameterView, prefix: str, endpoint: Endpoint) -> Iterator[tuple[str, str, str]]:
    """Yield the name of a topic and its two conditions, for each name that ``{x}`` in them stands for."""
    joint = "\0".join((endpoint.name.replace("{node}", "\1"), endpoint.when, endpoint.needed))
    for spelling in view.spelled(joint, prefix):
        name, when, needed = spelling.split("\0")
        yield name.replace("\1", "{node}"), when, needed


def full_name(name: str, node: RunningNode) -> str:
    """Return the full name of a topic of a node."""
    if name.startswith("../"):  # in the namespace around the node's own, as the map of a costmap (costmap_2d_ros.cpp)
        inner = name.removeprefix("../")
        return inner if inner.startswith("/") else f"{node.namespace.rpartition('/')[0]}/{inner}"
    if name.startswith("~"):
        return f"{node.full_name}/{name[1:].lstrip('/')}"
    return name if name.startswith("/") else f"{node.namespace}/{name}"


def sources_of(rule: StartedRemapping, node: RunningNode) -> list[str]:
    """Return the full names that a remapping replaces in a node; none if it is for another node."""
    source = rule.source or ""
    name, colon, rest = source.partition(":")
    if colon and not source.startswith("/"):
        return [full_name(rest, node)] if name == node.name else []
    return [full_name(source, node)]


def _reliability(view: ParameterView, prefix: str, endpoint: Endpoint) -> str:
    named = endpoint.reliability
    while (text := view.text(named, prefix) if named else "") is None and named in _QOS_DEFAULTS:
        named = "" if view.is_given(named, prefix) else _QOS_DEFAULTS[named]
    if text is None:  # of qos_imu, whose default is that of qos in some nodes only
        is_default = not view.is_partial and not {prefix + "qos", prefix + named[2:-1]} & view.given.keys()
        if not is_default or not named.startswith("$(qos"):
            return ""
        text = _SYSTEM_DEFAULT
    if text == _SYSTEM_DEFAULT:  # a subscriber of Fast DDS is best effort then, one of other middlewares reliable
        return "reliable" if endpoint.kind == "publisher" else ""
    if endpoint.reliability.startswith("$("):
        return _QOS_VALUES.get(text) or _QOS_PROFILES.get(text, "reliable")
    return text


def _durability(view: ParameterView, prefix: str, endpoint: Endpoint) -> str:
    if endpoint.durability.startswith("$("):
        text = view.text(endpoint.durability, prefix)
        return {"True": "transient_local", "False": "volatile"}.get(text or "", "")
    return endpoint.durability
