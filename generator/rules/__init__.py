"""The rules: pure functions from what is known to findings. One file a rule; none knows another.

Each module has `RULE` and `check`, and its docstring is the rule's documentation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from generator.findings import Finding
from generator.rules import (
    envelope_disagrees,
    field_number_out_of_range,
    field_number_reuse,
    field_number_taken,
    field_number_vanished,
    name_taken,
    peer_parameter_taken,
    ros_name_forbidden,
    topic_taken,
    unknown_peer,
)
from generator.subject import Subject

_CHECKS: tuple[Callable[[Subject], Iterator[Finding]], ...] = (
    envelope_disagrees.check,
    field_number_out_of_range.check,
    field_number_reuse.check,
    field_number_taken.check,
    field_number_vanished.check,
    name_taken.check,
    peer_parameter_taken.check,
    ros_name_forbidden.check,
    topic_taken.check,
    unknown_peer.check,
)


def lint(subject: Subject) -> list[Finding]:
    """What every rule finds."""
    return [finding for check in _CHECKS for finding in check(subject)]
