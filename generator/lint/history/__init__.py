"""What .proto files said about numbers, in all of a repository's history.

Tools that compare two states do not see a number that was deleted in one commit and given to something else three
commits later. Here, all states are read: of all branches, and of both sides of every merge; also those that do not
compile, for the boards they were flashed to did not ask.
"""

from __future__ import annotations

from roverlink.generator.lint.history.branch_collisions import branch_name
from roverlink.generator.lint.history.proto_history import History, read_history
from roverlink.generator.lint.history.same_meaning import differ
from roverlink.generator.lint.history.usage_model import (
    Allocation,
    Confidence,
    Content,
    Kind,
    Relation,
    Reuse,
    Usage,
)

__all__ = [
    "Allocation",
    "Confidence",
    "Content",
    "History",
    "Kind",
    "Usage",
    "Relation",
    "Reuse",
    "branch_name",
    "differ",
    "read_history",
]
