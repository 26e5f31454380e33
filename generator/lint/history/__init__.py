"""The history of numbers in .proto files, from all commits of a repository.

A comparison of two states cannot find a number that one commit deleted, and that a later commit gave to another field.
So this package reads the state of the files at every commit: of all branches, and of both sides of every merge. It also
reads states that do not compile, because a board may run firmware from such a commit.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roverlink.generator.lint.history.usage_model import (
    Allocation,
    Collision,
    Content,
    Kind,
    Relation,
    Reuse,
    TracedType,
    Usage,
)
from roverlink.generator.lint.history.whereabouts import whereabouts

if TYPE_CHECKING:
    from roverlink.generator.lint.history.proto_history import History, read_history

__all__ = [
    "Allocation",
    "Collision",
    "Content",
    "History",
    "Kind",
    "Usage",
    "Relation",
    "Reuse",
    "TracedType",
    "read_history",
    "whereabouts",
]


def __getattr__(name: str) -> Any:
    """Import the reader of the history when it is first used: a lint without ``--history`` does not need it."""
    if name not in ("History", "read_history"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from roverlink.generator.lint.history import proto_history

    return getattr(proto_history, name)
