"""The words by which people say who a message is from, and whether it asks or tells."""

from __future__ import annotations

import re


def _listed(text: str) -> frozenset[str]:
    return frozenset(text.split())


COMMANDS = _listed(
    "action calibrate cmd cmds command commands config configuration control controls ctrl desired drive enable goal "
    "mode move request reset select selection set setpoint setpoints settings start stop target targets trigger"
)
"""What asks a machine to do something."""

REPORTS = _listed(
    "ack actual alarm battery data detected diag diagnostic diagnostics encoder encoders error errors event feedback "
    "heartbeat imu info information localization log measured measurement measurements odometry position positions "
    "pressure progress reading readings report response result results sensor state states status telemetry "
    "temperature voltage"
)
"""What tells of a machine, or of what it saw."""

OPERATORS = _listed(
    "app base basestation client cockpit console dashboard gcs ground groundstation gui joystick laptop operator "
    "remote station ui"
)
"""Machines with a person in front of them: they send commands, and are told the rest."""

ROLES = frozenset({"board", "controller", "driver", "mcu", "module", "unit", *OPERATORS})
"""What the last word of a machine's name often is."""

OURSELVES = _listed("autonomy computer jetson nuc pc pi robot ros ros2 rover")
"""The machine that runs ROS 2."""

GENERIC_FOLDERS = _listed("common components lib messages msg msgs proto protobuf protobufs protos shared src")
"""Folders that are no machine's."""

_WORD = re.compile(r"[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+|\d+")


def words(name: str) -> list[str]:
    """The words of a name in CamelCase or with underscores, in lower case.

    >>> words("SensorBoardPHInfo")
    ['sensor', 'board', 'ph', 'info']
    """
    return [word.lower() for word in _WORD.findall(name)]


def camel_prefix(name: str, count: int) -> str:
    """The first words of a name in CamelCase, as it spells them."""
    return "".join(_WORD.findall(name)[:count])
