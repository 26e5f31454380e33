"""Contract of the driving board: how an arc becomes a command, and a command becomes an arc.

A command has the fields of the message ``drive_motor``. ``distance_to_go`` is in metres along the arc of the origin of
base_link, negative for driving backwards. ``turning_radius`` is in metres, positive if the centre of the arc is to the
left of the rover (REP 103), forwards and backwards alike. A radius of 0 is a straight line: 0 is the value of a field
that is not sent (proto3), and no arc has this radius. A new command replaces the one before, also in the middle of its
arc, and then starts at the place where the rover is. The number is not in the messages of every project.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from roverkit.driving.arcs import Arc

NUMBER = "command_number"
"""Field with the number of a command, in its message and in the reports of the board, if the project has it."""
LARGEST_RADIUS_M = 1e6
"""Radius in metres from which an arc is a straight line: over 100 m, such an arc is 5 mm beside it."""


@dataclass(frozen=True, slots=True)
class BoardCommand:
    """Command for the driving board; both values are in metres."""

    distance_to_go: float
    """Distance along the arc, negative for driving backwards."""
    turning_radius: float
    """Radius of the arc, positive to the left, negative to the right; see the module for a straight line."""
    command_number: int = 0
    """Number by which the board reports that it has taken the command; 0 if the command has none."""


STOP = BoardCommand(0.0, 0.0)
"""Command that stops the rover: nothing is left to go."""


class BoardLimitError(ValueError):
    """Error of an arc that the driving board cannot drive."""


@dataclass(frozen=True, slots=True)
class DrivingBoard:
    """Abilities of a driving board, and its spelling of a straight line."""

    smallest_radius: float = 0.0
    """Smallest turning radius in metres."""
    reverses: bool = True
    """True if the board drives backwards."""
    straight_radius: float = 0.0
    """``turning_radius`` of a straight line, in metres. Unless it is 0, larger radii are straight lines, too."""

    def command(self, arc: Arc) -> BoardCommand:
        """Return the command for an arc, whose radius `drivable` limits.

        Raises `BoardLimitError` if the board cannot drive the arc at all.
        """
        if not (math.isfinite(arc.length) and math.isfinite(arc.curvature)):
            raise BoardLimitError(f"{arc.length} m with the curvature {arc.curvature}/m is no arc")
        if arc.length < 0 and not self.reverses:
            raise BoardLimitError("the driving board does not drive backwards")
        if abs(arc.curvature) * self._largest_radius <= 1:
            return BoardCommand(arc.length, self.straight_radius)
        return BoardCommand(arc.length, 1 / self.drivable(arc).curvature)

    def arc(self, command: BoardCommand) -> Arc:
        """Return the arc that the board drives for a command. Raises `ValueError` if a value is not finite."""
        if not (math.isfinite(command.distance_to_go) and math.isfinite(command.turning_radius)):
            raise ValueError(f"the driving board cannot execute {command}")
        # The message holds single precision, so that a straight line comes back slightly shorter.
        straight = command.turning_radius == 0 or abs(command.turning_radius) >= self._largest_radius * (1 - 1e-6)
        return Arc(command.distance_to_go, 0.0 if straight else 1 / command.turning_radius)

    def drivable(self, arc: Arc) -> Arc:
        """Return the arc with the same length and side whose radius is not below the smallest one."""
        if abs(arc.curvature) * self.smallest_radius <= 1:
            return arc
        return replace(arc, curvature=math.copysign(1 / self.smallest_radius, arc.curvature))

    @property
    def _largest_radius(self) -> float:
        """Radius in metres from which an arc is sent as a straight line."""
        return abs(self.straight_radius) or LARGEST_RADIUS_M
