# Generated from mapping.yaml (row pressure_info) and components/sensor_board/pressure_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of SensorBoardPressureInfo as sensor_msgs/msg/FluidPressure.

The registry uses this class; programs import `PressureFluidPressureTopic`
from `generated.extra_topics.pressure_fluid_pressure`.
"""

from __future__ import annotations

from generated.extra_topics.pressure_fluid_pressure import PressureFluidPressureTopic
from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2.components.sensor_board import pressure_sensor_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.standard_handler import UNSTAMPED
from roverlink.runtime.interfaces import Time

# Constant fields are serialized only once. The bytes of the other fields are inserted between them.
_SERIALIZED = cdr.template(
    sensor_msgs.FluidPressure(header=std_msgs.Header(frame_id="pressure_link")),
    [
        "header.stamp",
        "fluid_pressure",
    ],
)
_BEFORE_HEADER_STAMP_SEC, _BEFORE_FLUID_PRESSURE, _END = _SERIALIZED.constants
_LAYOUT = _SERIALIZED.layout


class FastPressureFluidPressureTopic(PressureFluidPressureTopic):
    """PressureFluidPressureTopic that converts a payload to a serialized ROS message in one step."""

    def _pack(
        self,
        payload: pressure_sensor_pb2.SensorBoardPressureInfo,
        stamp: Time = UNSTAMPED,
    ) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            _BEFORE_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _BEFORE_FLUID_PRESSURE,
            payload.pressure_kpa * 1_000.0,
            _END,
        )
