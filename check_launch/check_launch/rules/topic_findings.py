"""Findings about topics: remappings without effect, missing publishers and subscribers, types, and QoS."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from difflib import get_close_matches

from check_launch.expansion.expander import StartedRemapping
from check_launch.misspellings import did_you_mean, is_misspelling, is_near, nearest
from check_launch.rules.launch_rules import (
    DifferentTypes,
    IncompatibleQos,
    RemappingOfUnknownTopic,
    TopicFromOutside,
    TopicWithoutPublisher,
    TopicWithoutSubscriber,
    as_hint,
    as_warning,
)
from check_launch.rules.system import (
    MAP_UPDATES,
    Connection,
    RunningNode,
    System,
    Use,
    Variants,
    full_name,
    of_nodes,
    sources_of,
)
from roverlink.generator.diagnostics import Diagnostic

_OF_ALL = frozenset(
    {"/tf", "/tf_static", "/clock", "/rosout", "/parameter_events", "/diagnostics", "/robot_description"}
)
_OF_NODES = ("tf", "tf_static", "rosout", "clock", "parameter_events", "diagnostics", "robot_description")
_OF_TOOLS = frozenset({"clicked_point", "goal_pose", "initialpose"})
"""Topics that tools of RViz publish unless somebody has named others."""
_SIMILAR = 0.7


def used_remappings(system: System) -> set[Use]:
    """Return the remappings that have an effect in a node, or that may have one in a node that is not known."""
    found = set()
    for nodes in _processes(system):
        is_known = not any(_may_have_more(node) for node in nodes)
        for rule in nodes[0].started.remappings:
            matches = any(_names(node, source) for node in nodes for source in sources_of(rule, node))
            if rule.source is not None and (matches or not is_known or _is_of_all(rule, nodes)):
                found.add((rule.source, rule.place))
    return found


def _may_have_more(node: RunningNode) -> bool:
    """Return true if a node may have topics that are not known, also those of nodes that it loads into its process."""
    facts = node.facts
    if any(end.topic is None and end.endpoint.name.startswith("$(") for end in node.connections):
        return True  # the name of a topic is not known
    return facts is None or facts.has_open_topics or facts.is_partial or any(one.type_parameter for one in facts.nodes)


def ends_of(system: System) -> set[tuple[str, str]]:
    """Return kind and topic of each publisher and subscriber."""
    return {(end.endpoint.kind, end.topic) for node in system.nodes for end in node.connections if end.topic}


def topic_findings(
    system: System, variants: Variants, known: Iterable[tuple[str, str]], complete: bool
) -> Iterator[Diagnostic]:
    """Yield findings about all topics.

    ``known`` are kinds and names of topics of this project's programs, which may run beside the launch files.
    ``complete`` says that the launch files start everything.
    """
    yield from _of_remappings(system, variants.remappings)
    topics = _topics(system)
    is_closed = complete and not system.has_unknown
    for connections in topics.values():
        yield from _of_types(connections)
        yield from _of_qos(connections)
    for topic, connections in topics.items():
        for end, kind in _wanting(topic, connections, variants):
            if finding := _missing(topic, end, kind, topics, known, system, is_closed):
                yield finding


def _topics(system: System) -> dict[str, list[Connection]]:
    """Return the publishers and subscribers of each topic."""
    found: dict[str, list[Connection]] = {}
    for node in system.nodes:
        for end in node.connections:
            if end.endpoint.kind in ("publisher", "subscription") and end.topic and not _is_general(end.topic, node):
                found.setdefault(end.topic, []).append(end)
    return dict(sorted(found.items()))


def _is_general(topic: str, node: RunningNode) -> bool:
    return topic in _OF_ALL or topic in {f"{node.namespace}/{name}" for name in _OF_NODES}


def _ends(connections: Iterable[Connection], kind: str) -> list[Connection]:
    return [end for end in connections if end.endpoint.kind == kind]


def _of_types(connections: list[Connection]) -> Iterator[Diagnostic]:
    publishers = [end for end in _ends(connections, "publisher") if end.endpoint.type]
    subscribers = _ends(connections, "subscription")
    for subscriber in subscribers:
        accepted = {other.endpoint.type for other in subscribers if other.node is subscriber.node}
        if accepted & {"", *(other.endpoint.type for other in publishers)}:
            continue  # a node may accept several types
        wrong = [
            other
            for other in publishers
            if subscriber.endpoint.type and other.endpoint.type != subscriber.endpoint.type
        ]
        if wrong and len(wrong) == len(publishers):
            other = wrong[0]
            finding = DifferentTypes.at(
                subscriber.place,
                f"{subscriber.node.name} subscribes to '{subscriber.topic}' as {subscriber.endpoint.type}, but "
                f"{other.node.name} publishes {other.endpoint.type}",
                also=[(other.place, f"{other.node.name} publishes it")],
            )
            yield of_nodes(finding, subscriber.node, other.node)


def _of_qos(connections: list[Connection]) -> Iterator[Diagnostic]:
    for end in _ends(connections, "subscription"):
        for other in _ends(connections, "publisher"):
            if other.endpoint.type != end.endpoint.type:
                continue
            wanted = _unmet(end, other)
            if wanted:
                finding = IncompatibleQos.at(
                    end.place,
                    f"{end.node.name} gets nothing from {other.node.name} on '{end.topic}': {wanted}",
                    also=[(other.place, f"{other.node.name} publishes it")],
                )
                yield of_nodes(finding, end.node, other.node)


def _unmet(subscriber: Connection, publisher: Connection) -> str:
    """Return what a subscriber asks for, and the publisher does not offer; empty if they fit."""
    if subscriber.reliability == "reliable" and publisher.reliability == "best_effort":
        return "the subscriber is reliable, the publisher best effort"
    if subscriber.durability == "transient_local" and publisher.durability == "volatile":
        return "the subscriber is transient local, the publisher volatile"
    return ""


def _wanting(topic: str, connections: list[Connection], variants: Variants) -> Iterator[tuple[Connection, str]]:
    """Yield the ends of a topic that miss another end, each with the kind of that end.

    An end that works without another one misses it if somebody has named the topic, and if nothing is at the other end
    with any values of the launch file's arguments.
    """
    for own, kind in (("subscription", "publisher"), ("publisher", "subscription")):
        if _ends(connections, kind):
            continue
        for end in _ends(connections, own):
            is_named = end.is_named and (kind, topic) not in variants.ends
            if (end.is_needed or is_named) and not (end.is_named and _is_disconnected(topic, end.node)):
                yield end, kind


def _missing(
    topic: str,
    connection: Connection,
    kind: str,
    topics: dict[str, list[Connection]],
    known: Iterable[tuple[str, str]],
    system: System,
    is_closed: bool,
) -> Diagnostic | None:
    is_reader = kind == "publisher"
    rule = TopicWithoutPublisher if is_reader else TopicWithoutSubscriber
    verb, nobody = ("subscribes to", "nothing publishes it") if is_reader else ("publishes", "nothing subscribes to it")
    message = f"{connection.node.name} {verb} '{topic}', but {nobody}"
    interruption = _interruption(_behind(connection.node, system)) if is_reader and connection.is_needed else ""
    fitting = {
        name: ends[0]
        for name, connections in topics.items()
        if (ends := [end for end in _ends(connections, kind) if _fits(end, connection)])
    }
    # A name that is used at both ends already is no misspelling of this one, unless somebody has written this one.
    candidates = [name for name in fitting if connection.is_named or not _has_both(topics[name])]
    similar = get_close_matches(topic, candidates, 3, _SIMILAR)
    near = [name for name in similar if _is_misspelling(topic, name, connection.is_named or fitting[name].is_named)]
    if (
        not is_reader
        and not connection.is_needed
        and not is_closed
        and not any(_has_both(topics[name]) for name in near)
    ):
        return None  # nobody needs to hear it, or the subscriber that does is reported
    if near:
        end = fitting[near[0]]
        also = [(end.place, f"{end.node.name} has '{near[0]}'")]
        finding = rule.at(connection.place, message + interruption, did_you_mean(near[0]), also)
        return of_nodes(finding, connection.node) if is_closed else as_warning(finding)
    full = {full_name(name, connection.node) for of_kind, name in known if of_kind == kind}
    if is_closed and (connection.is_needed or not _may_be_missing(topic, connection, full)):
        help = f"topics of this type: {', '.join(sorted(fitting))}" if fitting else ""
        return of_nodes(rule.at(connection.place, message + interruption, help), connection.node)
    of_programs = [
        name for name in full if connection.is_named and topic not in full and _is_misspelling(topic, name, True)
    ]
    if of_programs:
        return as_warning(rule.at(connection.place, message, did_you_mean(min(of_programs))))
    return TopicFromOutside.at(connection.place, f"{message} in these launch files")


def _may_be_missing(topic: str, connection: Connection, of_programs: set[str]) -> bool:
    """Return true for a topic of RViz that is there at times only.

    A map may have no updates, a program of this project may be started later, and not every tool is used.
    """
    is_of_rviz = connection.node.facts is not None and connection.node.facts.has_open_topics
    is_of_tool = connection.endpoint.kind == "publisher" and topic.rpartition("/")[2] in _OF_TOOLS
    return is_of_rviz and (connection.endpoint.type == MAP_UPDATES or topic in of_programs or is_of_tool)


def _fits(end: Connection, other: Connection) -> bool:
    """Return true if two ends have the same type of messages, or may have it."""
    return not end.endpoint.type or not other.endpoint.type or end.endpoint.type == other.endpoint.type


def _is_disconnected(topic: str, node: RunningNode) -> bool:
    """Return true for a topic below the node's own name: a launch file gives it to a node so that nothing arrives."""
    return topic.startswith(f"{node.full_name}/")


def _has_both(connections: list[Connection]) -> bool:
    return bool(_ends(connections, "publisher")) and bool(_ends(connections, "subscription"))


def _is_misspelling(topic: str, other: str, is_named: bool) -> bool:
    """Return true if a topic is likely another one, spelled wrongly.

    All parts but one are the same, and the last one differs by one or two letters. Topics with other numbers, such as
    odom0 and odom1, or image and image_2, are no misspellings of each other. ``is_named`` says that a launch file or a
    parameter file has one of the names.
    """
    if not is_named:
        return False
    first, second = topic.split("/"), other.split("/")
    if len(first) != len(second):
        return is_near(topic, other, 1)
    different = [(a, b) for a, b in zip(first, second, strict=True) if a != b]
    if len(different) != 1:
        return False
    a, b = different[0]
    return a.rstrip("_0123456789") != b.rstrip("_0123456789") and is_misspelling(a, b)


def _behind(node: RunningNode, system: System) -> list[str]:
    """Return the names of the nodes that get nothing, directly or by others, if a node gets nothing."""
    reached: dict[int, RunningNode] = {id(node): node}
    grown = True
    while grown:
        grown = False
        topics = {
            connection.topic
            for reached_node in reached.values()
            for connection in reached_node.connections
            if connection.endpoint.kind == "publisher" and connection.topic
        }
        for other in system.nodes:
            needed = (end for end in other.connections if end.endpoint.kind == "subscription" and end.is_needed)
            if id(other) not in reached and any(end.topic in topics for end in needed):
                reached[id(other)] = other
                grown = True
    return [other.name for other in reached.values() if other is not node]


def _interruption(names: list[str]) -> str:
    return f"; this interrupts the flow of data to {', '.join(names)}" if names else ""


def _processes(system: System) -> list[list[RunningNode]]:
    """Return the nodes of each process: a remapping is for all of them."""
    found: dict[int, list[RunningNode]] = {}
    for node in system.nodes:
        found.setdefault(id(node.started), []).append(node)
    return list(found.values())


def _of_remappings(system: System, used: frozenset[Use]) -> Iterator[Diagnostic]:
    """Yield findings about remappings without effect.

    A launch file may give one remapping to several nodes: it has an effect if one of them has the topic.
    """
    reported: set[Use] = set()
    for nodes in _processes(system):
        for rule in nodes[0].started.remappings:
            use = (rule.source or "", rule.place)
            if rule.source is None or use in used or use in reported or (rule.is_general and system.has_unknown):
                continue
            reported.add(use)
            if rule.is_general:
                yield RemappingOfUnknownTopic.at(rule.place, f"no node of this group has a topic '{rule.source}'")
            else:
                yield _without_effect(rule, nodes)


def _is_of_all(rule: StartedRemapping, nodes: list[RunningNode]) -> bool:
    return any(source in _OF_ALL or _is_general(source, node) for node in nodes for source in sources_of(rule, node))


def _names(node: RunningNode, source: str) -> bool:
    """Return true if a node has or may have a topic, service or action of this full name, or one that belongs to it."""
    if any(source == name or source.startswith(f"{name}/") for name in node.connections_before):
        return True
    patterns = (re.escape(full_name(name, node)) for name in (node.facts.topic_patterns if node.facts else ()))
    return any(re.fullmatch(pattern.replace(re.escape("{*}"), ".+"), source) for pattern in patterns)


def _without_effect(rule: StartedRemapping, nodes: list[RunningNode]) -> Diagnostic:
    source = rule.source or ""
    known = [name for node in nodes for name in node.connections_before]
    wanted = full_name(source, nodes[0])
    near = nearest(wanted, known)
    relative = near.removeprefix(f"{nodes[0].namespace}/")
    help = did_you_mean(near if source.startswith("/") or relative == source else relative)
    message = f"{nodes[0].name} has no topic, service or action '{source}'"
    finding = RemappingOfUnknownTopic.at(rule.place, message, help)
    texts = {text.strip("~/") for node in nodes if node.facts for text in node.facts.other_texts}
    return as_hint(finding) if source.strip("~/") in texts else finding
