"""Publishing of the rover's position on the topic from which a bridge sends it to the basestation."""

from __future__ import annotations

from collections.abc import Callable

from roverlink.runtime import Registry
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.middleware import Middleware
from roverlink.vision.camera.camera_model import Floats

ROW = "rover_localization"
"""Name of the row in mapping.yaml whose message carries the rover's position to the basestation."""
AXES = ("x", "y", "z")
"""Fields of the row's ROS message for the coordinates: metres in the coordinate frame of the playing field."""


def position_publisher(
    middleware: Middleware,
    registry: Registry,
    topic: Callable[[str], str],
    warn: Callable[[str], object] = lambda _: None,
) -> Callable[[Floats], None]:
    """Return a function that publishes the rover's position (3,), in metres, as the message of the row `ROW`.

    `topic` returns the fully qualified name of a topic. If the table (mapping.yaml) has no such row, or if its message
    has no field for one of `AXES`, ``warn`` is called with a message, and the returned function does nothing. This is
    no error, because tracking is useful without a peer too.
    """
    try:
        row = registry.row(ROW, AXES, inbound=False)
    except SetupError as error:
        warn(f"the rover's position is not sent: {error}")
        return lambda _: None
    route, message_type = row.route, row.message_type
    publish = middleware.publisher(topic(route.topic), message_type, route.qos).publish

    def publish_position(position: Floats) -> None:
        publish([cdr.encode(message_type(**dict(zip(AXES, position.tolist()))))])

    return publish_position
