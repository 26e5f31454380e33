"""Contestant `handwritten`: the bridge as a user would write it in Python with the usual libraries.

UDP -> DDS: receive, parse, find the payload, copy field by field into Cyclone DDS's message class, write. DDS -> UDP:
take, copy field by field into the protobuf message, serialize, send. Two messages, no framework.
"""

import argparse
import importlib
import json
import os
import signal
import socket
import threading
from dataclasses import dataclass
from typing import Any

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.annotations import final
from cyclonedds.idl.types import float32, uint8
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

# The protos are compiled when the benchmark runs, so a type checker cannot see this class.
PBEnvelope: Any = importlib.import_module("components.common.envelope_pb2").PBEnvelope

ROS_DEFAULTS = Qos(
    Policy.Reliability.Reliable(duration(seconds=10)),
    Policy.Durability.Volatile,
    Policy.History.KeepLast(10),
    Policy.WriterDataLifecycle(autodispose=False),
    Policy.DataRepresentation(use_cdrv0_representation=True),
)


@dataclass
@final
class SensorState(IdlStruct, typename="comms::msg::dds_::SensorState_"):
    """comms/msg/SensorState."""

    state: uint8


@dataclass
@final
class ImuSensorInformation(IdlStruct, typename="comms::msg::dds_::ImuSensorInformation_"):
    """comms/msg/ImuSensorInformation."""

    accel_x: float32
    accel_y: float32
    accel_z: float32
    gyro_x: float32
    gyro_y: float32
    gyro_z: float32
    mag_x: float32
    mag_y: float32
    mag_z: float32
    is_calibrated: bool
    state: SensorState
    error_code: uint8


@dataclass
@final
class DrivingBoardMotorMessage(IdlStruct, typename="comms::msg::dds_::DrivingBoardMotorMessage_"):
    """comms/msg/DrivingBoardMotorMessage."""

    distance_to_go: float32
    turning_radius: float32


@dataclass
class Counts:
    """Counts of bridged messages, printed as JSON when the bridge stops."""

    received: int = 0
    published: int = 0
    forwarded: int = 0
    sent: int = 0


def imu_message(imu: Any) -> ImuSensorInformation:
    """Convert a SensorBoardIMUInfo to its ROS message."""
    return ImuSensorInformation(
        accel_x=imu.accel_x,
        accel_y=imu.accel_y,
        accel_z=imu.accel_z,
        gyro_x=imu.gyro_x,
        gyro_y=imu.gyro_y,
        gyro_z=imu.gyro_z,
        mag_x=imu.mag_x,
        mag_y=imu.mag_y,
        mag_z=imu.mag_z,
        is_calibrated=imu.is_calibrated,
        state=SensorState(state=imu.state),
        error_code=imu.error_code,
    )


def motor_datagram(message: DrivingBoardMotorMessage) -> bytes:
    """Return the envelope of a drive command."""
    envelope = PBEnvelope()
    envelope.drive_motor.distance_to_go = message.distance_to_go
    envelope.drive_motor.turning_radius = message.turning_radius
    datagram: bytes = envelope.SerializeToString()
    return datagram


def receive(
    udp: socket.socket, writer: DataWriter[ImuSensorInformation], forwards: list[tuple[str, int]], counts: Counts
) -> None:
    """Bridge UDP to DDS until interrupted."""
    while True:
        datagram = udp.recv(65536)
        counts.received += 1
        for destination in forwards:
            udp.sendto(datagram, destination)
            counts.forwarded += 1
        envelope = PBEnvelope.FromString(datagram)
        if envelope.WhichOneof("payload") == "imu_info":
            writer.write(imu_message(envelope.imu_info))
            counts.published += 1


def send(
    reader: DataReader[DrivingBoardMotorMessage],
    udp: socket.socket,
    hardware: tuple[str, int],
    counts: Counts,
    stopping: threading.Event,
) -> None:
    """Bridge DDS to UDP until told to stop."""
    while not stopping.is_set():
        for message in reader.take_iter(timeout=duration(milliseconds=200)):
            udp.sendto(motor_datagram(message), hardware)
            counts.sent += 1


def main() -> None:
    """Run until SIGINT, then print the counts."""
    signal.signal(signal.SIGINT, signal.default_int_handler)  # the parent may have set it to be ignored
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("listen_port", type=int)
    parser.add_argument("a_port", type=int)
    parser.add_argument("b_port", type=int)
    parser.add_argument("--forward", action="store_true", help="also send every datagram raw to both ports")
    options = parser.parse_args()
    basestation, hardware = ("127.0.0.1", options.a_port), ("127.0.0.1", options.b_port)

    participant = DomainParticipant(int(os.environ.get("ROS_DOMAIN_ID", "0")))
    imu_data = Topic(participant, "rt/imu_data", ImuSensorInformation)
    drive_motor = Topic(participant, "rt/drive_motor", DrivingBoardMotorMessage)
    writer = DataWriter(participant, imu_data, qos=ROS_DEFAULTS)
    reader = DataReader(participant, drive_motor, qos=ROS_DEFAULTS)
    counts = Counts()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
        udp.bind(("127.0.0.1", options.listen_port))
        stopping = threading.Event()
        sender = threading.Thread(target=send, args=(reader, udp, hardware, counts, stopping))
        sender.start()
        try:
            receive(udp, writer, [basestation, hardware] if options.forward else [], counts)
        except KeyboardInterrupt:
            stopping.set()
            sender.join()
    print(json.dumps(vars(counts)), flush=True)


if __name__ == "__main__":
    main()
