"""Send a datagram with one payload to the bridge, as a board does.

Send a datagram to the bridge, as a board or the basestation does, to test the bridge without a board. The
datagram is an envelope: the protobuf message that holds one payload in a oneof. Write nested fields with
dots (imu_sensor.accel_x=1), enum values by name, lists as [1, 2, 3], and bytes in hexadecimal.
`roverlink echo TOPIC` shows the message that the bridge makes of it.

Example: roverlink send imu_info accel_x=0.12 accel_y=-9.81 --to 127.0.0.1:5000 --count 10 --rate 100
"""

from __future__ import annotations

import argparse
import time

from roverlink.completion import complete, rows
from roverlink.console import (
    OK,
    Subparsers,
    add_destination,
    add_key_file,
    add_project,
    count,
    documented_command,
    project_folder,
    rate,
)
from roverlink.generated_code import load_project
from roverlink.numerals import counted
from roverlink.runtime import ConversionError, Registry, SetupError
from roverlink.runtime.client import BlockingPeer
from roverlink.runtime.core.errors import nearest
from roverlink.runtime.core.registry import AnyHandler
from roverlink.runtime.net import udp
from roverlink.runtime.text.assignments import payload_from_assignments
from roverlink.transport_addresses import names_transport


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    add_project(parser)
    name = parser.add_argument("name", nargs="?", help="name of the payload's row in mapping.yaml, such as imu_info")
    complete(name, rows)
    parser.add_argument(
        "assignments",
        nargs="*",
        metavar="field=value",
        help="a field of the payload and its value; all other fields are zero",
    )
    add_destination(parser)
    parser.add_argument(
        "--count", type=count, default=1, metavar="N", help="number of datagrams to send (default: %(default)s)"
    )
    parser.add_argument(
        "--rate", type=rate, default=10.0, metavar="HZ", help="number of datagrams a second (default: %(default)s)"
    )
    add_key_file(parser, "key file that signs the datagram, if the table says that the peer must sign")
    parser.add_argument("--list", action="store_true", help="list all payloads with their fields; send nothing")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Send the datagram as often as ``--count`` says, or list the payloads of the table (``--list``)."""
    registry = load_project(project_folder(arguments.project))
    if arguments.list:
        _list(registry)
        return OK
    handler = _handler(registry, arguments.name)
    payload = payload_from_assignments(handler.payload_type, _assignments(arguments.assignments))
    try:
        datagram = registry.datagram(handler.route.name, payload)
    except ConversionError as error:
        raise SetupError(f"cannot send {error}") from error
    host, port = (arguments.to, 0) if names_transport(arguments.to) else udp.destination_of(arguments.to)
    # Payloads of the other direction can be sent too, to test what the bridge does with them.
    name, keys = handler.route.peer, arguments.key_file
    with BlockingPeer.open(
        name, registry=registry, host=host, port=port, local_port=0, key_files=keys, link=False
    ) as peer:
        _send(datagram, peer, arguments.count, arguments.rate)
    print(f"sent {arguments.count} x {handler.route.name} ({counted(len(datagram), 'byte')}) to {arguments.to}")
    return OK


def _handler(registry: Registry, name: str | None) -> AnyHandler:
    if name is None:
        raise SetupError("no payload is given; `roverlink send --list` lists all payloads")
    handler = registry.by_name.get(name)
    if handler is None:
        raise SetupError(f"unknown payload {name!r}; {nearest(name, registry.by_name)}")
    return handler


def _assignments(texts: list[str]) -> dict[str, str]:
    found: dict[str, str] = {}
    for text in texts:
        path, separator, value = text.partition("=")
        if not separator or not path:
            raise SetupError(f"{text!r} is not of the form field=value")
        if path in found:
            raise SetupError(f"the field {path!r} is assigned more than once")
        found[path] = value
    return found


def _send(datagram: bytes, peer: BlockingPeer, count: int, rate: float) -> None:
    start = time.monotonic()
    for index in range(count):
        time.sleep(max(0.0, start + index / rate - time.monotonic()))
        try:
            peer.send_datagram(datagram)
        except OSError as error:
            raise SetupError(f"cannot send to {peer.remote}: {error.strerror}") from error


def _list(registry: Registry) -> None:
    for handler in registry.handlers:
        route = handler.route
        print(f"{route.number:>3} {route.name:<24} {route.direction:<20} {handler.payload_type.DESCRIPTOR.full_name}")
        for field in handler.payload_type.DESCRIPTOR.fields:
            named = field.enum_type or field.message_type
            choices = f" ({', '.join(field.enum_type.values_by_name)})" if field.enum_type else ""
            kind = "" if named is None or choices else f" ({named.full_name})"
            print(f"      {field.name}{choices}{kind}")
