"""Declaration of the node of ``roverlink rocks measure``."""

from __future__ import annotations

from roverlink.nodes import Direction, NodeDeclaration, Parameter, RowTopic

REQUEST = RowTopic(
    "rock_measure_request",
    Direction.RECEIVED,
    "endpoints of the line across a rock, in pixels of the colour image",
    inbound=True,
    fields=("x1", "y1", "x2", "y2"),
)
RESULT = RowTopic(
    "rock_measure_result",
    Direction.PUBLISHED,
    "length and width of the rock in centimetres, with standard deviations, or the reason why there are none",
    inbound=False,
    fields=("length_cm", "width_cm"),
)
SIGMAS, FAILURE = ("length_sigma_cm", "width_sigma_cm"), "failure"
"""Fields that the result of an older table does not have."""
NODE = NodeDeclaration(
    "rock_measurement",
    (REQUEST, RESULT),
    (
        Parameter("camera", str, "topic with the colour images in which the operator draws the line"),
        Parameter("depth", str, "topic with the depth that is aligned to the colour images; empty for the default"),
        Parameter("camera_info", str, "topic with the parameters of the colour camera; empty for the default"),
    ),
    other_topics=("/<depth>", "/<camera_info>"),
)
