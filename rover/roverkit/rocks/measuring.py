"""Implementation of ``roverlink rocks measure``: answers requests with the sizes of rocks."""

from __future__ import annotations

import roverkit.vision  # noqa: F401  # first: it explains how to install numpy and OpenCV

# isort: split

import argparse
import logging
from collections.abc import Callable, Sequence

from roverkit.node.program import connected, json_printer, project_registry
from roverkit.rocks.camera_parameters import CameraTopicParameters
from roverkit.rocks.measurement import Line, RockSize, measure
from roverkit.rocks.rock_rows import RockRows
from roverkit.rocks.unmeasurable import Unmeasurable, UnmeasurableError
from roverkit.vision.frames.depth_camera import DepthCamera, NoDepthError
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.ros_arguments.ros_args import RosArguments


def measure_rocks(arguments: argparse.Namespace, ros: RosArguments, logger: logging.Logger) -> None:
    """Answer requests until the program is stopped.

    Raises `SetupError` if the table lacks a row, or if a topic is wrong.
    """
    rows = RockRows(project_registry(arguments))
    parameters = CameraTopicParameters(arguments, ros, logger)
    with connected(ros, arguments.middleware, logger, parameters) as connection:
        middleware = connection.middleware
        camera = DepthCamera(connection, lambda: parameters.meaning, logger.warning)
        publisher = rows.result.publisher(middleware, ros.topic)
        answering = Answering(camera, rows, publisher.publish, logger, as_json=arguments.json)
        rows.request.subscribe(middleware, ros.topic, answering.take)
        logger.info(
            "measuring rocks with the depth on %s; requests on %s",
            parameters.meaning.depth,
            ros.topic(rows.request.name),
        )
        camera.receive()


class Answering:
    """Answers to requests, each on the result's topic, in the log and, if wanted, as JSON on standard output."""

    def __init__(
        self,
        camera: DepthCamera,
        rows: RockRows,
        publish: Callable[[Sequence[bytes]], object],
        logger: logging.Logger,
        *,
        as_json: bool,
    ) -> None:
        self._camera, self._rows, self._publish, self._logger = camera, rows, publish, logger
        self._print = json_printer(as_json)

    def take(self, messages: Sequence[bytes]) -> None:
        """Answer serialized requests, on a thread of the middleware."""
        for data in messages:
            try:
                line = self._rows.line(data)
            except ConversionError as error:
                self._logger.warning("ignoring a request that cannot be read: %s", error)
                continue
            self._answer(line, data)

    def _answer(self, line: Line, request: bytes) -> None:
        """Measure a line, and publish the result, or the reason why there is none."""
        try:
            image = self._camera.image()
            size = measure(image.depth, image.camera, line)
        except NoDepthError as error:
            self._refuse(line, request, Unmeasurable.NO_IMAGE, error)
            return
        except UnmeasurableError as error:
            self._refuse(line, request, error.reason, error)
            return
        self._publish([self._rows.answer(size, request)])
        centimetres = (100 * one for one in (size.length, size.length_sigma, size.width, size.width_sigma))
        self._logger.info("rock of %.1f ± %.1f x %.1f ± %.1f cm", *centimetres)
        self._print({"line": line, "stamp": image.stamp, **_as_dict(size)})

    def _refuse(self, line: Line, request: bytes, reason: Unmeasurable, error: Exception) -> None:
        self._publish([self._rows.answer(reason, request)])
        self._logger.warning("no size of the rock (%s): %s", reason.value, error)
        self._print({"line": line, "reason": reason.value, "message": str(error)})


def _as_dict(size: RockSize) -> dict[str, object]:
    return {
        "length": size.length,
        "length_sigma": size.length_sigma,
        "width": size.width,
        "width_sigma": size.width_sigma,
        "valid": size.valid,
        "normal": size.ground.normal.tolist(),
        "height": size.ground.height,
    }
