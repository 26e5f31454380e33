"""Parameters of the node ``udp_forwarder``. The file `node_parameters.yaml` declares them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from roverlink.bounded_yaml import FAST_LOADER
from roverlink.runtime.core.errors import SetupError, nearest
from roverlink.runtime.core.registry import End, EndName, Registry
from roverlink.runtime.net.transports import transport_at
from roverlink.runtime.text.host_names import LEARN, hosts_in
from roverlink.transport_addresses import names_transport


@dataclass(frozen=True, slots=True)
class Declaration:
    """Declaration of one ROS 2 parameter of the node: its default, its description, and its allowed values."""

    default: int | str | bool
    description: str
    unit: str = ""
    """Unit of a parameter that is a number, such as ``bytes``."""
    minimum: int = 0
    """Smallest number, for a parameter that is a number."""
    maximum: int = 0
    """Largest number, for a parameter that is a number."""
    limits: str = ""
    """Error text for a number out of range; it tells the allowed range."""
    choices: tuple[str, ...] = ()
    """Allowed texts; empty if any text is allowed."""
    read_only: bool = False
    """True if the parameter cannot change while the node runs."""
    hosts: bool = False
    """True if the text is a host, several hosts with commas between them, or ``learn``."""
    of_end: bool = False
    """True if the hosts are those of one end alone, so that they may name another transport than UDP."""
    of_link: bool = False
    """True if only the nodes of tables with a link message have the parameter."""
    of_rover: bool = False
    """True if a bridge that is another end of the table (``roverlink run --as``) does not have the parameter."""

    def check(self, name: str, value: int | str | bool) -> None:
        """Raise `SetupError` if a value is not allowed for the parameter; ``name`` is the parameter's name."""
        if type(value) is not type(self.default):
            raise SetupError(f"the parameter {name!r} is {value!r}; it must be of type {type(self.default).__name__}")
        if self.choices and value not in self.choices:
            raise SetupError(f"the parameter {name!r} is {value!r}; it must be one of {', '.join(self.choices)}")
        if self.limits and not self.minimum <= int(value) <= self.maximum:
            raise SetupError(f"the parameter {name!r} is {value}; {self.limits}")
        if self.hosts:
            try:
                is_line = EndAddress(hosts_in(str(value)), 0).is_line
            except ValueError as error:
                raise SetupError(f"the parameter {name!r} is {value!r}; {error}") from error
            if is_line and not self.of_end:
                message = f"the parameter {name!r} is {value!r}, but several ends may have this host"
                raise SetupError(f"{message}; write `host: {value}` at one peer or board of the table")


_FILE = Path(__file__).with_name("node_parameters.yaml")
DECLARED: Mapping[str, Declaration] = {
    name: Declaration(**said)
    for name, said in yaml.load(_FILE.read_text(encoding="utf-8"), FAST_LOADER).items()  # noqa: S506  # a safe loader
}
"""Declarations of the parameters in `node_parameters.yaml`, by the name of the parameter."""
LISTEN_PORT = DECLARED["listen_port"].default
USE_SIM_TIME = "use_sim_time"
_OF_EVERY_NODE = {
    USE_SIM_TIME: Declaration(
        default=False, description="true if stamps are times of a simulation, from /clock", read_only=True
    )
}


class EndAddress(NamedTuple):
    """Hosts and UDP port of an end of the link, as its parameters set them."""

    hosts: tuple[str, ...]
    """IP addresses and names of hosts, or only the word ``learn``, or only the address of another transport."""
    port: int
    """UDP port; 0 if it is learned with the address."""

    @property
    def is_line(self) -> bool:
        """True if the end has another transport than UDP."""
        return any(map(names_transport, self.hosts))


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
    link_policy: str
    native_core: bool
    use_sim_time: bool
    addresses: Mapping[EndName, EndAddress]
    """Hosts and UDP port of each end of the link."""
    values: Mapping[str, Any]
    """Value of every parameter, by its ROS 2 name."""


def declarations(registry: Registry) -> dict[str, Declaration]:
    """Return the declaration of every parameter of the node, by the parameter's name.

    These are the parameters in `DECLARED`, the one that every ROS 2 node has, and parameters for the host and the UDP
    port of each end of the link, which the table names.
    """
    declared = _OF_EVERY_NODE | {
        name: parameter
        for name, parameter in DECLARED.items()
        if (registry.link is not None or not parameter.of_link) and (registry.own is None or not parameter.of_rover)
    }
    if registry.own is not None:
        declared["listen_port"] = replace(declared["listen_port"], default=registry.own.port)
        declared["dst_ip"] = replace(declared["dst_ip"], of_end=True)  # the rover is the only end
    if registry.link is not None:
        declared["link_policy"] = replace(declared["link_policy"], default=registry.link.on_mismatch)
    for name, end in registry.ends.items():
        declared |= _declarations_of(name, end)
    return declared


def _declarations_of(name: EndName, end: End) -> dict[str, Declaration]:
    what = f"the board {name}" if name.board else f"the peer {name}"
    port = replace(
        DECLARED["listen_port"],
        default=end.port,
        minimum=0 if end.host else 1,
        limits=f"a UDP port is a number from {'0 (learned with the address)' if end.host else 1} to 65535",
        read_only=False,
        description=f"UDP port of {what}" + ("; 0 learns it with the address" if end.host else ""),
    )
    if not end.host:
        return {end.port_parameter: port}
    host = replace(DECLARED["dst_ip"], default=end.host, of_end=True, description=f"host of {what}, {_SEVERAL}")
    return {end.host_parameter: host, end.port_parameter: port}


_SEVERAL = "several with commas between them, or learn: the source of its last valid datagram"


def defaults(registry: Registry) -> dict[str, Any]:
    """Return the default of every parameter, by the parameter's name."""
    return {name: declared.default for name, declared in declarations(registry).items()}


_UNUSED = frozenset({"start_type_description_service"})
"""Parameters that rclpy declares for every node, so that `ros2 param dump` writes them; this node does not use them."""


def read(registry: Registry, given: Mapping[str, Any]) -> Parameters:
    """Return the parameters: the given values, and the defaults of all others.

    Raises `SetupError` for an unknown name or a value that is not allowed.
    """
    return _checked(registry, {name: value for name, value in given.items() if name not in _UNUSED})


def changed(registry: Registry, parameters: Parameters, changes: Mapping[str, Any]) -> Parameters:
    """Return a copy of ``parameters`` with the new values in ``changes``, for a node that is running.

    Raises `SetupError` if one of the parameters is unknown or read-only, or if a value is wrong.
    """
    declared = declarations(registry)
    for name, value in changes.items():
        if name in declared and declared[name].read_only and value != parameters.values[name]:
            shown = str(value).lower() if isinstance(value, bool) else value
            raise SetupError(f"the parameter {name!r} is read-only; restart the node with -p {name}:={shown}")
    # `ros2 param load` sets all that `ros2 param dump` has written.
    own = {name: value for name, value in changes.items() if name not in _UNUSED}
    return _checked(registry, {**parameters.values, **own})


def _checked(registry: Registry, given: Mapping[str, Any]) -> Parameters:
    declared = declarations(registry)
    for parameter, value in given.items():
        if parameter not in declared:
            raise SetupError(f"unknown parameter {parameter!r}; {nearest(parameter, declared)}")
        declared[parameter].check(parameter, value)
    values = {**defaults(registry), **given}
    addresses = {
        name: EndAddress(hosts_in(values[end.host_parameter]), values[end.port_parameter])
        for name, end in registry.ends.items()
    }
    for name, end in registry.ends.items():
        if addresses[name].is_line:
            transport_at(*addresses[name].hosts)  # it says if a package is not installed
        elif not addresses[name].port and addresses[name].hosts != (LEARN,):
            message = f"the parameter {end.port_parameter!r} is 0, but {end.host_parameter!r} is not {LEARN!r}"
            raise SetupError(f"{message}; set the UDP port of {name}")
    own = {name: values.get(name, parameter.default) for name, parameter in {**DECLARED, **_OF_EVERY_NODE}.items()}
    return Parameters(addresses=addresses, values=values, **own)
