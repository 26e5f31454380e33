"""Registry of the handlers and peers that the generated code creates from the table (mapping.yaml)."""

from __future__ import annotations

import importlib
import itertools
import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from google.protobuf.message import EncodeError

from roverlink.runtime.core.errors import ConversionError, RegistryError, SetupError, nearest
from roverlink.runtime.core.handler import BoardStamp, Handler, Route
from roverlink.runtime.core.messages import fields_of
from roverlink.runtime.core.standard_handler import StandardHandler

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage

AnyHandler = Handler[Any, Any]
AnyStandardHandler = StandardHandler[Any, Any]


class EndName(NamedTuple):
    """Name of an end of the link: a peer, or a board of a peer that has ``boards`` in the table."""

    peer: str
    board: str = ""
    """Empty if the end is the whole peer."""

    def __str__(self) -> str:
        return f"{self.board} of {self.peer}" if self.board else self.peer


@dataclass(frozen=True, slots=True)
class End:
    """End of the link, to which datagrams are sent: a peer, or one of its boards."""

    name: str
    """Name of the peer or of the board."""
    port_parameter: str = ""
    """Name of the ROS 2 node parameter that sets the end's UDP port; empty for a peer with boards."""
    port: int = 0
    """UDP port to which the end's datagrams are sent, if the parameter is not given.

    It is 0 for an end whose port is learned with its address.
    """
    host: str = ""
    """Hosts to which the end's datagrams are sent, if `host_parameter` is not given: names or addresses with commas
    between them, or ``learn``. Empty if the table names none.
    """
    host_parameter: str = "dst_ip"
    """Name of the ROS 2 node parameter that sets the end's hosts."""
    interface: str = ""
    """Network interface through which datagrams leave, if the host is a multicast group; empty for the kernel's choice.
    """
    ttl: int = 1
    """Largest number of networks that datagrams cross, if the host is a multicast group."""


@dataclass(frozen=True, slots=True)
class Peer(End):
    """Peer: the other end of a UDP link to the rover's computer, such as ``hardware`` or ``basestation``."""

    strip_trailing_zeros: bool = False
    """True if datagrams to this peer are sent without their trailing zero bytes."""
    sources: tuple[str, ...] = ()
    """IP addresses and networks from which the peer may send; empty if any address may send."""
    source_rate: int | None = None
    """Largest number of datagrams a second accepted from each address of the peer; None for no limit."""
    max_size: int | None = None
    """Largest envelope in bytes that the peer can receive; None if the table sets no limit."""
    budget: int | None = None
    """Most bytes that are sent to the peer in a second, with the headers of IP and UDP; None for no limit."""
    must_sign: bool = False
    """True if datagrams from and to the peer must be signed."""
    boards: tuple[End, ...] = ()
    """Boards of the peer that have addresses of their own; empty if the peer is one end."""


@dataclass(frozen=True, slots=True)
class Link:
    """Link message: a member of the envelope by which two ends compare their schemas and measure the link."""

    number: int
    """Field number of the link message in the envelope."""
    on_mismatch: str
    """Default of the parameter ``link_policy``: ``warn`` or ``refuse``."""
    hashes: Mapping[int, int]
    """Hash (32 bits) of the wire schema of each row's payload, by the payload's number."""


class OwnEnd(NamedTuple):
    """End of the table that a bridge with a mirrored registry is (`mirror.mirrored`)."""

    name: EndName
    port: int
    """UDP port on which it listens, if the parameter is not given; 0 for any free port, which the rover learns."""
    left_out: tuple[str, ...]
    """Names of the rows of other ends, which the mirrored registry does not have."""


@dataclass(frozen=True)
class Registry:
    """All handlers of a table, with the class of the envelope that carries their payloads."""

    package: str
    """Name of the ROS 2 package."""
    envelope: type[ProtoMessage]
    oneof: str
    """Name of the envelope's oneof that contains the payload."""
    peers: tuple[Peer, ...]
    handlers: tuple[AnyHandler, ...]
    """Handlers of rows, one for each row."""
    fingerprint: str
    """SHA-256 of the table and the wire schema from which the code was generated."""
    extra_topics: tuple[AnyStandardHandler, ...] = ()
    """Handlers of extra topics: topics with a standard ROS 2 message, which rows list under ``also``."""
    retired: Mapping[int, str] = field(default_factory=dict)
    """Payload numbers that are never used again, each with the name of its former payload."""
    signature: int | None = None
    """Field number of the signature in the envelope; None if the envelope has none."""
    link: Link | None = None
    """Link message; None if the table has none."""
    sources: Mapping[str, str] = field(default_factory=dict)
    """Digest of the table and of each .proto file from which the code was generated, by the path relative to the table.
    """
    own: OwnEnd | None = None
    """End of the table that this bridge is; None for the bridge of the table itself, on the rover."""

    @cached_property
    def by_number(self) -> dict[int, AnyHandler]:
        """Handlers of rows, by the payload's field number in the envelope."""
        return {handler.route.number: handler for handler in self.handlers}

    @cached_property
    def by_name(self) -> dict[str, AnyHandler]:
        """Handlers of rows, by the payload's field name in the envelope's oneof, such as ``imu_info``."""
        return {handler.route.name: handler for handler in self.handlers}

    @cached_property
    def by_topic(self) -> dict[str, AnyHandler]:
        """Handlers of rows and of extra topics, by the name of the topic in the table."""
        return {handler.route.topic: handler for handler in (*self.handlers, *self.extra_topics)}

    @cached_property
    def board_stamps(self) -> dict[str, BoardStamp]:
        """Field with the clock of the board in the payloads of each row that has one, by the row's name."""
        handlers = (*self.handlers, *self.extra_topics)
        return {one.route.name: one.board_stamp for one in handlers if one.board_stamp is not None}

    @cached_property
    def peers_by_name(self) -> dict[str, Peer]:
        """Peers by name."""
        return {peer.name: peer for peer in self.peers}

    def peer(self, name: str) -> Peer:
        """Return the peer of a name. Raises `SetupError` if the table has none."""
        if name not in self.peers_by_name:
            raise SetupError(f"unknown peer {name!r}; {nearest(name, self.peers_by_name)}")
        return self.peers_by_name[name]

    @cached_property
    def ends(self) -> dict[EndName, End]:
        """Ends of the link: each board of a peer that has boards, and each other peer."""
        return {
            EndName(peer.name, "" if end is peer else end.name): end
            for peer in self.peers
            for end in peer.boards or (peer,)
        }

    def boards_of(self, peer: str) -> list[str]:
        """Return the names of a peer's boards, sorted: those that have addresses, and those that rows belong to."""
        with_rows = {handler.route.board for handler in self.handlers if handler.route.peer == peer}
        return sorted(({board for name, board in self.ends if name == peer} | with_rows) - {""})

    def end_of(self, route: Route) -> EndName:
        """Return the name of the end to which a row belongs. A row that a board sends may belong to none in `ends`."""
        return EndName(route.peer, route.board if self.peers_by_name[route.peer].boards else "")

    def row(self, name: str, fields: Sequence[str], *, inbound: bool) -> AnyHandler | AnyStandardHandler:
        """Return the row (or extra topic) of a name whose ROS 2 message has some fields.

        ``inbound`` selects the direction from a peer. Raises `SetupError` if the table has no such row.
        """
        rows = (*self.handlers, *self.extra_topics)
        handler = next((row for row in rows if row.route.name == name and row.route.inbound == inbound), None)
        if handler is None:
            direction = "from a peer" if inbound else "to a peer"
            raise SetupError(f"the table has no row {name!r} in the direction {direction}; add it to mapping.yaml")
        message = handler.message_type
        if missing := [field for field in fields if field not in {declared.name for declared in fields_of(message)}]:
            raise SetupError(
                f"{message.__msgtype__}, the message of row {name!r}, has no field {', '.join(missing)}; add it"
            )
        return handler

    def datagram(self, name: str, payload: ProtoMessage) -> bytes:
        """Return the serialized envelope that carries a payload of the row ``name``.

        Raises `ConversionError` if a field that proto2 requires is not set.
        """
        try:
            return self.envelope(**{name: payload}).SerializeToString()
        except EncodeError as error:  # a `required` field of proto2 that nothing has set
            raise ConversionError(f"{name}: {error}") from error


def load_registry(project: str | Path | None = None, package: str = "generated") -> Registry:
    """Import the generated registry of handlers and peers, and check that it matches the loaded protobuf descriptors.

    ``project`` is the folder of the table. Without ``project``, the generated package is found on the import path.
    ``package`` is the import name of the generated package (key ``python.package`` of the table).

    Raises `RegistryError` in these cases:
    - There is no generated code, or it cannot be imported.
    - A package of the same name from another project is loaded already. Two projects in one process need two names.
    - A loaded descriptor differs from the descriptor from which the code was generated.
    """
    if project is not None:
        _put_first(Path(project).resolve(), package)
    try:
        registry = importlib.import_module(f"{package}.registry").REGISTRY
        check: Callable[[], None] = importlib.import_module(f"{package}.checks").check
    except Exception as error:  # the code may be edited, or of another version, so that anything may be raised
        if isinstance(error, ModuleNotFoundError) and _concerns(str(error.name), package):
            if project is not None:
                raise RegistryError(f"no generated code in {project} ({error}); run `roverlink generate`") from error
            help = "give the folder of mapping.yaml, load_registry(folder), and run `roverlink generate` there"
            raise RegistryError(f"no generated code in the import path ({error}); {help}") from error
        raise RegistryError(
            f"the generated code cannot be imported: {_place(error, package)}{type(error).__name__}: {error}; "
            "run `roverlink generate`"
        ) from error
    if not isinstance(registry, Registry):
        raise RegistryError(f"{package}.registry.REGISTRY is not a Registry; run `roverlink generate`")
    check()
    return registry


def _place(error: Exception, package: str) -> str:
    """Return the file and the line of the package that raised an error, such as ``/rover/generated/registry.py:7: ``.

    The place is empty if no line of the package was running: a `SyntaxError` names its place itself.
    """
    folder = f"/{package.replace('.', '/')}/"
    lines = [frame for frame in traceback.extract_tb(error.__traceback__) if folder in Path(frame.filename).as_posix()]
    return f"{lines[-1].filename}:{lines[-1].lineno}: " if lines and not isinstance(error, SyntaxError) else ""


def _concerns(module: str, package: str) -> bool:
    """Return true if ``module`` is the package, a part of it, or a package that contains it; all are dotted names.

    A `ModuleNotFoundError` for such a module means that there is no generated code.
    """
    return f"{package}.".startswith(f"{module}.") or module.startswith(f"{package}.")


def _put_first(project: Path, package: str) -> None:
    """Put the project's folder first on the import path, so that the project's own generated code is imported.

    Raises `RegistryError` if the folder has no generated code, or if that of another project is loaded already.
    """
    if not (project.joinpath(*package.split(".")) / "registry.py").is_file():
        raise RegistryError(f"no generated code in {project}; run `roverlink generate` there")
    folder = project
    for name in itertools.accumulate(package.split("."), "{}.{}".format):
        folder /= name.rpartition(".")[2]
        loaded = [Path(path).resolve() for path in getattr(sys.modules.get(name), "__path__", [folder])]
        # Python keeps modules by name. A second project with the same package name would silently get the first one's
        # code.
        if folder not in loaded:
            what = "generated code" if name == package else f"package {name}"
            where = ", ".join(map(str, loaded))
            raise RegistryError(
                f"the {what} of another project is loaded already: {where}; a process can load only one"
            )
    if str(project) not in sys.path:
        sys.path.insert(0, str(project))
