"""Implementation of ``roverlink video set``: asks the senders of streams to change them, and prints the values."""

from __future__ import annotations

import argparse
import json
import threading
import uuid
from collections.abc import Callable, Collection, Mapping

from roverkit.video.stream_control import Request, Streams, publish_json, subscribe_json
from roverkit.video.video_declarations import KNOWN_STREAMS, REQUESTS
from roverlink.runtime.core.errors import SetupError, nearest
from roverlink.runtime.middleware import open_middleware
from roverlink.runtime.ros_arguments.ros_args import RosArguments

FIND_S = 20.0
"""Time in seconds in which a sender must be found, and in which it must answer.

If the first announcement of a participant is lost, Cyclone DDS sends the next one eight seconds later (80 % of its
lease of ten seconds). So there are two more within this time.
"""
_SETTLE_S = 1.0  # senders become known one after the other
_AGAIN_S = 0.5  # a request may be lost before the sender knows us


def set_streams(changes: Mapping[str, str], arguments: argparse.Namespace, ros: RosArguments) -> None:
    """Change parameters of senders, such as ``front.bitrate``, and print what they are now; without changes, print all.

    Raises `SetupError` if there is no sender, or if one refuses.
    """
    with open_middleware(arguments.middleware, ros.node) as middleware:
        senders = _Senders()
        subscribe_json(KNOWN_STREAMS, middleware, ros.topic, Streams, senders.take)
        requests = REQUESTS.publisher(middleware, ros.topic)
        asked = _requests(changes, senders, ros)
        for _ in range(round(FIND_S / _AGAIN_S)):
            for request in asked:
                if not senders.has_answered(request):
                    publish_json(requests, request)
            if senders.wait(lambda: all(map(senders.has_answered, asked)), _AGAIN_S):
                break
    for request in asked:
        if not senders.has_answered(request):
            raise SetupError(f"the sender {request.node} does not answer; its streams may be changed or not")
        if problem := senders.known[request.node].problem:
            raise SetupError(problem)
    _print(senders, changes, as_json=arguments.json)


class _Senders:
    """Senders that were heard."""

    def __init__(self) -> None:
        self.known: dict[str, Streams] = {}
        """Newest message of each sender by its node."""
        self._news = threading.Condition()

    def take(self, message: Streams) -> None:
        """Take a message of a sender."""
        with self._news:
            self.known = {**self.known, message.node: message}
            self._news.notify_all()

    def wait(self, condition: Callable[[], bool], timeout_s: float) -> bool:
        """Wait until a condition about the senders holds; return false if it does not in time."""
        with self._news:
            return self._news.wait_for(condition, timeout_s)

    def names(self) -> list[str]:
        """Return the names of all streams."""
        return [name for sender in self.known.values() for name in sender.streams]

    def nodes_of(self, name: str) -> list[str]:
        """Return the nodes that send a stream of this name."""
        return [node for node, sender in self.known.items() if name in sender.streams]

    def has_answered(self, request: Request) -> bool:
        """Return true if the sender has answered a request."""
        return self.known[request.node].request == request.id


def _requests(changes: Mapping[str, str], senders: _Senders, ros: RosArguments) -> list[Request]:
    """Return the requests to the senders of the streams that are to be changed. Waits until the senders are known."""
    names = [name.partition(".")[0] for name in changes]
    if not senders.wait(lambda: bool(senders.known), FIND_S):
        raise SetupError(
            f"no sender of video was found on {ros.topic(KNOWN_STREAMS.name)}; start `roverlink video send` in the "
            "same ROS_DOMAIN_ID, and not with --middleware none"
        )
    senders.wait(lambda: bool(names) and set(names) <= set(senders.names()), _SETTLE_S)
    values: dict[str, dict[str, str]] = {}
    for stream, (name, value) in zip(names, changes.items()):
        nodes = senders.nodes_of(stream)
        if not nodes:
            raise SetupError(f"no sender has a stream {stream!r}; {nearest(stream, senders.names())}")
        if len(nodes) > 1:
            raise SetupError(
                f"{' and '.join(nodes)} have a stream {stream!r}; start one of them with another name of the "
                "stream, or in another namespace (--ros-args -r __ns:=/NAME)"
            )
        values.setdefault(nodes[0], {})[name] = value
    return [Request(node, uuid.uuid4().hex, given) for node, given in values.items()]


def _print(senders: _Senders, changed: Collection[str], *, as_json: bool) -> None:
    """Print the values of the changed parameters, or of all if none was changed."""
    streams = {name: values for sender in senders.known.values() for name, values in sender.streams.items()}
    if as_json:
        print(json.dumps(streams))
        return
    for stream, values in sorted(streams.items()):
        for key, value in values.items():
            if not changed or f"{stream}.{key}" in changed:
                print(f"{stream}.{key}: {json.dumps(value)}")
