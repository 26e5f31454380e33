"""Conversion of datagrams to ROS 2 messages and back, without sockets, clock or ROS.

A datagram contains an envelope: a protobuf message with a oneof. The payload is the message in this oneof. A generated
handler converts the payload to its ROS 2 message and back.
"""
