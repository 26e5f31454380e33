"""Conversion of datagrams to ROS 2 messages and back, without sockets, clock or ROS.

A datagram contains an envelope; a generated handler converts the envelope's payload.
"""
