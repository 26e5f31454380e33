"""Messages of ROS 2 packages that our own programs use, one module per package.

They are written by hand, so that a rover does not need the rosbags package; a test compares them with ROS 2's
definitions. Messages that are published carry their type hash, which ROS 2 compares from Iron on. Generated code has
classes for all other messages of its rows, and imports these from here.
"""

from roverlink.runtime.interfaces.builtin_interfaces import Duration, Time

__all__ = ["Duration", "Time"]
