"""Drawing of a system of nodes as an SVG image: nodes and topics above, the tree of frames below."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

from check_launch.graph.layered_layout import Box, layered
from check_launch.rules.system import Connection, System

_LETTER = 7.2
"""Width of a letter in pixels, in the font of the drawing."""
_HEIGHT, _MARGIN = 26.0, 24.0
_STYLE = """
text { font: 12px "DejaVu Sans Mono", "Liberation Mono", monospace; dominant-baseline: central; text-anchor: middle }
.node rect { fill: #dbe9f6; stroke: #2f6ea5 } .unknown rect { fill: #eee; stroke: #999; stroke-dasharray: 4 3 }
.topic rect { fill: #fff; stroke: #888 } .open rect { stroke: #c0392b; stroke-width: 2 } .open text { fill: #c0392b }
.frame rect { fill: #e6f4e1; stroke: #4b8b3b }
path { fill: none; stroke: #777; marker-end: url(#arrow) }
.title { font-weight: bold; text-anchor: start }
"""


def graph_of(system: System, title: str) -> str:
    """Return an SVG image. Topics that only one end uses are left out, unless a node needs the other end (red)."""
    topics = _topics(system)
    labels: dict[str, tuple[str, str]] = {}
    edges: list[tuple[str, str]] = []
    for node in system.nodes:
        labels[node.full_name] = node.full_name.removeprefix("/"), "node" if node.facts else "unknown"
    for topic, ends in topics.items():
        kinds = {end.endpoint.kind for end in ends}
        labels[f"topic {topic}"] = topic, "topic" if len(kinds) == 2 else "topic open"
        for connection in ends:
            pair = (connection.node.full_name, f"topic {topic}")
            edges.append(pair if connection.endpoint.kind == "publisher" else (pair[1], pair[0]))
    frames = sorted({(parent, child) for node in system.nodes for parent, child in node.transforms})
    frame_labels = {f"frame {frame}": (frame, "frame") for pair in frames for frame in pair}
    above = layered(_sizes(labels), edges, (56.0, 10.0))
    below = layered(_sizes(frame_labels), [(f"frame {a}", f"frame {b}") for a, b in frames], (40.0, 8.0))
    height = max((box.y + box.height for box in above.values()), default=0.0)
    top, bottom = _MARGIN * 2.5, height + _MARGIN * 5.5
    placed = _shifted(above, top) | _shifted(below, bottom)
    width = max((box.x + box.width for box in placed.values()), default=0.0) + _MARGIN
    total = max((box.y + box.height for box in placed.values()), default=0.0) + _MARGIN
    edges += [(f"frame {a}", f"frame {b}") for a, b in frames]
    size, attributes = f"{width:.0f} {total:.0f}", f'width="{width:.0f}" height="{total:.0f}"'
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size}" {attributes}>',
        f"<title>{escape(title)}</title>",
        f"<style>{_STYLE}</style>",
        '<defs><marker id="arrow" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
        '<path d="M0 0L8 4L0 8z" style="fill:#777;stroke:none;marker-end:none"/></marker></defs>',
        f'<rect width="{width:.0f}" height="{total:.0f}" fill="#fff"/>',
        f'<text class="title" x="{_MARGIN}" y="{_MARGIN}">{escape(title)}</text>',
        *([f'<text class="title" x="{_MARGIN}" y="{bottom - _MARGIN:.0f}">frames</text>'] if frames else []),
        *(_edge(placed[start], placed[end]) for start, end in sorted(set(edges))),
        *(_box(placed[name], *label) for name, label in sorted({**labels, **frame_labels}.items())),
        "</svg>",
    ]
    return "\n".join(lines) + "\n"


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
    return topic.rpartition("/")[2] in ("tf", "tf_static", "clock", "rosout", "parameter_events")


def _sizes(labels: Mapping[str, tuple[str, str]]) -> dict[str, tuple[float, float]]:
    return {name: (len(text) * _LETTER + 18, _HEIGHT) for name, (text, _) in labels.items()}


def _shifted(boxes: Mapping[str, Box], y: float) -> dict[str, Box]:
    return {name: Box(box.x + _MARGIN, box.y + y, box.width, box.height) for name, box in boxes.items()}


def _box(box: Box, text: str, kind: str) -> str:
    radius = 13 if "topic" in kind else 4
    rectangle = (
        f'<rect x="{box.x:.1f}" y="{box.y:.1f}" width="{box.width:.1f}" height="{box.height:.1f}" rx="{radius}"/>'
    )
    x, y = box.x + box.width / 2, box.y + box.height / 2
    return f'<g class="{kind}">{rectangle}<text x="{x:.1f}" y="{y:.1f}">{escape(text)}</text></g>'


def _edge(start: Box, end: Box) -> str:
    """Return a curve from the right side of a box to the left side of another one."""
    x1, y1 = start.x + start.width, start.y + start.height / 2
    x2, y2 = end.x, end.y + end.height / 2
    bend = max(30.0, abs(x2 - x1) / 2)
    return f'<path d="M{x1:.1f} {y1:.1f}C{x1 + bend:.1f} {y1:.1f} {x2 - bend:.1f} {y2:.1f} {x2:.1f} {y2:.1f}"/>'
