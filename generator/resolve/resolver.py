"""Resolver: makes the IR (the compiler's own model) from the table and the schema of the .proto files.

A row or field that cannot be converted is reported as a diagnostic; no field is dropped silently.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import PurePosixPath

from roverlink.generator import ir
from roverlink.generator.diagnostics import Diagnostic
from roverlink.generator.lock import Ledger
from roverlink.generator.protos.proto_rules import ExcludedProtoMessage
from roverlink.generator.protos.protoc import Compilation
from roverlink.generator.protos.row_hash import row_hash
from roverlink.generator.protos.schema import Schema, commented
from roverlink.generator.resolve.messages import RosMessages
from roverlink.generator.resolve.request_services import request
from roverlink.generator.resolve.safety import check_peers, deadman
from roverlink.generator.resolve.standard import StandardTopics
from roverlink.generator.table import PeerSettings, Row, Table


def resolve_envelope(table: Table, files: Mapping[str, str], published: Ledger) -> ir.Envelope:
    """Return the envelope, which is the message around every payload, with one member of its oneof for each row.

    The link message is a member, too. ``files`` has the .proto file of each proto message, by the message's full name.
    A row whose message is not in ``files`` is left out. ``published`` is the ledger (mapping.lock). It gives the burned
    numbers: numbers that had several meanings in the past and must never be used again.
    """
    burned = published.burned_in(table.envelope.message)
    members = [
        ir.Member(member.number, member.name, member.proto, files[member.proto])
        for member in table.members
        if member.proto in files
    ]
    return ir.Envelope(
        file=table.envelope.file,
        message=table.envelope.message,
        oneof=table.envelope.oneof,
        ours=table.envelope.owner == "mapping",
        members=tuple(sorted(members, key=lambda member: member.number)),
        retired=tuple(
            ir.Retired(row.number, row.name, row.proto) for row in sorted(table.retired, key=lambda row: row.number)
        ),
        burned=tuple(
            ir.Burned(number, tuple(dict.fromkeys(use.type for use in entry.uses)), entry.reason)
            for number, entry in sorted(burned.items())
            if number not in table.numbers
        ),
        signature=table.signing.number if table.signing else None,
    )


def resolve(
    table: Table,
    compilation: Compilation,
    envelope: ir.Envelope,
    bounds: Iterable[ir.FieldBound],
    sizes: Mapping[str, ir.WireSize],
    findings: list[Diagnostic],
) -> ir.Bridge:
    """Return the IR of a table: its routes, ROS messages, conversions and wire schema.

    ``compilation`` is the result of protoc. ``bounds`` are the size limits of fields for microcontrollers. ``sizes``
    has the largest size of each row's payload and datagram, by the row's name. Mistakes are added to ``findings``. If
    errors were added, no files must be generated from the IR.
    """
    schema = compilation.schema
    messages = RosMessages(table, schema, findings)
    standard_topics = StandardTopics(table, schema, findings.append)
    located = [row for row in table.rows if row.proto in schema.messages]
    routes = tuple(
        _route(row, table, messages, standard_topics, sizes.get(row.name))
        # By number, and not in the order of the table: moving a row must not change any generated file.
        for row in sorted(located, key=lambda row: row.number)
    )
    carried = {route.conversion.ros for route in routes if route.conversion}
    if table.whole:
        messages.check_enums()
        findings += check_peers(table)
    findings += _excluded(table, schema)
    listed = {proto for row in table.rows for types in row.anys.values() for proto in types}
    reached, enums = schema.reachable(envelope.message, *sorted(listed))
    return ir.Bridge(
        table=table.file,
        package=table.ros.package,
        python_package=table.python.package,
        maintainer=table.ros.maintainer,
        version=table.ros.version,
        license=table.ros.license,
        envelope=envelope,
        peers=tuple(_peer(peer) for peer in sorted(table.peers, key=lambda peer: peer.name)),
        routes=routes,
        messages=tuple(sorted(messages.messages.values(), key=lambda message: message.name)),
        nested=tuple(conversion for ros, conversion in sorted(messages.conversions.items()) if ros not in carried),
        anys=tuple(conversion for _, conversion in sorted(messages.anys.items())),
        wire_messages=tuple(schema.messages[name].on_the_wire() for name in sorted(reached)),
        wire_enums=tuple(schema.enums[name].on_the_wire() for name in sorted(enums)),
        bounds=tuple(bounds),
        interfaces=standard_topics.interfaces,
        modules=compilation.modules,
        descriptors=schema.descriptors_without_comments(),
        link=_link(table, schema),
    )


def _route(
    row: Row, table: Table, messages: RosMessages, standard_topics: StandardTopics, size: ir.WireSize | None
) -> ir.Route:
    standard, extra_topics = standard_topics.of(row)
    return ir.Route(
        number=row.number,
        name=row.name,
        topic=row.topic,
        direction=row.direction,
        qos=row.profile,
        forward=row.forward,
        proto=row.proto,
        conversion=messages.conversion(row),
        comment=commented(messages.schema.messages[row.proto]),
        deadman=deadman(row, messages.schema, messages.report),
        max_rate=row.max_rate,
        size=size,
        priority=row.priority,
        send=row.send.limits if row.send else None,
        forward_limits=tuple((one.peer, one.limits) for one in row.forward_settings if one.limits != ir.SendLimits()),
        expect_rate=row.expect_rate,
        standard=standard,
        extra_topics=extra_topics,
        board=table.board_of(row),
        schema_hash=row_hash(messages.schema, row.proto),
        request=request(row, table, messages),
    )


def _peer(peer: PeerSettings) -> ir.Peer:
    ends = tuple(end for _, end in peer.ends)
    own = ir.End(peer.name) if peer.boards else ends[0]
    return ir.Peer(
        name=peer.name,
        parameter=own.parameter,
        port=own.port,
        host=own.host,
        host_parameter=own.host_parameter,
        interface=own.interface,
        ttl=own.ttl,
        strip_trailing_zeros=peer.strip_trailing_zeros,
        prefixes=peer.prefixes,
        sources=peer.sources,
        source_rate=peer.source_rate,
        max_size=peer.max_size,
        budget=peer.budget,
        must_sign=peer.sign == "required",
        boards=ends if peer.boards else (),
    )


def _link(table: Table, schema: Schema) -> ir.Link | None:
    """Return the link message; None if the table has none, or if no compiled file declares it, which LNK101 reports."""
    message = schema.messages.get(ir.LINK_MESSAGE)
    if table.link is None or message is None:
        return None
    return ir.Link(table.link.number, message.file, table.link.on_mismatch)


def _excluded(table: Table, schema: Schema) -> Iterator[Diagnostic]:
    """Report .proto files that the table lists under `proto.exclude`, but that a compiled file imports."""
    for path in table.proto.exclude:
        if str(PurePosixPath(path)) in schema.files:
            span = table.proto.at(f"exclude.{path}")
            message = f"the file {path!r} is excluded, but another file that the rows need imports it"
            yield ExcludedProtoMessage.at(
                span, message, "remove the file from `exclude` of `proto`, or remove the import"
            )
