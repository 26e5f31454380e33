"""ROS 2 topic with images as a source of frames."""

from __future__ import annotations

from collections.abc import Iterator
from typing import cast

from roverkit.vision.camera.camera_model import CameraParameters
from roverkit.vision.frames.frame import RATE, Frame, size_of
from roverkit.vision.frames.live import Say
from roverkit.vision.frames.topic_sets import Arrived, BadMessages, TopicSets
from roverkit.vision.ros.camera_info import camera_info_topic, camera_of, is_rectified
from roverkit.vision.ros.image_messages import IMAGES, read_image
from roverlink.runtime.core.errors import ConversionError, SetupError
from roverlink.runtime.interfaces.sensor_msgs import CameraInfo
from roverlink.runtime.middleware import Middleware
from roverlink.runtime.ros_time.clock import SYSTEM_CLOCK, Clock


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

    def read_camera(self, topic: str) -> CameraParameters:
        """Wait for the camera's parameters on a topic; return those for the images of this source.

        Raises `SetupError` if the camera is not calibrated.
        """
        with TopicSets(self._middleware, [topic], self._say, types=[CameraInfo]) as infos:
            (info,) = cast("tuple[CameraInfo]", next(iter(infos)))
        try:
            return camera_of(info, is_rectified(self.name))
        except SetupError as error:
            raise SetupError(f"{topic}: {error}") from error

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
