"""The contestant `floor`: receive and count, nothing else. No bridge in Python can be cheaper than this."""

import argparse
import json
import signal
import socket
import time

from bench.stamp import FLOAT, age_ns, ages_us

AGED = 3000  # of so many datagrams the age is measured, too: of all at 1 kHz, of next to none in a flood


def main() -> None:
    """Receive until SIGINT, then print the count."""
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a parent may have set it to be ignored
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
