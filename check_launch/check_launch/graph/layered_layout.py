"""Layout of a directed graph in columns, so that most edges lead to the right (Sugiyama's method, simplified).

Columns come from the longest path to a vertex, and the order in a column from the mean of the neighbours' places
(barycentre heuristic). The same graph always gets the same layout.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

_SWEEPS = 6


@dataclass(frozen=True, slots=True)
class Box:
    """Rectangle of a vertex, in pixels."""

    x: float
    y: float
    width: float
    height: float


def layered(
    sizes: Mapping[str, tuple[float, float]], edges: Iterable[tuple[str, str]], gap: tuple[float, float]
) -> dict[str, Box]:
    """Return the place of each vertex.

    ``sizes`` are width and height of each vertex; ``gap`` is the distance of columns, and of vertices in a column.
    """
    forward = _without_cycles(sizes, sorted(set(edges)))
    columns = _columns(sizes, forward)
    _order(columns, forward)
    return _places(columns, sizes, gap)


def _without_cycles(vertices: Iterable[str], edges: Sequence[tuple[str, str]]) -> list[tuple[str, str]]:
    """Return the edges without those that lead back to a vertex on the way (depth-first search)."""
    following: dict[str, list[str]] = {}
    for start, end in edges:
        following.setdefault(start, []).append(end)
    kept: list[tuple[str, str]] = []
    done: set[str] = set()

    def visit(vertex: str, way: frozenset[str]) -> None:
        done.add(vertex)
        for other in following.get(vertex, ()):
            if other in way:
                continue
            kept.append((vertex, other))
            if other not in done:
                visit(other, way | {other})

    targets = {end for _, end in edges}
    for vertex in sorted(vertices, key=lambda name: (name in targets, name)):  # sources first
        if vertex not in done:
            visit(vertex, frozenset({vertex}))
    return kept


def _columns(vertices: Iterable[str], edges: Sequence[tuple[str, str]]) -> list[list[str]]:
    depth = dict.fromkeys(vertices, 0)
    for _ in depth:  # as often as the longest path has edges, at most
        changed = False
        for start, end in edges:
            if depth[end] < depth[start] + 1 <= len(depth):
                depth[end] = depth[start] + 1
                changed = True
        if not changed:
            break
    columns: list[list[str]] = [[] for _ in range(max(depth.values(), default=0) + 1)]
    for vertex in sorted(depth):
        columns[depth[vertex]].append(vertex)
    return columns


def _order(columns: list[list[str]], edges: Sequence[tuple[str, str]]) -> None:
    neighbours: dict[str, list[str]] = {}
    for start, end in edges:
        neighbours.setdefault(start, []).append(end)
        neighbours.setdefault(end, []).append(start)
    for sweep in range(_SWEEPS):
        place = {vertex: index / max(len(column), 1) for column in columns for index, vertex in enumerate(column)}
        for column in columns if sweep % 2 == 0 else reversed(columns):
            means = {
                vertex: (
                    sum(place[neighbour] for neighbour in near) / len(near)
                    if (near := neighbours.get(vertex))
                    else place[vertex]
                )
                for vertex in column
            }
            column.sort(key=lambda vertex: (means[vertex], vertex))
            place |= {vertex: index / len(column) for index, vertex in enumerate(column)}


def _places(
    columns: Sequence[Sequence[str]], sizes: Mapping[str, tuple[float, float]], gap: tuple[float, float]
) -> dict[str, Box]:
    heights = [sum(sizes[vertex][1] + gap[1] for vertex in column) - gap[1] for column in columns]
    highest = max(heights, default=0.0)
    places: dict[str, Box] = {}
    x = 0.0
    for column, height in zip(columns, heights, strict=True):
        y = (highest - height) / 2
        for vertex in column:
            width, own_height = sizes[vertex]
            places[vertex] = Box(x, y, width, own_height)
            y += own_height + gap[1]
        x += max((sizes[vertex][0] for vertex in column), default=0.0) + gap[0]
    return places
