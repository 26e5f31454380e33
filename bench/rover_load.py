"""Load of a whole rover: the datagrams and commands of `roverlink simulate`, and a reader of what the bridge sends.

python -m bench.rover_load MIDDLEWARE PROJECT PORT RATE SECONDS KEYS

RATE is the number of datagrams a second of all rows together, or 0 for that of `roverlink simulate`. They are made for
so many SECONDS in advance, because that takes longer than sending them. KEYS is a folder for the keys of the peers that
must sign. An empty line on stdin is answered with what the bridge needs to know; a line with a number of seconds with
the number of datagrams that were sent in this time, and of commands.
"""

import contextlib
import itertools
import json
import random
import sys
import time
from pathlib import Path

from roverlink.commands.simulate import COMMANDS_HZ, RATE_OF_A_ROW_HZ
from roverlink.generated_code import load_project
from roverlink.runtime.middleware import NodeIdentity, open_middleware
from roverlink.runtime.net import udp
from roverlink.simulation.peers import Arrivals, Senders
from roverlink.simulation.scenarios import Stream, World, emissions
from roverlink.simulation.simulated_keys import SimulatedKeys, make_throw_away_keys
from roverlink.simulation.simulated_nodes import SimulatedNodes


def main(middleware: str, project: str, port: str, rate: str, seconds: str, keys: str) -> None:
    """Answer lines until stdin ends."""
    registry = load_project(Path(project))
    files = [*make_throw_away_keys(registry, Path(keys)).values()]
    with contextlib.ExitStack() as stack:
        arrivals = stack.enter_context(Arrivals(registry))
        signing = stack.enter_context(SimulatedKeys(registry, files)) if files else None
        world = World(registry, random.Random(0), udp.LARGEST, signing)  # noqa: S311  # repeatable, not secret
        endless = emissions(world, float(rate) or RATE_OF_A_ROW_HZ * len(world.inbound), [])
        stream = iter([*itertools.takewhile(lambda emission: emission.at < float(seconds), endless)])
        senders = stack.enter_context(Senders("127.0.0.1", int(port)))
        nodes = SimulatedNodes(registry, stack.enter_context(open_middleware(middleware, NodeIdentity("load"))))
        for line in sys.stdin:
            answer: dict[str, object] = {"parameters": arrivals.parameters, "keys": [*map(str, files)]}
            if line.strip():
                answer = _play(stream, float(line), senders, nodes)
            print(json.dumps(answer), flush=True)


def _play(stream: Stream, seconds: float, senders: Senders, nodes: SimulatedNodes) -> dict[str, object]:
    sent = commands = 0
    start, began, next_commands = None, time.monotonic(), 0.0
    for emission in stream:
        start = emission.at if start is None else start
        if emission.at - start >= seconds:
            break
        while (now := time.monotonic() - began) < emission.at - start:
            time.sleep(emission.at - start - now)
        if now >= next_commands:
            commands += nodes.publish(emission.at)
            next_commands += 1 / COMMANDS_HZ
        sent += senders.send(emission)
    return {"sent": sent, "commands": commands, "seconds": time.monotonic() - began}


if __name__ == "__main__":
    main(*sys.argv[1:])
