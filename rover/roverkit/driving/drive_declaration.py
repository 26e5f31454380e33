"""Declaration of the node of ``roverlink drive``."""

from __future__ import annotations

from dataclasses import fields

from roverkit.driving.board_commands import NUMBER, BoardCommand
from roverkit.driving.drive_control import DriveSettings
from roverlink.nodes import Direction, NodeDeclaration, Parameter, RowTopic, Topic
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.interfaces.geometry_msgs import Twist, TwistStamped
from roverlink.runtime.interfaces.nav_msgs import Odometry, Path
from roverlink.runtime.interfaces.std_msgs import String

VELOCITY = Topic(
    "cmd_vel",
    (Twist, TwistStamped),
    Direction.RECEIVED,
    "velocity of base_link: linear.x in m/s and angular.z in rad/s",
    qos=None,
)
PATH = Topic("path", (Path,), Direction.RECEIVED, "path to follow; an empty one ends the path before", Qos(depth=1))
POSE = Topic(
    "odometry/global",
    (Odometry,),
    Direction.RECEIVED,
    "pose of base_link in the frame of the path",
    Qos("best_effort", depth=1),  # best effort, so that it matches every publisher
)
MODE = RowTopic("control_mode", Direction.RECEIVED, "who drives", inbound=True, fields=("mode",))
COMMAND = RowTopic(
    "drive_motor",
    Direction.PUBLISHED,
    "command for the driving board",
    inbound=False,
    fields=tuple(field.name for field in fields(BoardCommand) if field.name != NUMBER),
)
STATE = Topic(
    "drive/state",
    (String,),
    Direction.PUBLISHED,
    "state and reason, such as `idle: no velocity for 0.5 s`; kept for late subscribers",
    Qos(depth=1, durability="transient_local"),
)

_DEFAULTS = DriveSettings()
NODE = NodeDeclaration(
    "drive",
    (VELOCITY, PATH, POSE, MODE, COMMAND, STATE),
    (
        Parameter("speed", float, "largest speed in m/s; also the speed on a path", _DEFAULTS.speed),
        Parameter("acceleration", float, "largest change of the speed in m/s²", _DEFAULTS.acceleration),
        Parameter(
            "smallest_radius",
            float,
            "smallest turning radius of the driving board in metres; tighter turns keep their side and get this radius",
            _DEFAULTS.board.smallest_radius,
        ),
        Parameter("reverse", bool, "true if the driving board drives backwards", _DEFAULTS.board.reverses),
        Parameter(
            "straight_radius",
            float,
            "turning_radius in metres that the driving board takes for a straight line",
            _DEFAULTS.board.straight_radius,
        ),
        Parameter(
            "rate",
            float,
            "commands a second; a velocity that differs from the last one sent is also sent at once",
            1 / _DEFAULTS.period,
        ),
        Parameter("horizon", float, "time in seconds for which a command is enough", _DEFAULTS.horizon),
        Parameter(
            "timeout", float, "time in seconds without a velocity after which the rover stops", _DEFAULTS.timeout
        ),
        Parameter(
            "mode_timeout",
            float,
            "time in seconds without control_mode after which the mode is manual; 0: never",
            _DEFAULTS.mode_timeout,
        ),
        Parameter(
            "pose_timeout",
            float,
            "age in seconds of the newest pose at which the rover is lost",
            _DEFAULTS.pose_timeout,
        ),
        Parameter(
            "pose_deviation",
            float,
            "standard deviation of the position in metres at which the rover is lost",
            _DEFAULTS.pose_deviation,
        ),
        Parameter(
            "velocity_needs_pose",
            bool,
            "true if velocities, too, are executed only while the rover is not lost",
            _DEFAULTS.velocity_needs_pose,
        ),
        Parameter(
            "lookahead",
            float,
            "distance in metres to the point of a path at which the rover aims",
            _DEFAULTS.lookahead,
        ),
        Parameter(
            "goal_tolerance",
            float,
            "distance in metres to the end of a path at which the rover stops",
            _DEFAULTS.goal_tolerance,
        ),
        Parameter("base_frame", str, "frame of the rover, for which velocities and poses are", "base_link"),
    ),
)
