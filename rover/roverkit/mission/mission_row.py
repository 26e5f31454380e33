"""Row of the table whose message reports the progress of a mission to the basestation."""

from __future__ import annotations

from collections.abc import Callable

from roverkit.mission.mission_declaration import PROGRESS
from roverkit.mission.mission_rules import Report, State
from roverlink.runtime import Registry
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.middleware import Middleware

_VALUE = "MISSION_{}"


def progress_publisher(
    middleware: Middleware, registry: Registry, topic: Callable[[str], str], goals: int
) -> Callable[[Report], None]:
    """Return a function that publishes the news of a mission with ``goals`` goals as messages of the row `PROGRESS`.

    ``topic`` returns the fully qualified name of a topic. The function does nothing if the table does not have the row.
    Raises `SetupError` if the row lacks a field, or a value for a state.
    """
    if PROGRESS.row not in registry.by_name:
        return lambda _: None
    row = PROGRESS.of(registry)
    message_type = row.message_type
    values = {state: getattr(message_type, _VALUE.format(state.name), None) for state in State}
    if missing := [_VALUE.format(state.name) for state, value in values.items() if value is None]:
        raise SetupError(
            f"{message_type.__msgtype__}, the message of row {PROGRESS.row!r}, has no value {', '.join(missing)}; "
            "add it"
        )
    publish = row.publisher(middleware, topic).publish

    def publish_progress(report: Report) -> None:
        state = values[report.state]
        publish([cdr.encode(message_type(state=state, goal=report.goal, goals=goals, distance=report.distance))])

    return publish_progress
