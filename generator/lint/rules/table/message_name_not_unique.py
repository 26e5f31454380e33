"""Two .proto files declare messages of one name.

The name of a message is what the table, the topics and the ROS 2 messages go by; where there is no proto package, it is
the whole of it. Of two messages with one name, the wrong one is imported sooner or later; and two such files without a
package cannot be compiled together.

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
    """Messages that stand in no other and have the name of one in an earlier file; excluded files come last."""
    seen: dict[str, tuple[str, ProtoMessage]] = {}
    for files in (context.files, context.excluded_files):
        for path, file in sorted(files.items()):
            for message in file.outermost:
                first, earlier = seen.setdefault(message.name, (path, message))
                if first != path:
                    finding = RULE.at(
                        context.place(path, message.span.line, message.span.column),
                        f"the message {message.full_name} has the name of one in {first}",
                        "start each name with its component's, such as SensorBoard",
                        [(context.place(first, earlier.span.line, earlier.span.column), "first declared here")],
                        type=message.full_name,
                    )
                    excluded = path in context.excluded_files  # and takes part in no build
                    yield dataclasses.replace(finding, severity=Severity.WARNING) if excluded else finding
