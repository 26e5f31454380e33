# Generated from mapping.yaml (row ph_info) and components/sensor_board/ph_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of SensorBoardPHInfo as sensor_msgs/msg/Temperature.

The registry uses this class; programs import `PhTemperatureTopic`
from `generated.extra_topics.ph_temperature`.
"""

from __future__ import annotations

from generated.extra_topics.ph_temperature import PhTemperatureTopic
from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2.components.sensor_board import ph_sensor_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.standard_handler import UNSTAMPED
from roverlink.runtime.interfaces import Time

# Constant fields are serialized only once. The bytes of the other fields are inserted between them.
_SERIALIZED = cdr.template(
    sensor_msgs.Temperature(header=std_msgs.Header(frame_id="ph_link")),
    [
        "header.stamp",
        "temperature",
    ],
)
_BEFORE_HEADER_STAMP_SEC, _BEFORE_TEMPERATURE, _END = _SERIALIZED.constants
_LAYOUT = _SERIALIZED.layout


class FastPhTemperatureTopic(PhTemperatureTopic):
    """PhTemperatureTopic that converts a payload to a serialized ROS message in one step."""

    def _pack(
        self, payload: ph_sensor_pb2.SensorBoardPHInfo, stamp: Time = UNSTAMPED
    ) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            _BEFORE_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _BEFORE_TEMPERATURE,
            payload.temperature,
            _END,
        )
