"""A fleet on one computer: N rovers that publish all rows of the table, and a basestation that subscribes to them.

python -m bench.fleet [--rovers N ...] [--middleware NAME ...] [--seconds S]

Each rover is a process with the node /roverN/udp_forwarder, which publishes every row 20 times a second. They run in a
network namespace of their own, so that its loopback interface counts their traffic alone (`unshare`, from util-linux).
"""

import argparse
import contextlib
import itertools
import json
import multiprocessing
import os
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import IO, Any, NamedTuple, cast

from rich.console import Console
from rich.table import Table

from bench.contestants import ROOT
from bench.process import cpu_clock
from bench.rig import free_port
from roverlink.generated_code import load_project
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime import NODE
from roverlink.runtime.middleware import NodeIdentity, open_middleware

HERTZ = 20.0
IDLE_S, WARM_UP_S, SETTLE_S, PATIENCE_S = 5.0, 1.0, 2.0, 120.0
_INSIDE = "ROVERLINK_BENCH_FLEET"
_COLUMNS = (
    "",
    "rovers",
    "all found, s",
    "to find, MB",
    "idle, kB/s",
    "messages/s",
    "lost",
    "CPU %: base",
    "router",
    "a rover",
)
_FORK = multiprocessing.get_context("fork")  # so that the processes share the memory of what they import
_CYCLONE = (
    '<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="lo" multicast="true"/></Interfaces></General>'
    "</Domain></CycloneDDS>"
)


class Fleet(NamedTuple):
    """Events that all processes share, and what the rovers tell."""

    join: Any
    publish: Any
    stop: Any
    heard: Any
    told: Any


def _rover(number: int, middleware: str, fleet: Fleet) -> None:
    """Be a rover: join, say when all topics have a subscriber, publish, and tell the count and the CPU seconds."""
    registry = load_project(ROOT)
    node = NodeIdentity(NODE, f"/rover{number}")
    fleet.join.wait()
    with open_middleware(middleware, node) as ros:
        rows = [
            (
                ros.publisher(node.topic(handler.route.topic), handler.message_type, handler.route.qos),
                [handler.to_cdr(payload_at(handler.payload_type, 1.0))],
            )
            for handler in registry.handlers
        ]
        while not all(publisher.has_subscribers() for publisher, _ in rows):
            time.sleep(0.05)
        fleet.heard.release()
        fleet.publish.wait()
        sent, due, used = 0, time.monotonic() + number % 10 / 10 / HERTZ, time.process_time()
        while not fleet.stop.is_set():
            time.sleep(max(0.0, due - time.monotonic()))
            due += 1 / HERTZ
            sent += sum(publisher.publish(message) for publisher, message in rows)
        fleet.told.put((sent, time.process_time() - used))
        time.sleep(2 * SETTLE_S)


def _measure(middleware: str, rovers: int, seconds: float) -> Sequence[str]:
    """Run one fleet in this network namespace, and return a row of the table."""
    subprocess.run(["ip", "link", "set", "lo", "up", "multicast", "on"], check=True)  # noqa: S607
    subprocess.run(["ip", "route", "add", "224.0.0.0/4", "dev", "lo"], check=True)  # noqa: S607
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    os.environ |= {
        "CYCLONEDDS_URI": _CYCLONE,
        "ROS_DISTRO": "jazzy",
        # All rovers start at once on the cores of one computer, so that it takes long to connect.
        "ZENOH_CONFIG_OVERRIDE": f'mode="client";connect/endpoints=["{endpoint}"];connect/timeout_ms=60000;'
        "transport/unicast/open_timeout=20000",
    }
    fleet = Fleet(_FORK.Event(), _FORK.Event(), _FORK.Event(), _FORK.Semaphore(0), _FORK.Queue())
    processes = [_FORK.Process(target=_rover, args=(one, middleware, fleet), daemon=True) for one in range(rovers)]
    for process in processes:
        process.start()
    registry, counts = load_project(ROOT), Counter[str]()
    with contextlib.ExitStack() as stack:
        for process in processes:
            stack.callback(process.kill)
        router = stack.enter_context(_router(endpoint)) if middleware == "zenoh" else 0
        began, bytes_before = time.monotonic(), _loopback_bytes()
        fleet.join.set()
        base = stack.enter_context(open_middleware(middleware, NodeIdentity("basestation")))
        for number in range(rovers):
            for handler in registry.handlers:
                topic = NodeIdentity(NODE, f"/rover{number}").topic(handler.route.topic)
                base.subscribe(topic, handler.message_type, handler.route.qos, partial(_count, counts, topic))
        for _ in processes:
            if not fleet.heard.acquire(timeout=PATIENCE_S):
                return (middleware, str(rovers), f"not after {PATIENCE_S:.0f}", *["-"] * 7)
        found_s, found_bytes = time.monotonic() - began, _loopback_bytes() - bytes_before
        time.sleep(WARM_UP_S)
        idle_from = _loopback_bytes()
        time.sleep(IDLE_S)
        idle = (_loopback_bytes() - idle_from) / IDLE_S
        used, of_router = time.process_time(), _cpu_s(router)
        fleet.publish.set()
        time.sleep(seconds)
        fleet.stop.set()
        used, of_router = time.process_time() - used, _cpu_s(router) - of_router
        told = [fleet.told.get(timeout=PATIENCE_S) for _ in processes]
        time.sleep(SETTLE_S)
        sent, got = sum(count for count, _ in told), sum(counts.values())
    return (
        middleware,
        str(rovers),
        f"{found_s:.1f}",
        f"{found_bytes / 1e6:.1f}",
        f"{idle / 1e3:.0f}",
        f"{got / seconds:,.0f}",
        f"{sent - got:,} of {sent:,}",
        f"{100 * used / seconds:.0f}",
        f"{100 * of_router / seconds:.0f}" if router else "",
        f"{100 * sum(cpu for _, cpu in told) / len(told) / seconds:.1f}",
    )


def _count(counts: Counter[str], topic: str, messages: Sequence[bytes]) -> None:
    counts[topic] += len(messages)


@contextlib.contextmanager
def _router(endpoint: str) -> Iterator[int]:
    """Run a router, and yield its process id."""
    command = [sys.executable, "-m", "roverlink", "zenoh-router", "--listen", endpoint]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as router:  # noqa: S603  # our own program
        cast(IO[str], router.stderr).readline()  # it runs
        try:
            yield router.pid
        finally:
            router.kill()


def _cpu_s(process: int) -> float:
    """Return the CPU seconds that another process has used; 0 for the process id 0."""
    return time.clock_gettime(cpu_clock(process)) if process else 0.0


def _loopback_bytes() -> int:
    (line,) = (line for line in Path("/proc/net/dev").read_text().splitlines() if line.strip().startswith("lo:"))
    return int(line.split()[1])


def main(words: Sequence[str]) -> int:
    """Measure each fleet over each middleware, and print a table."""
    parser = argparse.ArgumentParser(prog="python -m bench.fleet", description=__doc__.partition("\n")[0])
    parser.add_argument("--rovers", type=int, nargs="+", default=[10, 20, 50], metavar="N")
    parser.add_argument("--middleware", nargs="+", default=["zenoh", "dds"], choices=("zenoh", "dds"))
    parser.add_argument("--seconds", type=float, default=10.0, metavar="S")
    options = parser.parse_args(words)
    if _INSIDE in os.environ:
        print(json.dumps(_measure(options.middleware[0], options.rovers[0], options.seconds)))
        return 0
    os.environ[_INSIDE] = "1"
    table = Table(*_COLUMNS)
    for middleware, rovers in itertools.product(options.middleware, map(str, options.rovers)):
        # Each fleet needs a process of its own, because a process with the threads of zenoh must not fork.
        own = ("--middleware", middleware, "--rovers", rovers, "--seconds", str(options.seconds))
        command = ["unshare", "--map-root-user", "--net", sys.executable, "-m", "bench.fleet", *own]
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)  # noqa: S603  # our own program
        table.add_row(*json.loads(done.stdout))
        print(done.stdout, end="", file=sys.stderr, flush=True)  # the largest fleet takes long
    Console(width=140).print(table)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
