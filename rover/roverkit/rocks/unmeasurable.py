"""Reasons why the size of a rock cannot be measured."""

from __future__ import annotations

from enum import Enum

from roverlink.runtime.core.errors import RoverlinkError


class Unmeasurable(str, Enum):
    """Reason why there is no size of a rock."""

    NO_IMAGE = "no_image"
    """There is no depth image that is new enough and can be used."""
    OUTSIDE_IMAGE = "outside_image"
    """An endpoint of the line is not in the image."""
    SHORT_LINE = "short_line"
    """The line is so short that an error of a pixel would change the length too much."""
    NOT_ALIGNED = "not_aligned"
    """The depth image has another size than the image of the camera."""
    LITTLE_DEPTH = "little_depth"
    """The depth of too many pixels at the line is missing."""
    NO_PLANE = "no_plane"
    """The ground around the line is no plane, or the camera sees it at too flat an angle."""
    NO_ROCK = "no_rock"
    """At the line, nothing stands out of the ground."""
    CUT_OFF = "cut_off"
    """The rock reaches the border of the image."""
    LINE_MISMATCH = "line_mismatch"
    """The line does not begin and end where one rock does."""


class UnmeasurableError(RoverlinkError):
    """Error of a rock whose size cannot be measured; the message is for the user."""

    def __init__(self, reason: Unmeasurable, message: str) -> None:
        super().__init__(message)
        self.reason = reason
