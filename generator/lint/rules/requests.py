"""Rules about rows with `request`: the row that answers them, and the field by which both belong together."""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Severity, Span
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.rules import LintRule
from roverlink.generator.lock import REQUESTS
from roverlink.generator.protos.schema import ProtoField
from roverlink.generator.resolve.numeric_ranges import range_of
from roverlink.generator.resolve.request_services import ERROR
from roverlink.generator.resolve.well_known import SCALARS
from roverlink.generator.table import RequestSettings, Row, Table
from roverlink.suggestions import nearest

_Pair = tuple[Row, RequestSettings, Row]


def _pairs(table: Table) -> Iterator[_Pair]:
    """Yield each row with `request`, its settings, and the row that answers it, if this row exists."""
    rows = {row.name: row for row in table.rows}
    for row in table.rows:
        if row.request is not None and (response := rows.get(row.request.response)) is not None:
            yield row, row.request, response


class UnknownResponse(LintRule, id="REQ101"):
    """A request names a row as its response that does not exist, or that cannot answer it.

    The response has the opposite direction of the request, and belongs to the same peer and the same board, because a
    request is answered by the end that gets it. A response belongs to one request only. Otherwise nothing would tell
    which of two requests it answers.

    Bad::

        - {number: 1, name: ask, proto: Ask, topic: ask, direction: ros_to_board, request: {response: answer}}
        - {number: 2, name: answer, proto: Answer, topic: answer, direction: base_to_ros}

    Good::

        - {number: 1, name: ask, proto: Ask, topic: ask, direction: ros_to_board, request: {response: answer}}
        - {number: 2, name: answer, proto: Answer, topic: answer, direction: board_to_ros}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each request whose response is missing, comes from elsewhere, or is shared."""
        table = context.table
        names = [row.name for row in table.rows]
        for row in table.rows:
            if row.request is not None and row.request.response not in names and table.whole:
                span, message = row.request.at("response"), f"no row has the name {row.request.response!r}"
                help = nearest(row.request.response, names, "add the row with the response")
                yield cls.of_row(table, row, span, message, help)
        first: dict[str, Row] = {}
        for row, settings, response in _pairs(table):
            direction = f"ros_to_{row.peer}" if row.inbound else f"{row.peer}_to_ros"
            span, also = settings.at("response"), [(response.at("direction"), "the response")]
            if response.direction != direction:
                message = f"{response.name!r} has the direction {response.direction!r}, and cannot answer {row.name!r}"
                yield cls.of_row(table, row, span, message, f"name a row with `direction: {direction}`", also)
            elif table.board_of(row) != table.board_of(response):
                boards = [table.board_of(one) or f"{one.peer} as a whole" for one in (row, response)]
                message = f"{row.name!r} belongs to {boards[0]}, but its response {response.name!r} to {boards[1]}"
                yield cls.of_row(table, row, span, message, "name a row of the same board, or set `board`", also)
            elif (other := first.setdefault(response.name, row)) is not row:
                message = f"{response.name!r} is already the response of {other.name!r}"
                yield cls.of_row(table, row, span, message, "give each request a response of its own", also)


class CorrelationField(LintRule, id="REQ102"):
    """The `field` of a request is not an integer field that both payloads have.

    The sender of a request puts a number into this field, and the response repeats the number. So the field must have
    the same integer type in both messages. It must not be repeated, be in a oneof or distinguish *absent* from *zero*,
    and no row may list it under `ignore`.

    Bad::

        # mapping.yaml
        messages:
          - {number: 1, name: ask, proto: Ask, topic: ask, direction: ros_to_board,
             request: {response: answer, field: id}}
          - {number: 2, name: answer, proto: Answer, topic: answer, direction: board_to_ros}
        // board.proto
        message Ask { uint32 id = 1; }
        message Answer { uint64 id = 1; }

    Good::

        # mapping.yaml
        messages:
          - {number: 1, name: ask, proto: Ask, topic: ask, direction: ros_to_board,
             request: {response: answer, field: id}}
          - {number: 2, name: answer, proto: Answer, topic: answer, direction: board_to_ros}
        // board.proto
        message Ask { uint32 id = 1; }
        message Answer { uint32 id = 1; }
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each request whose field one of the payloads cannot use."""
        for row, settings, response in _pairs(context.table):
            if settings.field is None:
                continue
            found: list[ProtoField] = []
            for one in (row, response):
                if (declared := context.schema.messages.get(one.proto)) is None:
                    break
                fields = {field.name: field for field in declared.fields}
                field = fields.get(settings.field)
                if fault := _fault(field, one):
                    help = nearest(settings.field, fields, "name an integer field of both payloads")
                    message = f"{settings.field!r} of {one.proto!r} {fault}"
                    yield cls.of_row(context.table, row, settings.at("field"), message, help if not field else "")
                    break
                found += [field] if field else []
            else:
                if found[0].type != found[1].type:
                    types = " and ".join(f"{one.type} in {of.proto!r}" for one, of in zip(found, (row, response)))
                    message = f"{settings.field!r} has two types: {types}"
                    help = "give it the same type in both messages"
                    yield cls.of_row(context.table, row, settings.at("field"), message, help)


def _fault(field: ProtoField | None, row: Row) -> str:
    """Return the reason why a field of a row's payload cannot hold the number of a request; empty if it can."""
    if field is None:
        return "does not exist"
    if field.type not in SCALARS or not range_of(SCALARS[field.type]) or field.type == "bool":
        return f"is no integer, but {field.type_name or field.type}"
    if field.repeated or field.oneof or field.optional:
        return "is repeated, in a oneof, or optional"
    return f"is ignored by the row {row.name!r}" if field.name in row.ignore else ""


class RequestWithOtherKeys(LintRule, id="REQ103"):
    """A request or its response has a key that contradicts it: `deadman`, `max_rate`, `also` or a standard message.

    A request is sent again until it is answered. A limit of the rate would drop some, and a deadman would send what
    nobody has asked. Extra topics and standard messages do not carry the number by which both belong together.

    Bad::

        - {number: 1, name: ask, proto: Ask, topic: ask, direction: ros_to_board, request: {response: answer}}
        - {number: 2, name: answer, proto: Answer, topic: answer, direction: board_to_ros, max_rate: 5}

    Good::

        - {number: 1, name: ask, proto: Ask, topic: ask, direction: ros_to_board, request: {response: answer}}
        - {number: 2, name: answer, proto: Answer, topic: answer, direction: board_to_ros}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each key of a request, or of its response, that contradicts `request`."""
        for row, settings, response in _pairs(context.table):
            for one in (row, response):
                also = [(settings.span, "the request")]
                for key in [key for key in ("deadman", "max_rate", "also") if key in one.spans]:
                    message = f"{one.name!r} has `{key}`, which contradicts `request`"
                    yield cls.of_row(context.table, one, key, message, f"remove `{key}` or `request`", also)
                if one.standard is not None:
                    message = f"{one.name!r} has the standard message {one.ros!r}, which contradicts `request`"
                    yield cls.of_row(context.table, one, "ros", message, "remove `ros` or `request`", also)


class ServiceOfRequest(LintRule, id="REQ104"):
    """The service of a request cannot be generated, because a name is taken or missing.

    Each service needs a name and a type of its own. The type's response has a field `error`, which says why a request
    was not answered, so the response's message must not have this field. `srv` is the name of a type, and has no effect
    without `service`.

    Bad::

        - {number: 1, name: ask, proto: Ask, topic: ask, direction: ros_to_board,
           request: {response: answer, srv: AskBoard}}
        - {number: 2, name: answer, proto: Answer, topic: answer, direction: board_to_ros}

    Good::

        - {number: 1, name: ask, proto: Ask, topic: ask, direction: ros_to_board,
           request: {response: answer, service: ask_board, srv: AskBoard}}
        - {number: 2, name: answer, proto: Answer, topic: answer, direction: board_to_ros}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each name of a service or of its type that is taken or has no effect."""
        table = context.table
        seen: dict[tuple[str, str], tuple[Row, Span]] = {}
        for row, settings, response in _pairs(table):
            if not settings.service:
                if settings.srv:
                    message = f"`srv` of {row.name!r} has no effect without `service`"
                    yield cls.of_row(table, row, settings.at("srv"), message, "add `service`, or remove `srv`")
                continue
            for kind, name, key in (
                ("service", settings.service.removeprefix("/"), "service"),
                ("service type", row.service_type.lower(), "srv"),
            ):
                span = settings.at(key)
                first, place = seen.setdefault((kind, name), (row, span))
                if first is not row:
                    message = f"the {kind} of {row.name!r} already belongs to {first.name!r}"
                    help = f"give it another name with `{key}`"
                    yield cls.of_row(table, row, span, message, help, [(place, "first used here")])
            declared = context.schema.messages.get(response.proto)
            taken = [field.name for field in declared.fields if _ros_name(field, response) == ERROR] if declared else []
            if taken:
                message = f"{response.proto!r} has the field {taken[0]!r}, but {ERROR!r} is a field of the service"
                help = f"rename it in ROS 2: `fields: {{{taken[0]}: other_name}}` in the row {response.name!r}"
                yield cls.of_row(table, row, settings.at("service"), message, help)


def _ros_name(field: ProtoField, row: Row) -> object:
    return row.fields[field.name].value if field.name in row.fields else field.name


class RequestChanged(LintRule, id="REQ105", severity=Severity.WARNING):
    """A published request has another response, field or service than before, or is no request any more.

    A peer that still has the old table repeats requests that nobody recognizes, or waits for another response. A node
    that calls the old service waits for ever. The next `roverlink generate` writes the new settings into the ledger
    (mapping.lock), so this warning appears once.

    Bad::

        # mapping.lock says `1 Ask request: answer id`
        - {number: 1, name: ask, proto: Ask, topic: ask, direction: ros_to_board}

    Good::

        - {number: 1, name: ask, proto: Ask, topic: ask, direction: ros_to_board,
           request: {response: answer, field: id}}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each setting of a request that was published with another value."""
        for row in context.table.rows:
            changed = context.changed_settings(row)
            for key in REQUESTS:
                if key not in changed:
                    continue
                now = changed[key].now
                message = (
                    f"{row.name!r} has {f'`{key}` {now.text!r}' if now else f'no `{key}`'}; {changed[key].published}"
                )
                span, place = now.span if now else row.at("name"), row.at("direction")
                help = "restore it, or change the peers and nodes that rely on it"
                yield context.diagnostic_of_change(cls, row, changed[key], message, help, span, rests_on=place)
