"""What git's history says of the envelope's numbers: those that were used, and are free today, are retired."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from roverlink.generator.adopt.draft import DraftRetired, DraftRow
from roverlink.generator.adopt.proto_tree import Tree
from roverlink.generator.git import GitError
from roverlink.generator.ir.ros_names import distinct
from roverlink.generator.lint.history import Usage, read_history

_TYPE = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*")


@dataclass(frozen=True, slots=True)
class AdoptedPast:
    """What was found."""

    retired: list[DraftRetired]
    commits: int
    """How many were read; 0 where there is no repository."""
    reused: list[int]
    """Numbers of today that stood for something else before."""


def read_past(root: Path, tree: Tree, rows: list[DraftRow], report: Callable[[int, int], None] | None) -> AdoptedPast:
    """The past of a tree; none where it is in no repository."""
    try:
        history = read_history(root, report)
    except GitError:
        return AdoptedPast([], 0, [])
    usages = history.numbers(tree.envelope.full_name)
    today = {field.number for field in tree.envelope.fields}
    taken = {distinct(row.name): f"{row.number} is now" for row in rows}
    taken |= {distinct(tree.oneof): "the oneof is"}
    retired = []
    for number, of_number in sorted(usages.items()):
        # What another branch has today is not over; `roverlink next-number` knows it.
        if number not in today and not any(usage.live_at for usage in of_number):
            retired.append(_retired(number, of_number, taken))
    reused = {one.number for one in history.reuses(tree.envelope.full_name) if one.real}
    return AdoptedPast(retired, history.commits, sorted(reused & today))


def _retired(number: int, usages: tuple[Usage, ...], taken: dict[str, str]) -> DraftRetired:
    last = usages[-1]
    notes = [f"until {last.went}"] if last.went else []
    others = sorted({usage.type.lstrip(".") for usage in usages} - {last.type.lstrip(".")})
    notes += [f"before that it was {', '.join(others)}"] if others else []
    name = last.name
    if distinct(name) in taken:
        notes.append(f"it was called {name}, which {taken[distinct(name)]}")
        name = f"{name}_{number}"
    taken[distinct(name)] = f"{number} was"
    proto = last.type.lstrip(".")
    return DraftRetired(number, name, proto if _TYPE.fullmatch(proto) else "unknown", "; ".join(notes))
