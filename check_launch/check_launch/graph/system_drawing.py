"""Drawing of a system of nodes: nodes and topics, grouped by packages, and the tree of frames.

Graphviz lays it out: its edges go around boxes. It is a program of its own, which only drawings need.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Collection, Iterable, Iterator, Mapping
from html import escape

from check_launch.rules.system import Connection, RunningNode, System
from roverlink.runtime.core.errors import SetupError

_NODE = 'shape=box style=filled fillcolor="#dbe9f6" color="#2f6ea5"'
_UNKNOWN = 'shape=box style="filled,dashed" fillcolor="#eeeeee" color="#777777"'
_TOPIC = 'shape=box style="filled,rounded" fillcolor="#ffffff" color="#888888" height=0.25 margin="0.08,0.02"'
_OPEN = _TOPIC.replace("#888888", "#c0392b") + ' fontcolor="#c0392b"'
_FRAME = 'shape=box style=filled fillcolor="#e6f4e1" color="#4b8b3b"'
_LEGEND = (
    ("#dbe9f6", "node"),
    ("#eeeeee", "node that is not known"),
    ("#ffffff", "topic with several ends; between two nodes, its name stands at the arrow"),
    ("#f6d5d1", "topic of which a needed end is missing"),
    ("#e6f4e1", "frame; at the arrow, the node that publishes the transform"),
)


def svg_of(system: System, title: str) -> str:
    """Return the drawing as an SVG image. Raises `SetupError` if Graphviz is not installed, or fails."""
    program = shutil.which("dot")
    if program is None:
        raise SetupError("drawings need Graphviz (apt-get install graphviz); a FILE.dot can be written without it")
    done = subprocess.run(  # noqa: S603  # the program of the PATH, with a text of our own
        [program, "-Tsvg"], input=dot_of(system, title), capture_output=True, text=True, check=False
    )
    if done.returncode:
        raise SetupError(f"Graphviz cannot draw this: {done.stderr.strip()}")
    return done.stdout


def dot_of(system: System, title: str) -> str:
    """Return the drawing in Graphviz's language DOT.

    Topics that only one end uses are left out, unless a node needs the other end (red). Transforms and parameters are
    no edges: the frames have a tree of their own.
    """
    topics = _topics(system)
    lines = [
        "digraph system {",
        "  graph [rankdir=TB ranksep=0.35 nodesep=0.06 fontname=Helvetica fontsize=11 labelloc=t "
        f"label={_legend(title)}]",
        '  node [fontname=Helvetica fontsize=11 height=0.3 margin="0.1,0.04"]',
        '  edge [fontname=Helvetica fontsize=10 color="#777777" arrowsize=0.6]',
        *_groups(system.nodes, {end.node.full_name for ends in topics.values() for end in ends}),
        *_edges(topics),
        *_frames(system),
        "}",
    ]
    return "\n".join(lines) + "\n"


def _legend(title: str) -> str:
    rows = "".join(
        f'<tr><td bgcolor="{color}" border="1" width="20"></td><td align="left">{text}</td></tr>'
        for color, text in _LEGEND
    )
    return (
        '<<table border="0" cellborder="0" cellspacing="2">'
        f'<tr><td colspan="2" align="left"><b>{escape(title)}</b></td></tr>{rows}</table>>'
    )


def _groups(nodes: Iterable[RunningNode], connected: Collection[str]) -> Iterator[str]:
    """Yield the nodes in clusters: those of one package, or of packages whose names begin with the same word.

    The nodes of a cluster that have no topics here share a box.
    """
    packages = {node.started.package or "" for node in nodes}
    words = [package.partition("_")[0] for package in packages]
    groups: dict[str, list[RunningNode]] = {}
    for node in nodes:
        package = node.started.package or ""
        word = package.partition("_")[0]
        groups.setdefault(word if words.count(word) > 1 else package, []).append(node)
    for index, (name, members) in enumerate(sorted(groups.items())):
        yield f'  subgraph cluster_{index} {{ label={_quoted(name)} labeljust=l style=rounded color="#bbbbbb"'
        for node in members:
            if node.full_name in connected:
                label = _quoted(node.full_name.removeprefix("/"))
                yield f"    {_quoted(node.full_name)} [{_NODE if node.facts else _UNKNOWN} label={label}]"
        for is_known, style in ((True, _NODE), (False, _UNKNOWN)):
            alone = [one for one in members if one.full_name not in connected and (one.facts is not None) == is_known]
            label = _quoted(_lines(one.full_name.removeprefix("/") for one in alone))
            yield from (f"    {_quoted(f'alone {index} {is_known}')} [{style} label={label}]" for _ in alone[:1])
        yield "  }"


def _edges(topics: Mapping[str, list[Connection]]) -> Iterator[str]:
    """Yield arrows: from node to node for topics with two ends, otherwise to and from a box for the topic."""
    between: dict[tuple[str, str], list[str]] = {}
    for topic, connections in topics.items():
        ends = {
            kind: list(dict.fromkeys(one.node.full_name for one in connections if one.endpoint.kind == kind))
            for kind in ("publisher", "subscription")
        }
        if len(ends["publisher"]) == len(ends["subscription"]) == 1:
            between.setdefault((ends["publisher"][0], ends["subscription"][0]), []).append(topic.removeprefix("/"))
            continue
        box = _quoted(f"topic {topic}")
        is_whole = all(ends.values())
        yield f"  {box} [{_TOPIC if is_whole else _OPEN} fontsize=9 label={_quoted(topic.removeprefix('/'))}]"
        yield from (f"  {_quoted(node)} -> {box} [arrowhead=none]" for node in ends["publisher"])
        yield from (f"  {box} -> {_quoted(node)}" for node in ends["subscription"])
    for (first, second), names in sorted(between.items()):
        yield f"  {_quoted(first)} -> {_quoted(second)} [label={_quoted(_lines(names))}]"


def _frames(system: System) -> Iterator[str]:
    """Yield the tree of frames, with the nodes that publish the transforms.

    Frames below another one that only one node publishes, as those of a camera, share a box.
    """
    publishers: dict[tuple[str, str], set[str]] = {}
    for node in system.nodes:
        for pair in node.transforms:
            publishers.setdefault(pair, set()).add(node.name)
    children: dict[str, list[str]] = {}
    for parent, child in sorted(publishers):
        children.setdefault(parent, []).append(child)
    folded: set[str] = set()
    for parent in sorted(children, key=lambda frame: (-len(_below(frame, children)), frame)):
        below = _below(parent, children)
        of = set().union(*(publishers[pair] for pair in publishers if pair[1] in below))
        if parent not in folded and len(below) > 2 and len(of) == 1:
            folded |= below
            yield f"  {_quoted(f'below {parent}')} [{_FRAME} label={_quoted(f'{len(below)} frames')}]"
            arrow = f"{_quoted(f'frame {parent}')} -> {_quoted(f'below {parent}')}"
            yield f"  {arrow} [label={_quoted(of.pop())}]"
    for frame in sorted({frame for pair in publishers for frame in pair} - folded):
        yield f"  {_quoted(f'frame {frame}')} [{_FRAME} label={_quoted(frame)}]"
    for (parent, child), names in sorted(publishers.items()):
        if child not in folded:
            label = _quoted(_lines(sorted(names)))
            yield f"  {_quoted(f'frame {parent}')} -> {_quoted(f'frame {child}')} [label={label}]"


def _below(frame: str, children: Mapping[str, list[str]]) -> set[str]:
    """Return all frames below a frame; a cycle ends where it began."""
    found: set[str] = set()
    waiting = [frame]
    while waiting:
        new = set(children.get(waiting.pop(), ())) - found
        found |= new
        waiting += new
    return found


def _topics(system: System) -> Mapping[str, list[Connection]]:
    """Return the topics to draw, with their ends."""
    found: dict[str, list[Connection]] = {}
    for node in system.nodes:
        for end in node.connections:
            if end.topic and end.endpoint.kind in ("publisher", "subscription") and not _is_of_all(end.topic):
                found.setdefault(end.topic, []).append(end)
    return {
        topic: ends
        for topic, ends in sorted(found.items())
        if len({end.endpoint.kind for end in ends}) == 2 or any(end.is_needed for end in ends)
    }


def _is_of_all(topic: str) -> bool:
    return topic.rpartition("/")[2] in ("tf", "tf_static", "clock", "rosout", "parameter_events", "diagnostics")


def _lines(names: Iterable[str]) -> str:
    return "\n".join(names)


def _quoted(text: str) -> str:
    """Return a text in the quotation marks of DOT."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'
