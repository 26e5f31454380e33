# Generated from mapping.yaml (row battery) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""battery (1): Battery to sensor_msgs/msg/BatteryState on battery/state."""

from __future__ import annotations

import math

from generated.interfaces import sensor_msgs, std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core.feed import UNSTAMPED, Feed, single
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time


class BatteryBatteryStateFeed(Feed[board_pb2.Battery, sensor_msgs.BatteryState]):
    """Battery to sensor_msgs/BatteryState on the topic battery/state."""

    route = Route(
        number=1,
        name="battery",
        topic="battery/state",
        direction="board_to_ros",
    )
    payload_type = board_pb2.Battery
    message_type = sensor_msgs.BatteryState

    @staticmethod
    def to_ros(
        payload: board_pb2.Battery,
        stamp: Time = UNSTAMPED,
    ) -> sensor_msgs.BatteryState:
        """The message that says what the payload says."""
        return sensor_msgs.BatteryState(
            header=std_msgs.Header(stamp=stamp, frame_id="battery"),
            voltage=payload.voltage_mv / 1_000.0,
            temperature=(
                payload.temperature if payload.HasField("temperature") else math.nan
            ),
            current=(
                payload.source.current
                if payload.source.HasField("current")
                else math.nan
            ),
            charge=math.nan,
            capacity=math.nan,
            design_capacity=math.nan,
            percentage=(
                payload.percentage / 100.0
                if payload.HasField("percentage")
                else -math.inf
            ),
            power_supply_status=0,
            power_supply_health=0,
            power_supply_technology=0,
            present=payload.lithium if payload.HasField("lithium") else False,
            location='belly "left"',
            serial_number=payload.serial if payload.HasField("serial") else "none",
        )

    @staticmethod
    def from_ros(message: sensor_msgs.BatteryState) -> board_pb2.Battery:
        """The payload that says what the message says."""
        return board_pb2.Battery(
            voltage_mv=round(message.voltage * 1_000.0),
            temperature=message.temperature,
            percentage=single(message.percentage * 100.0),
            lithium=message.present,
            serial=message.serial_number,
            source={"current": message.current},
        )
