"""Server that shows the topics of a bridge live in Foxglove, over Foxglove's WebSocket protocol.

The schemas of the topics are ROS 2 message definitions.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence

from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Message
from roverlink.runtime.core.tap import Tap
from roverlink.runtime.net.addresses import openable_host
from roverlink.runtime.recording.message_definitions import definition_of

PORT = 8765
"""TCP port to which Foxglove connects by default."""
_ORIGINS = ("https://app.foxglove.dev", "file://")
"""Origins of Foxglove in a browser, and of viewers that are programs with pages of their own."""
_STOP_S = 0.2  # time in which the viewers can read the last messages


class FoxgloveServer:
    """Server to which Foxglove connects. A context manager, and a `Listener` of topics.

    The bridge's threads pass messages to the Foxglove SDK, which queues them. Messages of topics that no viewer has
    opened are skipped.
    """

    def __init__(self, name: str, address: str, port: int) -> None:
        """Start the server; for port 0, the system selects a free port.

        Raises `SetupError` if the port is not available.
        """
        import foxglove  # here: it is an optional package

        from roverlink.runtime.net.websocket_gate import WebSocketGate, hidden_address  # here: slow to import

        self._foxglove = foxglove
        self._context = foxglove.Context()
        behind = hidden_address()
        try:
            self._server = foxglove.start_server(name=name, host=behind, port=0, context=self._context)
        except (RuntimeError, OSError, ValueError) as error:
            raise SetupError(f"cannot start the server of topics for Foxglove on {behind}: {error}") from error
        try:
            self._gate = WebSocketGate(address, port, "topics for Foxglove", (behind, self._server.port), _ORIGINS)
        except SetupError:
            self._server.stop()
            raise
        self.url = f"ws://{openable_host(address)}:{self._gate.port}"
        """URL that Foxglove can open."""

    def topic(self, topic: str, message_type: type[Message], qos: Qos) -> Tap:  # noqa: ARG002  # WebSocket has no QoS
        """Offer a topic to viewers, and return a function that takes the topic's messages."""
        schema = self._foxglove.Schema(
            name=message_type.__msgtype__, encoding="ros2msg", data=definition_of(message_type).encode()
        )
        channel = self._foxglove.Channel(topic, schema=schema, message_encoding="cdr", context=self._context).base
        wanted, log, now = channel.has_sinks, channel.log, time.time_ns

        def tap(messages: Sequence[bytes], arrived: Sequence[int] = ()) -> None:
            # Checked for each batch, since viewers come and go.
            if wanted():
                ahead = now() - time.monotonic_ns() if arrived else 0
                for index, message in enumerate(messages):
                    log(message, arrived[index] + ahead if arrived else now())

        return tap

    def __enter__(self) -> FoxgloveServer:
        self._gate.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self._gate.__exit__()
        # It waits until every viewer has read everything, which one that hangs never does.
        stopping = threading.Thread(target=self._server.stop, name="foxglove-stop", daemon=True)
        stopping.start()
        stopping.join(_STOP_S)
