"""Rules about the peers and boards of the table: their names, addresses and parameters."""

from __future__ import annotations

from collections.abc import Iterator
from ipaddress import ip_address

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.rules import LintRule
from roverlink.generator.node_parameters import node_parameters
from roverlink.generator.table import LEARN, EndSettings, Row
from roverlink.suggestions import nearest
from roverlink.transport_addresses import can_id, names_transport, transport_address


class UnknownPeer(LintRule, id="TAB103"):
    """A row names an unknown peer or direction, or forwards datagrams to a wrong peer.

    `direction` is `<peer>_to_ros` or `ros_to_<peer>`. `direction` and `forward` must name a peer under `peers`, because
    the bridge has no address for others. A row that forwards to its own peer would send every datagram back to its
    sender.

    Bad::

        peers:
          hardware: {}
        messages:
          - {number: 16, name: mode, proto: ControlMode, topic: mode, direction: basestation_to_ros}

    Good::

        peers:
          hardware: {}
          basestation: {}
        messages:
          - {number: 16, name: mode, proto: ControlMode, topic: mode, direction: basestation_to_ros}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each row whose `direction` or `forward` is wrong."""
        table = context.table
        peers = sorted(peer.name for peer in table.peers)
        for row in table.rows:
            for key, message, help, also in _faults(row, peers, table.whole):
                yield cls.of_row(table, row, key, message, help, also)


_Fault = tuple[str, str, str, list[tuple[Span, str]]]  # the row's key, the message, the help, related places


def _faults(row: Row, peers: list[str], whole: bool) -> Iterator[_Fault]:
    """Yield what is wrong with a row's `direction` and `forward`.

    ``whole`` is false if parts of the table could not be read. Then unknown peers are not reported.
    """
    malformed = row.direction not in _directions(row.peer)
    if row.direction and (malformed or (whole and row.peer not in peers)):
        yield _unknown_direction(row, peers, malformed)
    if whole:
        yield from _unknown_targets(row, peers)
        if not malformed:
            yield from _misdirected(row)


def _directions(peer: str) -> tuple[str, str]:
    return f"{peer}_to_ros", f"ros_to_{peer}"


def _unknown_direction(row: Row, peers: list[str], malformed: bool) -> _Fault:
    known = [direction for peer in peers for direction in _directions(peer)]
    message = f"unknown direction {row.direction!r} (known: {', '.join(known) or 'none'})"
    if malformed:
        return "direction", message, nearest(row.direction, known, "write `<peer>_to_ros` or `ros_to_<peer>`"), []
    other = f"{'write a known direction, or ' if peers else ''}add the peer {row.peer!r} under `peers`"
    similar = nearest(row.peer, peers, "") and nearest(row.direction, known, "")
    return "direction", message, similar or other, []


def _unknown_targets(row: Row, peers: list[str]) -> Iterator[_Fault]:
    for target in row.forward:
        if target not in peers:
            message = f"unknown peer {target!r} (known: {', '.join(peers) or 'none'})"
            yield f"forward.{target}", message, nearest(target, peers, f"add the peer {target!r} under `peers`"), []


def _misdirected(row: Row) -> Iterator[_Fault]:
    if row.forward and not row.inbound:
        message = f"the direction of {row.name!r} is {row.direction!r}, but `forward` is for datagrams from a peer"
        help = f"write `direction: {row.peer}_to_ros`, or remove `forward`"
        yield "direction", message, help, [(row.at("forward"), "forwarded here")]
    elif row.peer in row.forward:
        message = f"{row.name!r} comes from the peer {row.peer!r}, and `forward` would send it back there"
        yield f"forward.{row.peer}", message, "name another peer under `forward`", []


class PeerParameterTaken(LintRule, id="TAB104"):
    """Two peers have the same parameter, or a peer uses a parameter of the node itself.

    The parameters are ROS 2 parameters of the bridge's node, and set the host and the UDP port of a peer or of its
    board. A shared parameter would change both, or another setting of the node.

    Bad::

        peers:
          hardware: {parameter: dst_port}
          basestation: {parameter: dst_port}

    Good::

        peers:
          hardware: {parameter: dst_b_port}
          basestation: {parameter: dst_a_port}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each parameter of a peer that belongs to another peer or to the node."""
        seen: dict[str, tuple[str, EndSettings]] = {}
        of_the_node = {"use_sim_time", *node_parameters()}
        for peer in context.table.peers:
            for settings, end in peer.ends:
                owner = f"the board {end.name!r} of {peer.name!r}" if peer.boards else f"the peer {peer.name!r}"
                for parameter in filter(None, (end.host_parameter, end.parameter)):
                    first, place = seen.setdefault(parameter, (owner, settings))
                    if place is not settings:
                        message = f"the parameter {parameter!r} of {owner} already belongs to {first}"
                        help = "give each peer its own `parameter`"
                    elif parameter in of_the_node:
                        message = f"the parameter {parameter!r} of {owner} is already a parameter of the node itself"
                        help = f"write `parameter: dst_{peer.name}_port`"
                    else:
                        continue
                    if peer.boards or parameter == end.host_parameter:  # the table cannot set these
                        help = "choose another name for the peer or the board"
                    yield cls.at(settings.at("parameter"), message, help)


class DirectionContradictsPrefix(LintRule, id="TAB105"):
    """A row's direction names one peer, but its message's name belongs to another peer.

    The key `prefixes` of a peer lists the beginnings of its messages' names. A row that expects a board's message from
    the basestation is probably a mistake: the payload would never arrive, and there would be no error.

    Bad::

        peers:
          hardware: {prefixes: [SensorBoard, ArmBoard]}
          basestation: {prefixes: [Basestation]}
        messages:
          - {number: 12, name: gps, proto: SensorBoardGPSInfo, topic: gps_data, direction: basestation_to_ros}

    Good::

        messages:
          - {number: 12, name: gps, proto: SensorBoardGPSInfo, topic: gps_data, direction: hardware_to_ros}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each row whose message's name begins with the prefix of another peer."""
        table = context.table
        if not table.whole:
            return  # the prefix may be in a part that could not be read
        peers = table.peers_by_name()
        for row in table.rows:
            own = peers.get(row.peer)
            if own is None or not own.prefixes or own.prefix_of(row.proto):
                continue  # a peer without prefixes accepts any message
            for other in table.peers:
                if prefix := other.prefix_of(row.proto):
                    prefixed = f"{row.proto!r} has the prefix of the peer {other.name!r}"
                    message = f"{row.name!r} has direction {row.direction!r}, but {prefixed}"
                    direction = f"{other.name}_to_ros" if row.inbound else f"ros_to_{other.name}"
                    help = f"write `direction: {direction}`, or add the prefix to `prefixes` of the peer {own.name!r}"
                    also = [(other.at(f"prefixes.{prefix}"), f"the peer {other.name!r} has the prefix {prefix!r}")]
                    yield cls.of_row(table, row, "direction", message, help, also)
                    break


class AddressTaken(LintRule, id="TAB114"):
    """Two peers, or two boards, have the same address and UDP port.

    The address tells the bridge to whom a datagram goes. If two ends of the link share it, one program gets the
    datagrams of both, and the other gets none. Peers without a `host` all have the address in the parameter `dst_ip`.

    Bad::

        peers:
          hardware: {host: 192.168.0.21, port: 8}
          basestation: {host: 192.168.0.21, port: 8}

    Good::

        peers:
          hardware: {host: 192.168.0.21, port: 8}
          basestation: {host: 192.168.0.22, port: 8}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each peer or board whose address and port an earlier one has."""
        seen: dict[str, tuple[str, EndSettings]] = {}
        for peer in context.table.peers:
            for settings, end in peer.ends:
                name = f"{end.name} of {peer.name}" if peer.boards else peer.name
                for host in settings.hosts or ("",):
                    if host == LEARN:
                        continue
                    for claim, where in _claims(host, end.port):
                        first, place = seen.setdefault(claim, (name, settings))
                        if place is not settings:
                            message = f"{name!r} and {first!r} both have {where}"
                            key = "port" if "port" in settings.spans else "host"
                            also = [(place.at(key), f"the address of {first!r}")]
                            yield cls.at(settings.at(key), message, "give each of them its own `host` or `port`", also)


def _claims(host: str, port: int) -> Iterator[tuple[str, str]]:
    """Yield what a host takes for one end alone, in one spelling, and as text for the user.

    Lines differ by their places and not by their settings. Only a CAN bus has room for many ends.
    """
    if not names_transport(host):
        yield f"{_canonical(host)} {port}", f"port {port} of {host or 'the host in the parameter dst_ip'}"
        return
    kind, place, options = transport_address(host)
    if kind == "can":
        for option in ("send", "receive"):
            yield f"{place} {can_id(options[option])}", f"the identifier {options[option]} on {place}"
    else:
        yield f"{kind}:{place}", f"the line {host}"


def _canonical(host: str) -> str:
    """Return one spelling for each host: names have no capitals, and IPv6 has many spellings of one address."""
    try:
        return str(ip_address(host))
    except ValueError:
        return host.lower().removesuffix(".")


class BoardUndecided(LintRule, id="TAB115"):
    """A row sends to a peer that has boards with addresses, but nothing tells to which board.

    A row goes to the board whose name begins the name of its message. Messages with another name need the key `board`
    in the row. Without a board, the bridge has no address for the row's datagrams.

    Bad::

        peers:
          hardware: {boards: {ArmBoard: {host: 192.168.0.21}}}
        messages:
          - {number: 9, name: motor, proto: Motor, topic: motor, direction: ros_to_hardware}

    Good::

        peers:
          hardware: {boards: {ArmBoard: {host: 192.168.0.21}}}
        messages:
          - {number: 9, name: motor, proto: Motor, topic: motor, direction: ros_to_hardware, board: ArmBoard}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each row to a peer with boards that has no board with an address."""
        table = context.table
        if not table.whole:
            return  # the board may be in a part that could not be read
        peers = table.peers_by_name()
        for row in table.rows:
            peer, board = peers.get(row.peer), table.board_of(row)
            boards = [board.name for board in peer.boards] if peer else []
            # A board that the row names, and that does not exist, is reported by unknown-board.
            if (
                row.inbound
                or not boards
                or board in boards
                or row.board not in ("", *(peer.board_names if peer else ()))
            ):
                continue
            message = f"nothing tells to which board of the peer {row.peer!r} the row {row.name!r} goes"
            help = f"write `board:` with one of {', '.join(boards)} in the row"
            if board:
                message = f"{row.name!r} goes to the board {board!r} of the peer {row.peer!r}, which has no address"
                help = f"add {board!r} with its `host` to `boards` of the peer {row.peer!r}, or {help}"
            yield cls.of_row(table, row, "board" if row.board else "proto", message, help)


class UnknownBoard(LintRule, id="TAB116"):
    """The `board` of a row is not a board of the row's peer.

    The boards of a peer are those under its `boards`, and its `prefixes` if there are several. For another name, the
    bridge has no address, and diagnostics would show a board that does not exist.

    Bad::

        peers:
          hardware: {boards: {ArmBoard: {host: 192.168.0.21}}}
        messages:
          - {number: 9, name: motor, proto: Motor, topic: motor, direction: ros_to_hardware, board: ArmBord}

    Good::

        peers:
          hardware: {boards: {ArmBoard: {host: 192.168.0.21}}}
        messages:
          - {number: 9, name: motor, proto: Motor, topic: motor, direction: ros_to_hardware, board: ArmBoard}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each row whose `board` is unknown."""
        table = context.table
        if not table.whole:
            return  # the board may be in a part that could not be read
        peers = table.peers_by_name()
        for row in table.rows:
            known = peers[row.peer].board_names if row.peer in peers else ()
            if row.board and row.peer in peers and row.board not in known:
                message = f"unknown board {row.board!r} of the peer {row.peer!r} (known: {', '.join(known) or 'none'})"
                help = nearest(row.board, known, f"add the board under `boards` of the peer {row.peer!r}")
                yield cls.of_row(table, row, "board", message, help)


class MulticastSettingWithoutEffect(LintRule, id="TAB117"):
    """A peer or a board has `interface` or `ttl`, but its host is not a multicast group.

    Both settings are for datagrams to a multicast group, which several computers receive. A multicast group is an IP
    address from 224.0.0.0 to 239.255.255.255, or one that begins with ff. For other addresses, the routes of the
    computer decide.

    Bad::

        peers:
          radio: {host: 10.0.0.7, interface: eth0}

    Good::

        peers:
          radio: {host: 239.0.0.7, interface: eth0}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each `interface` and `ttl` of a peer or board without a multicast group."""
        for peer in context.table.peers:
            for settings, end in peer.ends:
                unread = "host" in settings.spans and not settings.hosts  # a mistake that is reported on its own
                if unread or any(map(_is_group, settings.hosts)):
                    continue
                for key in ("interface", "ttl"):
                    if key in settings.spans:
                        message = f"`{key}` of {end.name!r} has no effect, because its host is not a multicast group"
                        help = f"remove `{key}`, or write a multicast group as `host`, such as 239.0.0.7"
                        yield cls.at(settings.at(key), message, help)


def _is_group(host: str) -> bool:
    try:
        return ip_address(host).is_multicast
    except ValueError:
        return False


class AddressNeverLearned(LintRule, id="TAB118"):
    """The host of a peer or a board is `learn`, but the bridge cannot learn its address.

    `learn` stands for the source of the last valid datagram. So a row must come from the peer or the board, and `learn`
    must be its only host.

    Bad::

        peers:
          hardware: {host: [learn, 192.168.0.21]}
        messages:
          - {number: 9, name: imu, proto: Imu, topic: imu, direction: hardware_to_ros}

    Good::

        peers:
          hardware: {host: learn}
        messages:
          - {number: 9, name: imu, proto: Imu, topic: imu, direction: hardware_to_ros}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each peer or board whose address is to be learned, but never can be."""
        table = context.table
        speaking = {(row.peer, table.board_of(row)) for row in table.rows if row.inbound}
        speaking |= {(peer, "") for peer, _ in speaking}
        for peer in table.peers:
            for settings, end in peer.ends:
                if LEARN not in settings.hosts:
                    continue
                if len(settings.hosts) > 1:
                    message = f"{LEARN!r} stands beside other hosts of {end.name!r}"
                    yield cls.at(settings.at("host"), message, f"write `host: {LEARN}`, or list only other hosts")
                elif table.whole and (peer.name, end.name if peer.boards else "") not in speaking:
                    message = f"no row comes from {end.name!r}, so its address is never learned"
                    yield cls.at(settings.at("host"), message, "write its address or name as `host`")


class AddressBesideBoards(LintRule, id="TAB119"):
    """A peer has boards with addresses, and also an address of its own.

    Each row goes to one of the boards, so nothing would be sent to the address of the peer. Only `port` has a meaning
    beside `boards`: it is the port of the boards that have none.

    Bad::

        peers:
          hardware: {host: 192.168.0.20, boards: {ArmBoard: {host: 192.168.0.21}}}

    Good::

        peers:
          hardware: {port: 8, boards: {ArmBoard: {host: 192.168.0.21}}}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each key with an address of a peer that has boards."""
        for peer in context.table.peers:
            for key in ("host", "interface", "ttl", "parameter"):
                if peer.boards and key in peer.spans:
                    message = f"`{key}` of the peer {peer.name!r} has no effect, because the peer has `boards`"
                    other = (
                        "; every board has parameters of its own" if key == "parameter" else ", or write it at a board"
                    )
                    yield cls.at(peer.at(key), message, f"remove `{key}`{other}")


class LineBesideOtherHosts(LintRule, id="TAB120"):
    """A peer or a board has a line, such as a serial one, and also other hosts.

    What comes over the line of an end is believed, and nothing else is. So an end with a line has this line as its only
    host.

    Bad::

        peers:
          hardware: {host: ["serial:/dev/ttyACM0", 192.168.0.21]}

    Good::

        peers:
          hardware: {host: "serial:/dev/ttyACM0"}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each peer or board that has a line and another host."""
        for peer in context.table.peers:
            for settings, end in peer.ends:
                if len(settings.hosts) > 1 and (lines := list(filter(names_transport, settings.hosts))):
                    message = f"{lines[0]!r} stands beside other hosts of {end.name!r}"
                    yield cls.at(settings.at("host"), message, f"write `host: {lines[0]}`, or list only other hosts")
