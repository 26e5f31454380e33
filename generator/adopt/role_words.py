"""English words in names and comments that show who sends a message, and if it is a command or a report."""

from __future__ import annotations

import re


def _listed(text: str) -> frozenset[str]:
    return frozenset(text.split())


COMMANDS = _listed(
    "action calibrate cmd cmds command commands config configuration control controls ctrl desired drive enable goal "
    "mode move request reset select selection set setpoint setpoints settings start stop target targets trigger"
)
"""Words that occur in the names of commands, which a machine receives."""

REPORTS = _listed(
    "ack actual alarm battery data detected diag diagnostic diagnostics encoder encoders error errors event feedback "
    "heartbeat imu info information localization log measured measurement measurements odometry position positions "
    "pressure progress reading readings report response result results sensor state states status telemetry "
    "temperature voltage"
)
"""Words that occur in the names of reports, which a machine sends."""

OPERATORS = _listed(
    "app base basestation client cockpit console dashboard gcs ground groundstation gui joystick laptop operator "
    "remote station ui"
)
"""Words for machines that a person operates. Such machines send commands and receive reports."""

ROLES = frozenset({"board", "controller", "driver", "mcu", "module", "unit", *OPERATORS})
"""Words at the end of a machine's name, such as ``board`` in ``SensorBoard``."""

ROS_MACHINES = _listed("autonomy computer jetson nuc pc pi robot ros ros2 rover")
"""Words for the computer that runs ROS 2."""

GENERIC_FOLDERS = _listed("common components lib messages msg msgs proto protobuf protobufs protos shared src")
"""Names of folders that do not show to which machine the messages inside belong."""

_WORD = re.compile(r"[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+|\d+")


def words(name: str) -> list[str]:
    """Split a name in CamelCase or with underscores into lower-case words.

    >>> words("SensorBoardPHInfo")
    ['sensor', 'board', 'ph', 'info']
    """
    return [word.lower() for word in _WORD.findall(name)]


def camel_prefix(name: str, count: int) -> str:
    """Return the first ``count`` words of a CamelCase name, with the capitals of the name."""
    return "".join(_WORD.findall(name)[:count])
