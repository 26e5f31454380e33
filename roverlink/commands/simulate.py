"""Test a bridge with the datagrams of simulated boards, also with faults such as losses.

Send the datagrams that the boards and the basestation of mapping.yaml would send, to test a bridge, or the
ROS 2 nodes that use it, without boards. The values in the messages change with the time.

The peers answer the requests of the bridge (table key `request`).

With --to, the datagrams go to a running bridge. At the end, the command prints how many datagrams it sent,
and the result that the bridge should count for them, such as 57 published, 3 malformed.

With --bridge, the command starts a bridge, and stops it at the end. It then prints how many datagrams the
bridge published, forwarded and dropped. The exit code is 1 if these numbers do not add up to the number of
datagrams sent, or if the memory of the bridge grows.

A line on standard error says if this computer was too slow for the rate (--rate).

Peers that must sign (table key `sign`) use the keys in the files of --key-file. With --bridge, the bridge
gets these files, too; without --key-file, the command makes keys for this run alone.

scenarios:

Example: roverlink simulate --scenario lossy --scenario padded --seed 7 --to 127.0.0.1:5000
"""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import itertools
import json
import math
import random
import socket
import tempfile
import time
from collections import deque
from collections.abc import Iterator, Sequence
from pathlib import Path

from roverlink import topic_types
from roverlink.console import (
    FINDINGS,
    OK,
    Subparsers,
    add_destination,
    add_key_file,
    add_project,
    documented_command,
    isolate_ros,
    print_note,
    print_undelivered,
    project_folder,
    rate,
    seconds,
)
from roverlink.generated_code import load_project
from roverlink.numerals import counted
from roverlink.runtime import Registry, SetupError, Translator
from roverlink.runtime.net import udp
from roverlink.runtime.net.carrier import way_to
from roverlink.runtime.ros_arguments import parameters
from roverlink.simulation.bridge_host import MIDDLEWARES, BridgeHost, bridge_with
from roverlink.simulation.peers import MOST_KEPT, Arrivals, Senders
from roverlink.simulation.run_account import RunTotals, predict, resident_bytes, sent_to_peers
from roverlink.simulation.scenarios import SCENARIOS, Emission, Stream, World, emissions
from roverlink.simulation.simulated_keys import SimulatedKeys, make_throw_away_keys
from roverlink.simulation.simulated_nodes import SimulatedNodes

_LOG_LEVEL = "error"  # its warnings repeat the counters of the final report
RATE_OF_A_ROW_HZ = 20.0
COMMANDS_HZ = 20.0
# Making a datagram takes longer than sending it. At a high rate, a part of the stream is made in advance and repeated.
_PREPARED = 5000
_PREPARED_FROM_HZ = 1000.0
_TICK_S = 0.002
_DISCOVERY_S = 10.0
_SETTLE_S = 0.3
_TIMEOUT_S = 20.0
_RECEIVE_BUFFER = 1024 * 1024
_EVERY_ADDRESS = "0.0.0.0"  # noqa: S104  # the bridge may be another machine


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(
        commands, __name__, __doc__, "".join(f"\n  {name:<12}{_summary(name)}" for name in SCENARIOS)
    )
    add_project(parser)
    parser.add_argument(
        "--peer",
        metavar="NAME",
        help="simulate only this peer of the table, such as the one at the end of a serial line (default: all peers)",
    )
    target = parser.add_mutually_exclusive_group()
    add_destination(target)
    target.add_argument(
        "--bridge",
        choices=MIDDLEWARES,
        help="start a bridge, and check its counters at the end. dds, rclpy: the bridge is a separate process in "
        "ROS 2; memory: the bridge runs in this process, without ROS 2",
    )
    parser.add_argument(
        "--scenario",
        action="append",
        default=[],
        choices=tuple(SCENARIOS),
        help="fault to simulate (see the list above); may be repeated (default: no fault)",
    )
    parser.add_argument(
        "--seed",
        type=int,
        default=0,
        metavar="N",
        help="seed of the random numbers; the same seed gives the same faults (default: %(default)s)",
    )
    parser.add_argument(
        "--rate",
        type=rate,
        metavar="HZ",
        help=f"total number of datagrams a second (default: {RATE_OF_A_ROW_HZ:g} times the number of rows)",
    )
    parser.add_argument(
        "--seconds",
        type=seconds,
        default=math.inf,
        metavar="S",
        help="stop after S seconds (default: send until Ctrl-C)",
    )
    add_key_file(
        parser,
        "file with the keys of a peer or board that must sign; with --to, a copy of the bridge's file; may be repeated",
    )
    parser.add_argument("--json", action="store_true", help="print the report as a JSON object")
    parser.set_defaults(run=run, runs_until_stopped=True)


def _summary(name: str) -> str:
    return str(SCENARIOS[name].__doc__).partition("\n")[0]


def run(arguments: argparse.Namespace) -> int:
    """Simulate the peers. With ``--bridge``, the exit code is 1 if the bridge's counts do not add up."""
    registry = _with_rows_of(arguments.peer, load_project(project_folder(arguments.project)))
    longest = parameters.defaults(registry)["max_datagram"]
    with contextlib.ExitStack() as stack:
        key_files = arguments.key_file or _throw_away_keys(registry, arguments.bridge, stack)
        keys = stack.enter_context(SimulatedKeys(registry, key_files)) if key_files else None
        world = World(registry, random.Random(arguments.seed), longest, keys)  # noqa: S311  # repeatable, not secret
        hertz = arguments.rate or RATE_OF_A_ROW_HZ * len(world.inbound)
        stream = emissions(world, hertz, arguments.scenario)
        # Signatures and link messages are numbered and the clocks of boards count, so that none can be sent twice.
        if world.inbound and not (hertz < _PREPARED_FROM_HZ or keys or registry.link or registry.board_stamps):
            stream = _repeated(stream, _PREPARED)
        totals = RunTotals()
        if arguments.bridge is None:
            code = _to_a_bridge(arguments, world, stream, totals)
        else:
            code = _with_a_bridge(arguments, world, stream, totals, key_files)
        if note := totals.missed_rate(hertz):
            print_note(note)
        return code


def _with_rows_of(peer: str | None, registry: Registry) -> Registry:
    if peer is None:
        return registry
    name = registry.peer(peer).name
    return dataclasses.replace(registry, handlers=tuple(one for one in registry.handlers if one.route.peer == name))


def _throw_away_keys(registry: Registry, bridge: str | None, stack: contextlib.ExitStack) -> Sequence[Path]:
    """Make keys for this run, if a peer must sign; return their files, which ``stack`` removes.

    Raises `SetupError` if a simulated peer must sign and no bridge is started: a running bridge has keys of its own.
    """
    simulated = {handler.route.peer for handler in registry.handlers}  # a bridge needs the keys of all peers
    must_sign = [peer.name for peer in registry.peers if peer.must_sign and (bridge or peer.name in simulated)]
    if not must_sign:
        return ()
    if bridge is None:
        cure = "give a copy of the bridge's key file with --key-file FILE, or let --bridge start a bridge"
        raise SetupError(f"the peer {must_sign[0]!r} must sign (table key `sign`), but there is no key; {cure}")
    folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="roverlink-keys-"))
    return [*make_throw_away_keys(registry, Path(folder)).values()]


def _to_a_bridge(arguments: argparse.Namespace, world: World, stream: Stream, totals: RunTotals) -> int:
    asked: deque[bytes] = deque(maxlen=MOST_KEPT)
    with contextlib.ExitStack() as stack, contextlib.suppress(KeyboardInterrupt):
        way = stack.enter_context(way_to(arguments.to, print_undelivered))
        for sock in [way.socket] if way.socket else _ports_of_requests(world, stack):
            stack.enter_context(udp.Receiver(sock, udp.LARGEST, asked.extend))
        senders = stack.enter_context(Senders(*way.address, asked.extend if world.requests else None))
        for _ in _play(stream, arguments.seconds, senders, totals, world, asked):
            pass
    if arguments.json:
        print(json.dumps({"sent": dict(sorted(totals.sent.items())), "unsendable": totals.unsendable}))
        return OK
    ends = ", ".join(f"{count} {end}" for end, count in totals.sent.most_common())
    sent = counted(totals.sent.total(), "datagram")
    print(f"sent {sent} to {arguments.to}; the bridge should have counted: {ends or 'none'}")
    return OK


def _ports_of_requests(world: World, stack: contextlib.ExitStack) -> Iterator[socket.socket]:
    """Yield a socket at the port of each end that gets requests; one that learns the port gets them where it sends."""
    for name in dict.fromkeys(world.registry.end_of(world.registry.by_name[row].route) for row in world.requests):
        if port := world.registry.ends[name].port:
            try:
                yield stack.enter_context(udp.bind(_EVERY_ADDRESS, port, _RECEIVE_BUFFER))
            except SetupError as error:
                print_note(f"{name} answers no requests: {error}")


def _with_a_bridge(
    arguments: argparse.Namespace, world: World, stream: Stream, totals: RunTotals, key_files: Sequence[Path]
) -> int:
    with contextlib.ExitStack() as stack:
        isolate_ros(stack)
        arrivals = stack.enter_context(Arrivals(world.registry))
        project = project_folder(arguments.project)
        host = bridge_with(arguments.bridge, project, world.registry, arrivals.parameters, _LOG_LEVEL, key_files)
        # Before the bridge, so that only this process reports a package that is not installed.
        middleware = stack.enter_context(host.middleware(topic_types.identity("simulate")))
        stack.enter_context(host)
        senders = stack.enter_context(Senders("127.0.0.1", host.port))
        nodes, next_commands = SimulatedNodes(world.registry, middleware), 0.0
        _await_bridge(nodes)
        with contextlib.suppress(KeyboardInterrupt):
            for now in _play(stream, arguments.seconds, senders, totals, world, arrivals.newest):
                if now >= next_commands:
                    next_commands = now + 1 / COMMANDS_HZ
                    totals.commands += nodes.publish(now)
                _watch_memory(host, now, totals)
        # The last datagrams are still on their way; counters must agree only at rest.
        time.sleep(_SETTLE_S)
        totals.account = host.stop()
        _wait_for(arrivals, totals)
    return _report(totals, as_json=arguments.json)


def _await_bridge(nodes: SimulatedNodes) -> None:
    """Wait until the bridge hears the nodes, so that the run has commands from its beginning; ten seconds at most."""
    deadline = time.monotonic() + _DISCOVERY_S
    while not nodes.are_heard() and time.monotonic() < deadline:
        time.sleep(_TICK_S)


def _repeated(stream: Stream, count: int) -> Stream:
    """Return a stream of the first ``count`` datagrams of a stream again and again, at later and later times.

    These datagrams are made here, before the clock of the run starts.
    """
    prepared = [*itertools.islice(stream, count)]
    # One interval behind the last datagram, so that the seam of two repetitions is not a burst.
    length = prepared[-1].at + prepared[-1].at / count
    return (
        dataclasses.replace(emission, at=start * length + emission.at)
        for start in itertools.count()
        for emission in prepared
    )


def _play(
    stream: Stream, length: float, senders: Senders, totals: RunTotals, world: World, asked: deque[bytes]
) -> Iterator[float]:
    """Send each datagram of a stream at its time, for ``length`` seconds. Count sent datagrams in ``totals``.

    The requests in ``asked`` are answered as soon as possible. Yields the time since the start, in seconds, every few
    milliseconds, so that the caller can do other work meanwhile.
    """
    translator = world.keys.translator() if world.keys is not None else Translator(world.registry)
    predictions, lives = dict[bytes, str](), dict[str, int]()
    start, next_tick = time.monotonic(), 0.0

    def send(emission: Emission) -> None:
        if not senders.send(emission):
            totals.unsendable += 1
            return
        # A prediction converts the datagram, as the bridge does. Repeated datagrams are predicted once, unless the
        # second one is a replay.
        end = predictions.get(emission.datagram)
        if end is None:
            end = predict(emission.datagram, translator, world.longest)
            if world.keys is None and len(predictions) < 2 * _PREPARED:
                predictions[emission.datagram] = end
        totals.sent[end] += 1

    def wait_until(time_to_send: float) -> Iterator[float]:
        nonlocal next_tick
        while (now := time.monotonic() - start) < time_to_send or now >= next_tick:
            next_tick = now + _TICK_S
            totals.seconds = now
            for _ in range(len(asked) if world.requests else 0):
                if (answer := world.answer(asked.popleft(), now, lives)) is not None:
                    send(answer)
            yield now
            time.sleep(max(0.0, min(_TICK_S, time_to_send - (time.monotonic() - start))))

    for emission in stream:
        if emission.at >= length or totals.seconds >= length:
            return  # the second condition ends the run if this machine is too slow for the rate
        yield from wait_until(emission.at)
        totals.played = max(totals.played, emission.at)
        lives[emission.peer] = emission.life
        send(emission)
    for totals.played in wait_until(length):  # peers that only answer
        yield totals.played


def _watch_memory(host: BridgeHost, now: float, totals: RunTotals) -> None:
    if now >= len(totals.memory) + 1 and (size := resident_bytes(host.pid)) is not None:
        totals.memory.append(size)


def _wait_for(arrivals: Arrivals, totals: RunTotals) -> None:
    """Wait, at most 20 seconds, until the peers have received all datagrams of the bridge. Store their number."""
    account = totals.account
    out = sent_to_peers(account)
    deadline = time.monotonic() + _TIMEOUT_S
    while arrivals.count + arrivals.lost < out and time.monotonic() < deadline:
        time.sleep(_TICK_S)
    totals.arrived, totals.lost_at_peers = arrivals.count, arrivals.lost


def _report(totals: RunTotals, *, as_json: bool) -> int:
    faults = totals.faults()
    if as_json:
        print(json.dumps(totals.as_dict()))
    else:
        print("\n".join(totals.lines()))
        print(
            "No problems found: all counts add up." if not faults else "\n".join(f"error: {fault}" for fault in faults)
        )
    return FINDINGS if faults else OK
