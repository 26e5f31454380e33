"""Messages of ROS 2's packages that our own programs speak, one module a package.

They are written by hand, so that a rover needs no rosbags; a test compares them with ROS 2's definitions. What is
published has its type's hash, which ROS 2 compares from Iron on. A table's generated code has the other messages that
its rows need, and takes these from here.
"""

from roverlink.runtime.interfaces.builtin_interfaces import Duration, Time

__all__ = ["Duration", "Time"]
