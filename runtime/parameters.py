"""The parameters of the node ``udp_forwarder``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from runtime.errors import SetupError, nearest
from runtime.registry import Registry

LISTEN_PORT = 5000
FORWARD_POLICIES = ("mapping", "all")
SOURCE_POLICIES = ("mapping", "any")
_PORTS = range(1, 65_536)
_LARGEST_BUFFER = 2**30  # the kernel doubles it, in an int


@dataclass(frozen=True, slots=True)
class Parameters:
    """What can be set on the node; the ports of the peers are named by the table."""

    listen_port: int
    """UDP port for the datagrams of all peers; 0 takes a free one."""
    listen_address: str
    """Address of the interface to listen on."""
    dst_ip: str
    """Address or name of the host that has the peers' ports."""
    peer_ports: Mapping[str, int]
    """UDP port of each peer, by the peer's name."""
    forward_policy: str
    """``mapping``: each row's ``forward``; ``all``: every received datagram goes raw to every peer."""
    source_policy: str
    """``mapping``: who may speak as the peers' ``sources`` and ``source_rate`` say; ``any``: everybody, at any rate."""
    max_datagram: int
    """Longest datagram in bytes that is taken; what fits an Ethernet frame by default."""
    receive_buffer: int
    """Bytes that the kernel may hold until we read them."""
    values: Mapping[str, Any]
    """Every parameter by its ROS 2 name."""


def defaults(registry: Registry) -> dict[str, Any]:
    """Every parameter's name and default, in the order in which they are documented."""
    ports = {peer.port_parameter: peer.port for peer in registry.peers}
    return {
        "listen_port": LISTEN_PORT,
        "listen_address": "0.0.0.0",  # noqa: S104  # boards are other machines
        "dst_ip": "127.0.0.1",
        **ports,
        "forward_policy": "mapping",
        "source_policy": "mapping",
        "max_datagram": 1472,
        "receive_buffer": 4 * 1024 * 1024,
    }


def read(registry: Registry, given: Mapping[str, Any]) -> Parameters:
    """The parameters of a run. Raises `SetupError` for a name or a value that cannot be."""
    values = defaults(registry)
    for name, value in given.items():
        if name == "use_sim_time":  # every ROS 2 node has it; nothing here depends on time
            continue
        if name not in values:
            raise SetupError(f"no parameter {name!r}; {nearest(name, values)}")
        if type(value) is not type(values[name]):
            raise SetupError(f"parameter {name} is {value!r}; it must be of type {type(values[name]).__name__}")
        values[name] = value
    ports = {peer.name: _port(peer.port_parameter, values[peer.port_parameter]) for peer in registry.peers}
    own = {
        name: value for name, value in values.items() if name not in {peer.port_parameter for peer in registry.peers}
    }
    parameters = Parameters(peer_ports=ports, values=values, **own)
    _check(parameters)
    return parameters


def _port(name: str, value: int) -> int:
    if value not in _PORTS:
        raise SetupError(f"parameter {name} is {value}; a UDP port is a number from 1 to 65535")
    return value


def _choice(name: str, value: str, choices: tuple[str, ...]) -> None:
    if value not in choices:
        raise SetupError(f"parameter {name} is {value!r}; it is one of {', '.join(choices)}")


def _check(parameters: Parameters) -> None:
    if parameters.listen_port != 0:
        _port("listen_port", parameters.listen_port)
    _choice("forward_policy", parameters.forward_policy, FORWARD_POLICIES)
    _choice("source_policy", parameters.source_policy, SOURCE_POLICIES)
    if not 1 <= parameters.max_datagram <= 65_507:
        raise SetupError(f"parameter max_datagram is {parameters.max_datagram}; a UDP datagram has 1 to 65507 bytes")
    if not 1 <= parameters.receive_buffer <= _LARGEST_BUFFER:
        raise SetupError(
            f"parameter receive_buffer is {parameters.receive_buffer}; it is a number of bytes up to {_LARGEST_BUFFER}"
        )
