"""Findings about frames: transforms that two nodes publish, and frames that nothing publishes."""

from __future__ import annotations

from collections.abc import Iterator, Set

from check_launch.misspellings import did_you_mean, misspelt
from check_launch.rules.launch_rules import (
    FrameFromOutside,
    FramePublishedTwice,
    FrameWithoutTransform,
    as_hint,
    as_warning,
)
from check_launch.rules.system import RunningNode, System, of_nodes
from roverlink.generator.diagnostics import Diagnostic


def frame_findings(system: System, complete: bool, is_varied: bool) -> Iterator[Diagnostic]:
    """Yield findings about all frames.

    ``complete`` says that the launch files start everything, ``is_varied`` that one argument does not have its default.
    """
    is_closed = complete and not system.has_unknown
    published = {end.topic for node in system.nodes for end in node.connections if end.endpoint.kind == "publisher"}
    for tree in sorted({node.tree for node in system.nodes}):
        nodes = [node for node in system.nodes if node.tree == tree]
        yield from _of_tree(nodes, published, is_closed, is_varied)


def _of_tree(
    nodes: list[RunningNode], published: Set[str | None], is_closed: bool, is_varied: bool
) -> Iterator[Diagnostic]:
    publishers: dict[str, list[tuple[str, RunningNode]]] = {}
    frames: set[str] = set()
    for node in nodes:
        for parent, child in node.transforms:
            publishers.setdefault(child, []).append((parent, node))
            frames |= {parent, child}
    for child, ends in sorted(publishers.items()):
        # An action in several handlers of events stands for one node.
        (parent, first), *others = {
            (node.started.place, node.full_name): (parent, node) for parent, node in ends
        }.values()
        for other_parent, other in others:
            if is_varied and other.full_name == first.full_name:
                continue  # alternatives of one name: whoever sets this argument sets that of the other one, too
            finding = FramePublishedTwice.at(
                other.started.place,
                f"{other.name} publishes the transform from '{other_parent}' to '{child}', and {first.name} "
                f"the one from '{parent}'",
                "let only one of them publish it, such as with the parameter publish_tf",
                also=[(first.started.place, f"{first.name} publishes it")],
            )
            # Without its data, such as scans, a node sends no transform, and somebody may have put a fixed one there.
            is_fixed = first.is_static_transform or other.is_static_transform
            has_data = _has_data(first, published) and _has_data(other, published)
            yield as_hint(finding) if is_fixed and not has_data else of_nodes(finding, first, other)
    roots = {frame: _root(frame, publishers) for frame in frames}
    for node in nodes:
        looked_up = [(frame, place) for frame, place in node.frames if frame]
        for frame, place in looked_up:
            if frame in frames:
                continue
            near = misspelt(frame, frames)
            message = f"{node.name} looks up the frame '{frame}', but nothing publishes it"
            if near or is_closed:
                finding = FrameWithoutTransform.at(place, message, did_you_mean(near))
                yield of_nodes(finding, node) if is_closed else as_warning(finding)
            else:
                yield FrameFromOutside.at(place, f"{message} in these launch files")
        known = [(frame, place) for frame, place in looked_up if frame in roots]
        if is_closed and len({roots[frame] for frame, _ in known}) > 1:
            names = " and ".join(f"'{frame}'" for frame, _ in known)
            message = f"{node.name} looks up {names}, but no transforms connect them"
            yield of_nodes(FrameWithoutTransform.at(known[0][1], message), node)


def _has_data(node: RunningNode, published: Set[str | None]) -> bool:
    """Return true if known nodes publish the topics that a node needs, apart from those that are sent once."""
    needed = (end for end in node.connections if end.is_needed and end.durability != "transient_local")
    return all(end.topic in published for end in needed)


def _root(frame: str, publishers: dict[str, list[tuple[str, RunningNode]]]) -> str:
    seen = {frame}
    while frame in publishers:
        frame = publishers[frame][0][0]
        if frame in seen:
            return frame  # the transforms form a ring
        seen.add(frame)
    return frame
