"""Words in names and comments that tell the sender of a message, and commands from reports."""

from __future__ import annotations

import re


def _listed(text: str) -> frozenset[str]:
    return frozenset(text.split())


COMMANDS = _listed(
    "action calibrate cmd cmds command commands config configuration control controls ctrl desired drive enable goal "
    "mode move request reset select selection set setpoint setpoints settings start stop target targets trigger"
)
"""Words for commands to a machine."""

REPORTS = _listed(
    "ack actual alarm battery data detected diag diagnostic diagnostics encoder encoders error errors event feedback "
    "heartbeat imu info information localization log measured measurement measurements odometry position positions "
    "pressure progress reading readings report response result results sensor state states status telemetry "
    "temperature voltage"
)
"""Words for reports from a machine."""

OPERATORS = _listed(
    "app base basestation client cockpit console dashboard gcs ground groundstation gui joystick laptop operator "
    "remote station ui"
)
"""Machines that a person operates: they send commands and receive reports."""

ROLES = frozenset({"board", "controller", "driver", "mcu", "module", "unit", *OPERATORS})
"""Words with which a machine's name often ends."""

ROS_MACHINES = _listed("autonomy computer jetson nuc pc pi robot ros ros2 rover")
"""Names of the machine that runs ROS 2."""

GENERIC_FOLDERS = _listed("common components lib messages msg msgs proto protobuf protobufs protos shared src")
"""Names of folders that do not belong to one machine."""

_WORD = re.compile(r"[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+|\d+")


def words(name: str) -> list[str]:
    """Split a name in CamelCase or with underscores into lower-case words.

    >>> words("SensorBoardPHInfo")
    ['sensor', 'board', 'ph', 'info']
    """
    return [word.lower() for word in _WORD.findall(name)]


def camel_prefix(name: str, count: int) -> str:
    """Return the first words of a CamelCase name, spelt as in the name."""
    return "".join(_WORD.findall(name)[:count])
