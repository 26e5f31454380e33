# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""The messages of the ROS 2 package rover."""

from __future__ import annotations

from generated.messages.annotated import Annotated
from generated.messages.arm import Arm
from generated.messages.bool import Bool_
from generated.messages.cdr import Cdr
from generated.messages.class_ import Class
from generated.messages.class_var import ClassVar_
from generated.messages.gps import GPS
from generated.messages.imu import IMU
from generated.messages.item import Item
from generated.messages.message import Message_
from generated.messages.mixed_case import MixedCase
from generated.messages.motor_handler import MotorHandler_
from generated.messages.motor_pb2 import MotorPb2
from generated.messages.nothing import Nothing
from generated.messages.payload import Payload
from generated.messages.route import Route_
from generated.messages.route_handler import RouteHandler_
from generated.messages.route_qos import RouteQos
from generated.messages.sensor2 import Sensor2
from generated.messages.sensor10 import Sensor10
from generated.messages.u_int8 import UInt8_
from generated.messages.waypoint import Waypoint

__all__ = [
    "Annotated",
    "Arm",
    "Bool_",
    "Cdr",
    "Class",
    "ClassVar_",
    "GPS",
    "IMU",
    "Item",
    "Message_",
    "MixedCase",
    "MotorHandler_",
    "MotorPb2",
    "Nothing",
    "Payload",
    "RouteHandler_",
    "RouteQos",
    "Route_",
    "Sensor10",
    "Sensor2",
    "UInt8_",
    "Waypoint",
]
