"""Services and clients of services over rclpy, with serialized requests and responses.

rclpy answers a service as soon as its callback returns. A request to a peer is answered later, so the callback returns
a `_Pending`, and what rclpy sends at once is kept back until the response is there. A coroutine would need no such
step, but the executors of Humble and Jazzy poll coroutines that wait, at full load of a processor core.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message, serialize_message

from roverlink.runtime.core.handler import RowService
from roverlink.runtime.middleware.interface_packages import installed_class, installed_service
from roverlink.runtime.middleware.protocol import Respond

_QOS = QoSProfile(depth=1000)  # as for the services of parameters; the default loses requests of a burst of 11


class _Pending:
    """Response that is not there yet. All methods are called on the thread of the executor."""

    def __init__(self) -> None:
        self._response: Any = None
        self._send: Callable[[Any], None] | None = None

    def send_with(self, send: Callable[[Any], None]) -> None:
        """Send the response with ``send`` as soon as it is there."""
        self._send = send
        self._send_once()

    def respond(self, response: Any) -> None:
        """Send this response."""
        self._response = response
        self._send_once()

    def _send_once(self) -> None:
        if self._send is not None and self._response is not None:
            self._send(self._response)


def offer(node: Any, executor: Any, name: str, service: RowService, answer: Callable[[bytes, Respond], None]) -> None:
    """Offer a service; see `Middleware.offer`. Call it on the thread of the executor."""
    response_class = installed_class(service.response)

    def take(request: Any, _: Any) -> _Pending:
        pending = _Pending()

        def respond(data: bytes) -> None:
            executor.create_task(lambda: pending.respond(deserialize_message(data, response_class)))

        answer(bytes(serialize_message(request)), respond)
        return pending

    made = node.create_service(installed_service(service.request), name, take, qos_profile=_QOS)
    send = made.send_response
    made.send_response = lambda pending, header: pending.send_with(lambda response: send(response, header))


class RclpyClient:
    """Client of one service. Several threads may call."""

    def __init__(self, node: Any, executor: Any, name: str, service: RowService) -> None:
        """Create the client. Call it on the thread of the executor."""
        self._executor, self._request_class = executor, installed_class(service.request)
        installed_class(service.response)
        self._client = node.create_client(installed_service(service.request), name)

    def call(self, request: bytes, done: Respond) -> bool:
        """Send a request; return false if no node offers the service."""
        if not self._client.service_is_ready():
            return False

        def send() -> None:
            future = self._client.call_async(deserialize_message(request, self._request_class))
            future.add_done_callback(lambda future: done(bytes(serialize_message(future.result()))))

        self._executor.create_task(send)
        return True
