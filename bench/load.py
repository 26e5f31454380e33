"""Load generator in Python, for machines without the C++ one: same arguments and lines as load.cpp.

python -m bench.load udp PORT DATAGRAM_HEX HIGH_OFFSET LOW_OFFSET
dds
"""

import json
import os
import socket
import struct
import sys
import time
from collections.abc import Callable

from bench.stamp import FLOAT, stamp

Send = Callable[[], None]

BURST_NS = 1_000_000  # interval of a paced load, which sends all that is due


def datagrams(port: int, datagram: bytearray, high_offset: int, low_offset: int) -> Send:
    """Return a function that sends the datagram with the current time in it."""
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    udp.connect(("127.0.0.1", port))

    def send() -> None:
        high, low = stamp(time.monotonic_ns())
        FLOAT.pack_into(datagram, high_offset, high)
        FLOAT.pack_into(datagram, low_offset, low)
        udp.send(datagram)

    return send


def samples() -> Send:
    """Return a function that writes a sample with the current time on rt/drive_motor."""
    from cyclonedds.domain import DomainParticipant
    from cyclonedds.pub import DataWriter
    from cyclonedds.topic import Topic

    from bench.handwritten import ROS_DEFAULTS, DrivingBoardMotorMessage

    def serialize(self: DrivingBoardMotorMessage, **_: object) -> bytes:
        return struct.pack("<4s2f", b"\0\1\0\0", self.distance_to_go, self.turning_radius)

    # The class must stay for matching; only its encoder, which is too slow, is replaced in this process.
    DrivingBoardMotorMessage.serialize = serialize  # type: ignore[assignment,method-assign]
    participant = DomainParticipant(int(os.environ.get("ROS_DOMAIN_ID", "0")))
    topic = Topic(participant, "rt/drive_motor", DrivingBoardMotorMessage)
    writer = DataWriter(participant, topic, qos=ROS_DEFAULTS)
    return lambda: writer.write(DrivingBoardMotorMessage(*stamp(time.monotonic_ns())))


def flood(send: Send, end_ns: int) -> int:
    """Send as fast as possible; return the number sent."""
    sent = 0
    while time.monotonic_ns() < end_ns:
        send()
        sent += 1
    return sent


def pace(send: Send, rate: float, start_ns: int, end_ns: int) -> int:
    """Send `rate` per second, in bursts every millisecond; return the number sent.

    If it is late, it shifts its schedule instead of sending a large burst, which would overflow a buffer that the rate
    does not.
    """
    sent, following = 0, start_ns
    for tick in range(1, (end_ns - start_ns) // BURST_NS + 1):
        due = int(rate * tick * BURST_NS / 1e9)
        for _ in range(due - sent):
            send()
        sent = due
        following = max(following + BURST_NS, time.monotonic_ns())
        time.sleep(max(0.0, (following - time.monotonic_ns()) / 1e9))
    return sent


def main(arguments: list[str]) -> None:
    """Answer lines until stdin ends."""
    if arguments[0] == "udp":
        port, datagram, high_offset, low_offset = arguments[1:]
        send = datagrams(int(port), bytearray.fromhex(datagram), int(high_offset), int(low_offset))
    else:
        send = samples()
    answer(send)


def answer(send: Send) -> None:
    """Send what each line of stdin asks for, until stdin ends."""
    for line in sys.stdin:
        rate, seconds = (float(word) for word in line.split())
        start = time.monotonic_ns()
        end = start + int(seconds * 1e9)
        sent = pace(send, rate, start, end) if rate else flood(send, end)
        print(json.dumps({"sent": sent, "seconds": (time.monotonic_ns() - start) / 1e9}), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
