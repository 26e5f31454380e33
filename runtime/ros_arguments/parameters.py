"""The parameters of the node ``udp_forwarder``, as `node_parameters.yaml` declares them."""

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
    """A parameter that the node has whatever the table says."""

    default: int | str
    description: str
    unit: str = ""
    minimum: int = 0
    maximum: int = 0
    """The largest number, of a parameter that is one."""
    limits: str = ""
    """What a number must be, for the error that says that it is not."""
    choices: tuple[str, ...] = ()
    """Every text that it can be; empty for any."""

    def check(self, name: str, value: int | str) -> None:
        """Raise `SetupError` for a value that the parameter cannot have."""
        if self.choices and value not in self.choices:
            raise SetupError(f"parameter {name} is {value!r}; it is one of {', '.join(self.choices)}")
        if self.limits and not self.minimum <= int(value) <= self.maximum:
            raise SetupError(f"parameter {name} is {value}; {self.limits}")


_FILE = Path(__file__).with_name("node_parameters.yaml")
DECLARED: Mapping[str, Declaration] = {
    name: Declaration(**said) for name, said in strict_yaml.load(_FILE.read_text(encoding="utf-8")).items()
}
"""The declarations, by name."""
LISTEN_PORT = DECLARED["listen_port"].default


@dataclass(frozen=True, slots=True)
class Parameters:
    """The parameters of a run; those that are declared have their names."""

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
    """Return every parameter's name and default; the table names those that hold the peers' ports."""
    ports = {peer.port_parameter: peer.port for peer in registry.peers}
    return {name: declared.default for name, declared in DECLARED.items()} | ports


def read(registry: Registry, given: Mapping[str, Any]) -> Parameters:
    """Return the parameters of a run. Raises `SetupError` for a name or a value that cannot be."""
    values = defaults(registry)
    for name, value in given.items():
        if name == "use_sim_time":  # every ROS 2 node has it; nothing here depends on time
            continue
        if name not in values:
            raise SetupError(f"no parameter {name!r}; {nearest(name, values)}")
        if type(value) is not type(values[name]):
            raise SetupError(f"parameter {name} is {value!r}; it must be of type {type(values[name]).__name__}")
        values[name] = value
    for name, declared in DECLARED.items():
        declared.check(name, values[name])
    ports = {peer.name: _port(peer.port_parameter, values[peer.port_parameter]) for peer in registry.peers}
    return Parameters(peer_ports=ports, values=values, **{name: values[name] for name in DECLARED})


def _port(name: str, value: int) -> int:
    if not 1 <= value <= DECLARED["listen_port"].maximum:
        raise SetupError(f"parameter {name} is {value}; {DECLARED['listen_port'].limits}")
    return value
