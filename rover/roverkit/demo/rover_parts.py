"""Parts of roverkit in ``roverlink demo``: a rover that drives, its cameras, and its video on a page."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack

from roverkit.demo.demo_rover import DemoRover
from roverlink.runtime import SetupError
from roverlink.simulation.demo_parts import DemoPart, DemoSetting


def open_parts(setting: DemoSetting, stack: ExitStack) -> Iterator[DemoPart]:
    """Start the rover and its cameras; the user is told what is left out, because a row or a package is missing."""
    rover = None
    try:
        rover = DemoRover(setting.registry)
        yield rover
    except SetupError as error:
        setting.say(f"running without a rover: {error}")
    # Before the rover's camera: the first renders all its images at once, which would hold that one up.
    try:
        from roverkit.demo.object_camera import ObjectCamera

        yield stack.enter_context(ObjectCamera(setting))
    except SetupError as error:
        setting.say(f"running without a camera that sees objects: {error}")
    if rover is not None:
        yield from _rover_camera(setting, rover, stack)


def _rover_camera(setting: DemoSetting, rover: DemoRover, stack: ExitStack) -> Iterator[DemoPart]:
    """Start the camera of the rover, its video, and the page that shows the video and the paths of the rover."""
    try:
        from roverkit.demo.marker_camera import MarkerCamera
        from roverkit.demo.rover_images import RoverImages

        images = stack.enter_context(RoverImages(rover, setting.folder))
        yield stack.enter_context(MarkerCamera(setting, rover, images))
    except SetupError as error:
        setting.say(f"running without a camera on the rover: {error}")
        return
    try:
        from roverkit.demo.camera_stream import CameraStream
        from roverkit.demo.demo_page import demo_handler
        from roverkit.video.video_page import StreamsServer
    except SetupError as error:
        setting.say(f"running without video: {error}")
        return
    stream = stack.enter_context(CameraStream(images.url("video")))
    streams = {stream.received.name: stream.received}
    page = stack.enter_context(StreamsServer("127.0.0.1", 0, streams, demo_handler(rover.driven)))
    setting.say(f"page with the video of the camera and the paths of the rover: {page.url}")
    yield stream
