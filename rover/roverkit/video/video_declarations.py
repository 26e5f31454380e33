"""Declarations of the nodes of ``roverlink video send``, ``roverlink video receive`` and ``roverlink video set``."""

from __future__ import annotations

from roverkit.objects import object_declarations
from roverlink.nodes import Direction, NodeDeclaration, Parameter, Topic
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.interfaces.diagnostic_msgs import DiagnosticArray
from roverlink.runtime.interfaces.sensor_msgs import CompressedImage
from roverlink.runtime.interfaces.std_msgs import String
from roverlink.runtime.monitoring import diagnostic_array

OVERLAYS = ("time", "objects", "link")
"""What can be drawn into the images."""
_KEPT = Qos(depth=1, durability="transient_local")  # who comes later gets the last message
_REQUESTS = Qos(depth=10)
STREAMS = Topic(
    "video/streams",
    (String,),
    Direction.PUBLISHED,
    "streams of the sender as JSON, after each change; kept for late subscribers",
    _KEPT,
)
SET = Topic("video/set", (String,), Direction.RECEIVED, "requests of `roverlink video set` as JSON", _REQUESTS)
OBJECTS = object_declarations.DETECTIONS.received("objects that are drawn into the images", Qos(depth=1))
LINK = Topic(
    diagnostic_array.TOPIC,
    (DiagnosticArray,),
    Direction.RECEIVED,
    "quality of the link, as the bridge measures it",
    diagnostic_array.QOS,
)
STREAM_PARAMETERS = (
    Parameter("<stream>.running", bool, "false to send nothing, and to close the camera"),
    Parameter("<stream>.source", str, "camera, topic:NAME, video file, folder of images, or URL"),
    Parameter("<stream>.host", str, "name or address of the receiver's computer"),
    Parameter("<stream>.port", int, "UDP port of the receiver"),
    Parameter("<stream>.size", str, "size of the sent images, such as 640x480; empty for that of the source"),
    Parameter("<stream>.rate", float, "most images a second"),
    Parameter("<stream>.bitrate", float, "most kbit/s"),
    Parameter("<stream>.min_bitrate", float, "kbit/s below which congestion does not press the stream"),
    Parameter("<stream>.overlay", str, f"what is drawn into the images, with commas: {', '.join(OVERLAYS)}"),
    Parameter("<stream>.pipeline", str, "pipeline of GStreamer, or the name of one; empty for the own encoder"),
)
"""Parameters of each stream."""
SENDER = NodeDeclaration("video_sender", (STREAMS, SET, OBJECTS, LINK), STREAM_PARAMETERS, takes_images=True)

RECEIVED_IMAGES = Topic(
    "video/<stream>/compressed",
    (CompressedImage,),
    Direction.PUBLISHED,
    "with `--topic`: images of a stream",
    Qos(depth=5),  # the depth of ROS 2's profile for sensor data
)
RECEIVER = NodeDeclaration("video_receiver", (RECEIVED_IMAGES,))

KNOWN_STREAMS = STREAMS.received("streams of all senders", _KEPT)
REQUESTS = Topic("video/set", (String,), Direction.PUBLISHED, "requests to the senders as JSON", _REQUESTS)
SETTER = NodeDeclaration("video_set", (KNOWN_STREAMS, REQUESTS))
