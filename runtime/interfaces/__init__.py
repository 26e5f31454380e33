"""Messages of ROS 2 packages that our own programs use, one module for each package.

The classes are written by hand, so that a rover does not need the rosbags package. A test compares them with the
definitions of ROS 2. The messages that our programs publish have a type hash, which ROS 2 compares since the
distribution Iron. The classes of all other messages are in the generated code, which imports these classes from here.
"""

from roverlink.runtime.interfaces.builtin_interfaces import Duration, Time

__all__ = ["Duration", "Time"]
