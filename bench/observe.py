"""Observer in Python, for machines without the C++ one: same arguments and lines as observe.cpp.

python -m bench.observe dds
udp PORT HIGH_OFFSET LOW_OFFSET
"""

import json
import os
import socket
import struct
import sys
import threading
import time
from types import SimpleNamespace

from bench.stamp import FLOAT, age_ns, ages_us

RECEIVE_BUFFER = 4 << 20  # bytes
STAMP_IN_IMU = struct.Struct("<16x2f")  # after the CDR header and accel_x, y, z: gyro_x, gyro_y


def watch_udp(ages: list[int], port: int, high_offset: int, low_offset: int) -> None:
    """Record the age of every stamped datagram, forever, on a separate thread."""
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    udp.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER)
    udp.bind(("127.0.0.1", port))
    shortest = max(high_offset, low_offset) + FLOAT.size

    def watch() -> None:
        while True:
            datagram = udp.recv(2048)
            if len(datagram) < shortest:
                continue  # no stamp in it: a bridge that tells the hardware to stop
            (high,), (low,) = FLOAT.unpack_from(datagram, high_offset), FLOAT.unpack_from(datagram, low_offset)
            ages.append(age_ns(high, low, time.monotonic_ns()))

    threading.Thread(target=watch, daemon=True).start()


def watch_dds(ages: list[int]) -> object:
    """Record the age of every sample on rt/imu_data, on Cyclone's thread, while the returned reader exists."""
    from cyclonedds.core import Listener, Policy, Qos
    from cyclonedds.domain import DomainParticipant
    from cyclonedds.sub import DataReader
    from cyclonedds.topic import Topic

    from bench.handwritten import ROS_DEFAULTS, ImuSensorInformation

    def deserialize(data: bytes, **_: object) -> SimpleNamespace:
        high, low = STAMP_IN_IMU.unpack_from(data)
        ages.append(age_ns(high, low, time.monotonic_ns()))
        return SimpleNamespace()

    def take_all(reader: "DataReader[ImuSensorInformation]") -> None:
        reader.take(N=1000)

    # The class must stay for matching; only its decoder, which is too slow, is replaced in this process.
    ImuSensorInformation.deserialize = deserialize  # type: ignore[assignment,method-assign]
    participant = DomainParticipant(int(os.environ.get("ROS_DOMAIN_ID", "0")))
    topic = Topic(participant, "rt/imu_data", ImuSensorInformation)
    listener = Listener(on_data_available=take_all)  # type: ignore[no-untyped-call]  # untyped in cyclonedds
    return DataReader(participant, topic, qos=Qos(Policy.History.KeepAll, base=ROS_DEFAULTS), listener=listener)


def main(arguments: list[str]) -> None:
    """Answer lines until stdin ends."""
    ages: list[int] = []
    reader = None
    if arguments[0] == "udp":
        port, high_offset, low_offset = (int(argument) for argument in arguments[1:])
        watch_udp(ages, port, high_offset, low_offset)
    else:
        reader = watch_dds(ages)
    answer(ages)
    del reader


def answer(ages: list[int]) -> None:
    """Answer each line of stdin with the ages that were recorded since the last one, until stdin ends."""
    for _ in sys.stdin:
        taken = ages[:]
        del ages[: len(taken)]
        print(json.dumps({"received": len(taken), **ages_us(taken)}), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
