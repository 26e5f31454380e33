"""Sources of frames: a camera, a network stream, a ROS 2 topic, a video file, or a folder of images.

    with open_source("192.168.0.7:8080", say=print) as source:
        for frame in source:
            tracker.track(frame.image, frame.stamp)

The frames of a recorded source end; their stamps count from the start of the recording. The frames of a `live` source
continue until the source is closed; a stamp is the time at which the frame was taken.

`TopicSets` reads several topics together, such as colour, depth and the camera's parameters, synchronized by their
stamps.
"""

from roverkit.vision.frames.frame import RATE, Frame, FrameSource
from roverkit.vision.frames.open_source import open_source
from roverkit.vision.frames.playing import play
from roverkit.vision.frames.recorded import ImageFiles
from roverkit.vision.frames.topic_sets import TopicMessage, TopicSets
from roverkit.vision.frames.topic_source import TopicSource

__all__ = [
    "RATE",
    "Frame",
    "FrameSource",
    "ImageFiles",
    "TopicMessage",
    "TopicSets",
    "TopicSource",
    "open_source",
    "play",
]
