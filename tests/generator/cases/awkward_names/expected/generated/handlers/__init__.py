# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""The handlers: one class for each row of the table."""

from __future__ import annotations

from generated.handlers.class_ import ClassHandler
from generated.handlers.message import MessageHandler
from generated.handlers.mixed_case import MixedCaseHandler
from generated.handlers.motor import MotorHandler
from generated.handlers.none import NoneHandler
from generated.handlers.route import RouteHandler
from generated.handlers.sensor_2 import Sensor2Handler
from generated.handlers.sensor_10 import Sensor10Handler

__all__ = [
    "ClassHandler",
    "MessageHandler",
    "MixedCaseHandler",
    "MotorHandler",
    "NoneHandler",
    "RouteHandler",
    "Sensor10Handler",
    "Sensor2Handler",
]
