"""Datagram bytes to envelope, handler and message, and back: no sockets, no clock, no ROS."""
