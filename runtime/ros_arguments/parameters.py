"""Parameters of the node ``udp_forwarder``. The file `node_parameters.yaml` declares them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from roverlink.runtime.core.errors import SetupError, nearest
from roverlink.runtime.core.registry import Registry
from roverlink.runtime.text import strict_yaml


@dataclass(frozen=True, slots=True)
class Declaration:
    """Declaration of a parameter that does not depend on the table."""

    default: int | str
    description: str
    unit: str = ""
    minimum: int = 0
    maximum: int = 0
    """Largest number, for a parameter that is a number."""
    limits: str = ""
    """Error text for a number out of range; it tells the allowed range."""
    choices: tuple[str, ...] = ()
    """Allowed texts; empty if any text is allowed."""

    def check(self, name: str, value: int | str) -> None:
        """Raise `SetupError` if a value is not allowed for the parameter; ``name`` is the parameter's name."""
        if self.choices and value not in self.choices:
            raise SetupError(f"the parameter {name!r} is {value!r}; it must be one of {', '.join(self.choices)}")
        if self.limits and not self.minimum <= int(value) <= self.maximum:
            raise SetupError(f"the parameter {name!r} is {value}; {self.limits}")


_FILE = Path(__file__).with_name("node_parameters.yaml")
DECLARED: Mapping[str, Declaration] = {
    name: Declaration(**said) for name, said in strict_yaml.load(_FILE.read_text(encoding="utf-8")).items()
}
"""Declarations of parameters, by the name of the parameter."""
LISTEN_PORT = DECLARED["listen_port"].default


@dataclass(frozen=True, slots=True)
class Parameters:
    """Values of the node's parameters. Each declared parameter is an attribute of the same name."""

    listen_port: int
    listen_address: str
    dst_ip: str
    forward_policy: str
    source_policy: str
    max_datagram: int
    receive_buffer: int
    peer_ports: Mapping[str, int]
    """UDP port of each peer, by the peer's name."""
    values: Mapping[str, Any]
    """Every parameter by its ROS 2 name."""


def defaults(registry: Registry) -> dict[str, Any]:
    """Return the default of every parameter, by name.

    Besides the declared parameters there is one parameter for the UDP port of each peer; the table gives its name.
    """
    ports = {peer.port_parameter: peer.port for peer in registry.peers}
    return {name: declared.default for name, declared in DECLARED.items()} | ports


def read(registry: Registry, given: Mapping[str, Any]) -> Parameters:
    """Return the parameters: the given values, and the defaults of all others.

    Raises `SetupError` for an unknown name or a value that is not allowed.
    """
    values = defaults(registry)
    for name, value in given.items():
        if name == "use_sim_time":  # rclcpp and rclpy declare it for every node; this node does not use it
            continue
        if name not in values:
            raise SetupError(f"unknown parameter {name!r}; {nearest(name, values)}")
        if type(value) is not type(values[name]):
            raise SetupError(f"the parameter {name!r} is {value!r}; it must be of type {type(values[name]).__name__}")
        values[name] = value
    for name, declared in DECLARED.items():
        declared.check(name, values[name])
    ports = {peer.name: _port(peer.port_parameter, values[peer.port_parameter]) for peer in registry.peers}
    return Parameters(peer_ports=ports, values=values, **{name: values[name] for name in DECLARED})


def _port(name: str, value: int) -> int:
    if not 1 <= value <= DECLARED["listen_port"].maximum:
        raise SetupError(f"the parameter {name!r} is {value}; {DECLARED['listen_port'].limits}")
    return value
