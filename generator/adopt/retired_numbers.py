"""Field numbers that the envelope used in git's history and does not use now. The draft lists them as retired."""

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
    """Result of reading the envelope's field numbers from git's history."""

    retired: list[DraftRetired]
    commits: int
    """Number of commits that were read; 0 if there is no repository."""
    reused: list[int]
    """Numbers of today's envelope that had another meaning before, such as another payload."""


def read_past(root: Path, tree: Tree, rows: list[DraftRow], report: Callable[[int, int], None] | None) -> AdoptedPast:
    """Read the field numbers that the envelope had in git's history.

    The result is empty if ``root`` is not in a git repository. ``report`` shows progress: it is called with the number
    of file versions that were read so far, and their total.
    """
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
        # A number that another branch uses today is not retired; `roverlink number next` takes it into account.
        if number not in today and not any(usage.live_at for usage in of_number):
            retired.append(_retired(number, of_number, taken))
    reused = {reuse.number for reuse in history.reuses(tree.envelope.full_name) if reuse.certain}
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
