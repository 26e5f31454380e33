"""Implementation of ``roverlink video receive``: receives streams until a signal comes."""

from __future__ import annotations

import roverkit.vision  # noqa: F401  # first: it explains how to install numpy and OpenCV

# isort: split

import argparse
import json
import logging
import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack

from roverkit.node.camera_outputs import NO_MIDDLEWARE
from roverkit.node.ros_connection import RosConnection
from roverkit.video.received_stream import ReceivedStream, TakeImage, TakeUnit
from roverkit.video.rtp_receiver import RtpReceiver
from roverkit.video.stream_file import StreamFiles
from roverkit.video.video_declarations import RECEIVED_IMAGES
from roverkit.video.video_page import StreamsServer
from roverkit.vision.markers.detection import Image
from roverkit.vision.ros.image_messages import compressed_of
from roverkit.vision.ros.outputs import Outputs
from roverlink.console import OK
from roverlink.node_log import publish_log
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.ros_arguments.ros_args import RosArguments

_LOOK_S = 0.1
_JSON_S = 1.0


def receive(arguments: argparse.Namespace, ros: RosArguments, logger: logging.Logger) -> int:
    """Receive streams until a signal comes, or until one of them cannot be saved any more.

    Raises `SetupError` then, and if a port is in use.
    """
    ports: Mapping[str, int] = arguments.ports
    if arguments.mp4 and not arguments.save:
        raise SetupError("--mp4 has no effect without --save FOLDER")
    with ExitStack() as stack:
        receivers = {name: stack.enter_context(RtpReceiver(arguments.listen, number)) for name, number in ports.items()}
        publish = _publishers(list(receivers), arguments, ros, logger, stack)
        streams = [
            ReceivedStream(name, receiver, _saver(name, arguments, stack), publish[name])
            for name, receiver in receivers.items()
        ]
        if arguments.page:
            host, number = arguments.page
            server = stack.enter_context(StreamsServer(host, number, {stream.name: stream for stream in streams}))
            logger.info("page: %s", server.url)
        for stream in streams:
            stack.enter_context(stream)
        _follow(streams, arguments, logger)
    return OK


def _saver(name: str, arguments: argparse.Namespace, stack: ExitStack) -> TakeUnit:
    if arguments.save is None:
        return lambda _: None
    return stack.enter_context(StreamFiles(arguments.save, name, ".mp4" if arguments.mp4 else ".mkv")).add


def _publishers(
    names: Sequence[str], arguments: argparse.Namespace, ros: RosArguments, logger: logging.Logger, stack: ExitStack
) -> Mapping[str, TakeImage]:
    """Return a function for each stream that publishes its images; they do nothing without ``--topic``."""
    middleware = arguments.middleware or ("auto" if arguments.topic else NO_MIDDLEWARE)
    if middleware == NO_MIDDLEWARE:
        if arguments.topic:
            raise SetupError(f"--topic needs ROS 2; leave --middleware {NO_MIDDLEWARE} out")
        return dict.fromkeys(names, lambda *_: None)
    connection = RosConnection(ros, middleware, stack, logger.warning)
    stack.enter_context(publish_log(logger, connection.middleware, ros))
    outputs = Outputs(connection.middleware, ros.topic, logger.warning)

    def publisher(name: str) -> TakeImage:
        output = outputs.open(RECEIVED_IMAGES.named(name))

        def publish(image: Image, stamp: int) -> None:
            output.put(lambda: compressed_of(image, stamp, f"{name}_optical_frame"))

        return publish

    return {name: publisher(name) for name in names} if arguments.topic else dict.fromkeys(names, lambda *_: None)


def _follow(streams: Sequence[ReceivedStream], arguments: argparse.Namespace, logger: logging.Logger) -> None:
    """Tell when streams come and go, until a signal comes. Raises the error that has ended a stream."""
    live: dict[str, bool] = {}
    printed = time.monotonic()
    while True:
        time.sleep(_LOOK_S)
        now = time.monotonic()
        states = [stream.state() for stream in streams]
        for stream, state in zip(streams, states):
            if stream.problem is not None:
                raise stream.problem
            if live.get(stream.name, False) != (not state["stale"]):
                live[stream.name] = not state["stale"]
                _tell(state, logger)
        if arguments.json and now - printed >= _JSON_S:
            printed = now
            print(json.dumps({"streams": states}), flush=True)


def _tell(state: Mapping[str, object], logger: logging.Logger) -> None:
    if state["stale"]:
        logger.warning("%s: no image for a second", state["name"])
    else:
        logger.info("%s: images come from %s", state["name"], state["source"])
