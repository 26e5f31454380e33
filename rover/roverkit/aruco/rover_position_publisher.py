"""Publisher of the rover's position on the topic from which a bridge sends it to the basestation.

The row can have extra topics (table key ``also``) with the position that a filter fuses from all sensors. The bridge
sends these itself. While messages come on one of them, the position from the markers alone is not published, so the
basestation gets one source at a time.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence

from roverkit.aruco.tracker_declaration import FUSED_POSITION, POSITION
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.ros.outputs import Outputs
from roverlink.runtime import Registry
from roverlink.runtime.core.errors import MiddlewareError, SetupError
from roverlink.runtime.middleware import Middleware

FUSED_S = 1.0
"""Time in seconds after a message on an extra topic of the row, in which the position from the markers is held back."""


def position_publisher(
    middleware: Middleware,
    registry: Registry,
    topic: Callable[[str], str],
    warn: Callable[[str], None] = lambda _: None,
) -> Callable[[Floats], None]:
    """Return a function that publishes the rover's position (3,), in metres, as the message of the row `POSITION`.

    `topic` returns the fully qualified name of a topic. If the table (mapping.yaml) has no such row, if its message has
    no field for a coordinate, or if ROS 2 lacks the message because the generated package is not built, ``warn`` is
    called with a message, and the returned function does nothing. This is no error, because tracking is useful without
    a peer too.

    The function publishes nothing for `FUSED_S` after each message on an extra topic of the row.
    """
    try:
        row = POSITION.of(registry)
    except SetupError as error:
        warn(f"the rover's position is not sent: {error}")
        return lambda _: None
    message_type, output = row.message_type, Outputs(middleware, topic, warn).open(row)
    fused_at = -math.inf

    def fused(_: Sequence[bytes]) -> None:
        nonlocal fused_at
        fused_at = time.monotonic()

    for extra in FUSED_POSITION.of(registry):
        try:
            extra.subscribe(middleware, topic, fused)
        except MiddlewareError as error:
            warn(f"the rover's position is not held back for {topic(extra.name)}: {error}")

    def publish_position(position: Floats) -> None:
        if time.monotonic() - fused_at > FUSED_S:
            output.publish(message_type(**dict(zip(POSITION.fields, position.tolist()))))

    return publish_position
