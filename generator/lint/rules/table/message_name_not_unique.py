"""Two .proto files declare messages with the same name.

The table, the topics and the ROS 2 messages identify a message by its name. Sooner or later, a file imports the wrong
message. If the two files declare no package, they cannot be compiled together.

Bad::

    // components/arm_board/status.proto
    message Status {}
    // components/sensor_board/status.proto
    message Status {}

Good::

    // components/arm_board/status.proto
    message ArmBoardStatus {}
    // components/sensor_board/status.proto
    message SensorBoardStatus {}
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity
from roverlink.generator.lint.context import Context
from roverlink.generator.protos.schema import ProtoMessage

RULE = Rule("NAM101", "message-name-not-unique", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each top-level message whose name is also declared in another file."""
    seen: dict[str, tuple[str, ProtoMessage]] = {}
    for files in (context.files, context.excluded_files):
        for path, file in sorted(files.items()):
            for message in file.outermost:
                first, earlier = seen.setdefault(message.name, (path, message))
                if first != path:
                    finding = RULE.at(
                        context.place(path, message.span.line, message.span.column),
                        f"the message {message.full_name!r} has the same name as a message in {first}",
                        "start each name with the part of the rover to which it belongs, as in SensorBoardStatus",
                        [(context.place(first, earlier.span.line, earlier.span.column), "first declared here")],
                        type=message.full_name,
                    )
                    excluded = path in context.excluded_files  # never compiled, so it does no harm yet
                    yield dataclasses.replace(finding, severity=Severity.WARNING) if excluded else finding
