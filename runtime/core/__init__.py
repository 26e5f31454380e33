"""Protocol core: datagram to envelope, handler and ROS 2 message, and back. No sockets, no clock, no ROS."""
