"""Print the envelopes that arrive at a UDP port, each as one line of JSON.

Print the envelopes that arrive at a UDP port. Use it in place of a board or a basestation, to see what the
bridge sends to this peer. An envelope is the protobuf message that holds one payload in a oneof.

Each datagram gives one line of JSON:
{"from": "127.0.0.1:5000", "number": 9, "name": "drive_motor", "payload": {"distance_to_go": 1.5}}.
A datagram that cannot be decoded gives a line with the keys "error" and "bytes" (its size).

Example: roverlink listen --port 6001
"""

from __future__ import annotations

import argparse
import contextlib
import json
import select
import socket
import time
from typing import Any

from roverlink.console import (
    FINDINGS,
    OK,
    Subparsers,
    add_project,
    count,
    documented_command,
    port,
    print_note,
    project_folder,
    seconds,
)
from roverlink.generated_code import load_project
from roverlink.numerals import counted
from roverlink.runtime import DatagramError, Registry, SetupError, Translator
from roverlink.runtime.core.envelope import payload_numbers, restore
from roverlink.runtime.net import udp
from roverlink.runtime.net.carrier import line_at
from roverlink.runtime.text.values import payload_to_values
from roverlink.transport_addresses import names_transport

_RECEIVE_BUFFER = 1024 * 1024
_EVERY_ADDRESS = "0.0.0.0"  # noqa: S104  # boards are other machines, so loopback is not enough


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    add_project(parser)
    parser.add_argument("--port", type=port, help="UDP port to listen on, such as that of a peer in mapping.yaml")
    parser.add_argument(
        "--address",
        default=_EVERY_ADDRESS,
        help="IPv4 address of this machine to listen on (default: all its addresses), or a line, which needs no "
        "--port: serial:/dev/ttyACM0, tcp:0.0.0.0:7000?listen",
    )
    parser.add_argument("--count", type=count, metavar="N", help="stop after N datagrams")
    parser.add_argument("--timeout", type=seconds, metavar="S", help="stop after S seconds, with exit code 1")
    parser.set_defaults(run=run, runs_until_stopped=True)


def run(arguments: argparse.Namespace) -> int:
    """Print the envelopes that arrive until Ctrl-C, or until ``--count`` datagrams have come; the exit code is then 0.

    If the time ``--timeout`` ends before, the exit code is 1.
    """
    registry = load_project(project_folder(arguments.project))
    translator = Translator(registry)
    seen = 0
    with contextlib.ExitStack() as stack:
        sock, source = _opened(arguments.address, arguments.port, stack)
        deadline = None if arguments.timeout is None else time.monotonic() + arguments.timeout
        while arguments.count is None or seen < arguments.count:
            wait = None if deadline is None else max(0.0, deadline - time.monotonic())
            if not select.select([sock], [], [], wait)[0]:
                print_note(f"stopped after {arguments.timeout} s: only {counted(seen, 'datagram')} came")
                return FINDINGS
            datagram, (host, port) = sock.recvfrom(udp.LARGEST)
            print(json.dumps({"from": source or f"{host}:{port}", **_line(registry, translator, datagram)}), flush=True)
            seen += 1
    return OK


def _opened(address: str, port: int | None, stack: contextlib.ExitStack) -> tuple[socket.socket, str]:
    """Return the socket at which datagrams arrive, and the line over which they come; empty if there is none."""
    if names_transport(address):
        line = line_at(address, lambda why: print_note(f"{address}: {why or 'there is a connection'}"))
        return stack.enter_context(line)[0], address
    if port is None:
        raise SetupError("give the UDP port with --port, or a line with --address, such as serial:/dev/ttyACM0")
    sock = stack.enter_context(udp.bind(address, port, _RECEIVE_BUFFER))
    print_note(f"listening on UDP port {sock.getsockname()[1]}")
    return sock, ""


def _line(registry: Registry, translator: Translator, datagram: bytes) -> dict[str, Any]:
    try:
        envelope = translator.parse(datagram)
    except DatagramError as error:
        return {"error": str(error), "bytes": len(datagram)}
    name = envelope.WhichOneof(registry.oneof)
    if name is None:
        numbers = payload_numbers(restore(datagram))
        return {"error": f"unknown payload numbers {numbers}" if numbers else "empty", "bytes": len(datagram)}
    number = envelope.DESCRIPTOR.fields_by_name[name].number
    return {"number": number, "name": name, "payload": payload_to_values(getattr(envelope, name))}
