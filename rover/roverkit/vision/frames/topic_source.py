"""ROS 2 topic with images as a source of frames, and the topic with the camera's parameters beside it."""

from __future__ import annotations

from collections.abc import Iterator

from roverkit.vision.camera.camera_model import CameraParameters
from roverkit.vision.frames.frame import RATE, Frame, size_of
from roverkit.vision.frames.live import Say
from roverkit.vision.frames.topic_sets import Arrived, BadMessages, TopicSets
from roverkit.vision.ros.camera_info import camera_info_topic, camera_of, is_rectified
from roverkit.vision.ros.image_messages import IMAGES, read_image
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError, SetupError
from roverlink.runtime.interfaces.sensor_msgs import CameraInfo
from roverlink.runtime.middleware import Middleware
from roverlink.runtime.ros_time.clock import SYSTEM_CLOCK, Clock

_STAMPED = 12
"""Bytes of a serialized message before the body: the CDR header, and the stamp, with which its header begins."""


class CameraInfos:
    """Topic with the parameters of a camera, which may change: a lens zooms, or a driver is calibrated again.

    A context manager: on exit it ends the subscription.
    """

    def __init__(self, middleware: Middleware, topic: str, say: Say, *, rectified: bool) -> None:
        """Begin to receive a fully qualified topic; `say` is called with messages while the first one is missing.

        With `rectified`, the parameters are those for rectified images.
        """
        self._topic, self._rectified = topic, rectified
        self._body = b""
        # A driver may publish its parameters once, for late joiners too: then their silence says nothing.
        self._sets = TopicSets(middleware, [topic], lambda text: None if self._body else say(text), types=[CameraInfo])

    def first(self) -> CameraParameters:
        """Wait for the parameters, and return them. Raises `SetupError` if the camera is not calibrated."""
        for _, (arrived,) in self._sets.arrivals():
            return self._read(arrived)
        raise SetupError(f"{self._topic}: closed before the parameters of the camera came")

    def changed(self) -> CameraParameters | None:
        """Return the newest parameters, without waiting, if they are others than before; None if they are not.

        Raises `SetupError` if the camera is not calibrated any more, once for each change.
        """
        found = self._sets.take(0)
        if found is None or found[1][0].data[_STAMPED:] == self._body:
            return None
        return self._read(found[1][0])

    def _read(self, arrived: Arrived) -> CameraParameters:
        self._body = arrived.data[_STAMPED:]
        try:
            return camera_of(cdr.decode(CameraInfo, arrived.data), self._rectified)
        except (ConversionError, SetupError) as error:
            raise SetupError(f"{self._topic}: {error}") from error

    def __enter__(self) -> CameraInfos:
        return self

    def __exit__(self, *_: object) -> None:
        self._sets.__exit__()


class TopicSource:
    """Topic with images as a source of frames, which are grey or BGR. An iteration yields the newest image.

    All frames have the size of the first one, unless any size is wanted.
    """

    live = True
    total: int | None = None
    rate = RATE

    def __init__(
        self, middleware: Middleware, topic: str, say: Say, clock: Clock = SYSTEM_CLOCK, *, any_size: bool = False
    ) -> None:
        """Begin to receive a fully qualified topic; `say` is called with messages for the user.

        Images without a stamp get the time of `clock`. The topic needs no publisher yet: the iteration waits for one.
        With `any_size`, the size of the images may change.
        """
        self._any_size = any_size
        self.name = topic
        self._middleware, self._say = middleware, say
        self._sets = TopicSets(middleware, [topic], say, types=IMAGES, clock=clock)
        self._bad = BadMessages(topic, say)
        self._size: tuple[int, int] | None = None
        self._stamped = True

    def __iter__(self) -> Iterator[Frame]:
        """Yield the newest frame, then wait for a newer one, and so on. No frame is yielded twice.

        Images that are damaged, are depths or have an unwanted size are ignored. Raises `MiddlewareError` if the
        topic has messages of another type.
        """
        for number, (arrived,) in self._sets.arrivals():
            try:
                frame = self._frame(number, arrived)
            except ConversionError as error:
                self._bad.add(error)
                continue
            self._bad.good()
            yield frame

    @property
    def camera_info_topic(self) -> str:
        """Topic on which a driver publishes the camera's parameters: the one beside the topic with the images."""
        return camera_info_topic(self.name)

    def camera_infos(self, topic: str) -> CameraInfos:
        """Begin to receive the camera's parameters, for the images of this source, on a topic."""
        return CameraInfos(self._middleware, topic, self._say, rectified=is_rectified(self.name))

    def __enter__(self) -> TopicSource:
        return self

    def __exit__(self, *_: object) -> None:
        self._sets.__exit__()

    def _frame(self, number: int, arrived: Arrived) -> Frame:
        message = read_image(arrived.message_type, arrived.data)
        image = message.image()
        if self._size is None:
            self._size = size_of(image)
        elif size_of(image) != self._size and not self._any_size:
            # The camera's parameters are those of the first size.
            sizes = "{}x{} to {}x{}".format(*self._size, *size_of(image))
            raise ConversionError(f"the image size has changed from {sizes} pixels; start the program again")
        if not message.stamp and self._stamped:
            self._stamped = False
            self._say(f"{self.name}: the images have no stamps; using the times of their arrival")
        return Frame(image, message.stamp or arrived.at, number, message.frame_id)
