"""The history of numbers in .proto files, from all commits of a repository.

A comparison of two states cannot find a number that one commit deleted, and that a later commit gave to another field.
So this package reads the state of the files at every commit: of all branches, and of both sides of every merge. It also
reads states that do not compile, because a board may run firmware from such a commit.
"""

from __future__ import annotations

from roverlink.generator.lint.history.branch_collisions import branch_name
from roverlink.generator.lint.history.proto_history import History, read_history
from roverlink.generator.lint.history.usage_model import (
    Allocation,
    Collision,
    Confidence,
    Content,
    Kind,
    Relation,
    Reuse,
    TracedType,
    Usage,
)

__all__ = [
    "Allocation",
    "Collision",
    "Confidence",
    "Content",
    "History",
    "Kind",
    "Usage",
    "Relation",
    "Reuse",
    "TracedType",
    "branch_name",
    "read_history",
]
