"""Implementation of ``roverlink video send``: sends streams until their sources end, or a signal comes."""

from __future__ import annotations

import roverkit.vision  # noqa: F401  # first: it explains how to install numpy and OpenCV

# isort: split

import argparse
import logging
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

from roverkit.node.camera_source import open_source
from roverkit.node.ros_connection import RosConnection
from roverkit.video.encoder import fitted
from roverkit.video.gstreamer_output import GStreamerOutput
from roverkit.video.link_quality import LinkQualities, LinkQuality
from roverkit.video.overlay import SeenObjects, link_text, time_text
from roverkit.video.packet_pacing import PacedLink
from roverkit.video.sent_stream import SentStream
from roverkit.video.stream_control import StreamControl
from roverkit.video.stream_parameters import StreamParameters, Streams
from roverkit.video.stream_settings import StreamSettings
from roverkit.video.streams_file import LINK_RATE, SUFFIXES, StreamsFile, read_streams
from roverkit.video.video_output import RtpOutput, Sent, VideoOutput
from roverkit.vision.frames import Frame, FrameSource
from roverkit.vision.images.drawing import write_above
from roverkit.vision.images.object_drawing import draw_objects
from roverkit.vision.markers.detection import Image, to_colour
from roverlink.console import OK
from roverlink.node_log import publish_log
from roverlink.numerals import counted
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.net.udp import resolve
from roverlink.runtime.ros_arguments.ros_args import RosArguments

STREAM = "video"
"""Name of the stream that options describe."""
_PAYLOAD = 0.95
"""Part of a packet's bytes that are not headers of IP and UDP; and a reserve, because the bridge tells averages."""
_LEAST_RATE = 2_500.0
"""Least rate in bytes a second if the telemetry uses up the budget: a still image now and then."""
_LOG_S = 10.0
_LOOK_S = 0.1
_IN_THE_FILE = ("port", "size", "rate", "bitrate", "overlay", "pipeline", "link_rate")


def send(arguments: argparse.Namespace, ros: RosArguments, logger: logging.Logger) -> int:
    """Send the streams until all sources have ended, and return the exit code.

    Raises `SetupError` if no stream can be opened, or if a value is wrong.
    """
    described = _described(arguments)
    with ExitStack() as stack:
        sending = _Sending(arguments, described.streams, ros, logger, stack)
        link = stack.enter_context(PacedLink(1e3 * described.link_rate))
        streams = sending.open(link)
        for stream in streams:
            stack.enter_context(stream)
        _follow(streams, sending.answer_requests, logger)
    return OK


def _described(arguments: argparse.Namespace) -> StreamsFile:
    """Return the streams that the options describe, or the file that they name."""
    text: str = arguments.source
    if Path(text).suffix.lower() in SUFFIXES:
        for name in _IN_THE_FILE:
            if getattr(arguments, name) is not None:
                option = name.replace("_", "-")
                raise SetupError(f"--{option} has no effect with a file of streams; write '{name}' into {text}")
        return read_streams(Path(text), arguments.host or "")
    given = {name: getattr(arguments, name) for name in _IN_THE_FILE if name != "link_rate"}
    known = {name: value for name, value in given.items() if value is not None}
    stream = StreamSettings(STREAM, text, arguments.host or "127.0.0.1", **known)
    return StreamsFile((stream,), LINK_RATE if arguments.link_rate is None else arguments.link_rate)


class _Sending:
    """Streams with what they share: the node, its parameters, and the sources of the overlay."""

    def __init__(
        self,
        arguments: argparse.Namespace,
        streams: Sequence[StreamSettings],
        ros: RosArguments,
        logger: logging.Logger,
        stack: ExitStack,
    ) -> None:
        self._arguments, self._logger = arguments, logger
        self._streams: tuple[SentStream, ...] = ()
        self._addresses: dict[str, str] = {}
        self._link: PacedLink | None = None
        self._parameters = StreamParameters(streams, ros, self._change, logger)
        self._ros = RosConnection(ros, arguments.middleware or "auto", stack, logger.warning, self._parameters)
        self._qualities: LinkQualities | None = None
        self._objects: SeenObjects | None = None
        self._control: StreamControl | None = None
        if arguments.middleware:
            middleware = self._ros.middleware
            stack.enter_context(publish_log(logger, middleware, ros))
            self._qualities = LinkQualities(middleware, self._link_measured, logger.warning)
            self._objects = SeenObjects(middleware, ros.topic, logger.warning)
            self._control = StreamControl(middleware, ros, self._parameters)
        elif arguments.budget_of:
            raise SetupError("what is left of a budget comes from ROS 2; leave --middleware none out")
        elif any(set(settings.overlay) - {"time"} for settings in self._parameters.meaning):
            raise SetupError("the overlays 'objects' and 'link' come from ROS 2; leave --middleware none out")

    def open(self, link: PacedLink) -> tuple[SentStream, ...]:
        """Open all streams, and return them. Those whose source is missing are tried again if another one works.

        Raises `SetupError` if none works.
        """

        def output(settings: StreamSettings) -> VideoOutput:
            address = resolve(settings.host, settings.port)
            self._addresses[settings.name] = address[0]
            return GStreamerOutput(settings, address) if settings.pipeline else RtpOutput(settings, address, link)

        self._link = link
        self._streams = tuple(
            SentStream(
                settings,
                self._source,
                output,
                self._prepared,
                self._ros.clock,
                self._logger.warning,
                loop=self._arguments.loop,
            )
            for settings in self._parameters.meaning
        )
        errors: list[SetupError] = []
        for stream in self._streams:
            try:
                stream.open()
            except SetupError as error:  # its thread tries again, and tells it
                errors.append(error)
                continue
            if (to := stream.settings).running:
                self._logger.info("%s: images go to %s:%d", to.name, to.host, to.port)
        if len(errors) == len(self._streams):
            raise errors[0]
        return self._streams

    def _source(self, settings: StreamSettings) -> FrameSource:
        # A camera is asked for the size, and a folder is played with the rate. The images of other sources are scaled,
        # and those above the rate are left out.
        return open_source(
            settings.source,
            settings.camera,
            self._ros,
            settings.size,
            self._logger.warning,
            rate=settings.rate,
            any_size=True,
        )

    def _prepared(self, frame: Frame, settings: StreamSettings) -> Image:
        """Return the image to send for a frame: of the stream's size, with its overlay."""
        image, overlay = frame.image, settings.overlay
        if "objects" in overlay and self._objects:
            image = draw_objects(image, self._objects.now(), {})  # before the scaling: its boxes are in these pixels
        image = fitted(image, settings.size)
        lines = [time_text(frame.stamp)] if "time" in overlay else []
        lines += [link_text(self._quality(settings))] if "link" in overlay else []
        return write_above(to_colour(image), "   ".join(lines)) if lines else image

    def _quality(self, settings: StreamSettings) -> LinkQuality | None:
        address = self._addresses.get(settings.name)
        return self._qualities.of(address) if self._qualities and address else None

    def _change(self, streams: Streams) -> None:
        """Give the streams their changed settings; ROS 2 calls this through the parameters."""
        for stream, settings in zip(self._streams, streams):
            if stream.settings != settings:
                stream.change(settings)
        if self._control:
            self._control.publish()

    def answer_requests(self) -> None:
        """Answer the requests of ``roverlink video set``."""
        if self._control:
            self._control.answer()

    def _link_measured(self) -> None:
        """Tell the streams, and the link, what the bridge measures, about once a second."""
        peer = self._arguments.budget_of
        left = self._qualities.left_of_budget(peer) if peer and self._qualities else None
        if left is not None and self._link:
            self._link.limit(8 * max(_PAYLOAD * left, _LEAST_RATE))
        for stream in self._streams:
            if quality := self._quality(stream.settings):
                stream.link_measured(quality.loss, quality.round_trip)


def _follow(streams: Sequence[SentStream], answer_requests: Callable[[], None], logger: logging.Logger) -> None:
    """Answer requests, and log the rates of the streams now and then, until all sources have ended."""
    before, at = [Sent()] * len(streams), time.monotonic()
    while not all(stream.finished.is_set() for stream in streams):
        time.sleep(_LOOK_S)
        answer_requests()
        now = time.monotonic()
        if now - at >= _LOG_S:
            after = [replace(stream.sent) for stream in streams]
            for stream, old, new in zip(streams, before, after):
                logger.info("%s: %s", stream.settings.name, _rates(old, new, now - at))
            before, at = after, now


def _rates(before: Sent, after: Sent, seconds: float) -> str:
    """Return the rates of a stream between two counts as text."""
    if after.images < before.images:  # it was opened again
        before = Sent()
    parts = [
        f"{(after.images - before.images) / seconds:.1f} images/s",
        f"{(after.octets - before.octets) * 8 / 1000 / seconds:.0f} kbit/s",
    ]
    if after.skipped > before.skipped:
        parts.append(f"{counted(after.skipped - before.skipped, 'image')} left out because the link was full")
    if after.lost > before.lost:
        parts.append(f"{counted(after.lost - before.lost, 'packet')} lost")
    if after.round_trip is not None:
        parts.append(f"round trip {1e3 * after.round_trip:.0f} ms")
    return ", ".join(parts)
