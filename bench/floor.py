"""Contestant `floor`: receive and count only. No bridge in Python can be cheaper."""

import argparse
import json
import signal
import socket
import time

from bench.stamp import FLOAT, age_ns, ages_us

AGED = 3000  # datagrams whose age is measured: all at 1 kHz, almost none of a flood


def main() -> None:
    """Receive until SIGINT, then print the count."""
    signal.signal(signal.SIGINT, signal.default_int_handler)  # the parent may have set it to be ignored
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("listen_port", type=int)
    parser.add_argument("high_offset", type=int)
    parser.add_argument("low_offset", type=int)
    options = parser.parse_args()
    received = 0
    ages: list[int] = []
    stamp = (options.high_offset, options.low_offset)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
        udp.bind(("127.0.0.1", options.listen_port))
        try:
            while received < AGED:
                datagram = udp.recv(65536)
                now = time.monotonic_ns()
                (high,), (low,) = (FLOAT.unpack_from(datagram, offset) for offset in stamp)
                ages.append(age_ns(high, low, now))
                received += 1
            while True:
                udp.recv(65536)
                received += 1
        except KeyboardInterrupt:
            print(json.dumps({"received": received, **ages_us(ages)}), flush=True)


if __name__ == "__main__":
    main()
