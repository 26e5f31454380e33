"""Rules about what a slow link has to carry: budgets of peers, and limits of forwards."""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Severity
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.rules import LintRule
from roverlink.generator.nanopb import envelope_size, largest_size
from roverlink.generator.table import PeerSettings, Row
from roverlink.numerals import counted

_HEADERS = 28  # bytes of IPv4 and UDP


class BudgetTooSmall(LintRule, id="RAD101", severity=Severity.WARNING):
    """The `budget` of a peer is smaller than what its rows need alone that have an `expect_rate`.

    The bridge then drops messages all the time: the oldest ones of the rows with the lowest `priority`. The rule counts
    the rows to the peer, and those that are forwarded to it, with their largest sizes and the headers of IPv4 and UDP.
    Rows that are sent only on change do not count, nor do rows whose size has no limit.

    Bad::

        peers: {board: {}, base: {budget: 1 kB/s}}
        messages:
          - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, forward: [base], expect_rate: 50}

    Good::

        peers: {board: {}, base: {budget: 20 kB/s}}
        messages:
          - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, forward: [base], expect_rate: 50}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each peer whose budget is too small for its rows."""
        for peer in context.table.peers:
            needs = {row.name: _needed(context, row, peer) for row in context.table.rows} if peer.budget else {}
            total = sum(needs.values())
            if peer.budget and total > peer.budget:
                most = ", ".join(sorted((name for name in needs if needs[name]), key=lambda name: -needs[name])[:3])
                message = (
                    f"the peer {peer.name!r} has a budget of {peer.budget} bytes a second, but its rows with an "
                    f"`expect_rate` need {total}; the largest: {most}"
                )
                help = "raise the budget, or limit rows with `max_rate` or `on_change`, also under `forward`"
                yield cls.at(peer.at("budget"), message, help)


def _needed(context: Context, row: Row, peer: PeerSettings) -> int:
    """Return the bytes a second that a row needs to a peer; 0 if that is not known."""
    limits = [] if row.inbound or row.peer != peer.name else [row.send]
    limits += [forward for forward in row.forward_settings if row.inbound and forward.peer == peer.name]
    schema, bounds = context.schema, context.bounds
    if not limits or not row.expect_rate or bounds is None or row.proto not in schema.messages:
        return 0
    payload = largest_size(schema, bounds, row.proto)
    if not isinstance(payload, int) or any(limit is not None and limit.on_change for limit in limits):
        return 0
    size = envelope_size(schema, bounds, context.table.envelope.message, row.number, payload) + _HEADERS
    rates = [row.expect_rate, *(limit.limits.max_rate for limit in limits if limit is not None)]
    if not row.inbound:
        rates.append(row.max_rate)
    return size * min(rate for rate in rates if rate is not None)


class ForwardRateWithoutEffect(LintRule, id="RAD102", severity=Severity.HINT):
    """The `max_rate` of a forward is larger than that of its row.

    The `max_rate` of a row limits its topic, and not its forwards. A forward to a slow link with a larger rate than the
    topic's is often a mistake.

    Bad::

        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          max_rate: 5
          forward: [{peer: base, max_rate: 50}]

    Good::

        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          max_rate: 50
          forward: [{peer: base, max_rate: 5}]
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each forward that has a larger rate than its row."""
        for row in context.table.rows:
            for forward in row.forward_settings:
                if row.max_rate and forward.max_rate and forward.max_rate > row.max_rate:
                    message = (
                        f"{forward.peer!r} gets up to {counted(forward.max_rate, 'message')} of {row.name!r} a second, "
                        f"but its topic gets {row.max_rate}"
                    )
                    also = [(row.at("max_rate"), "the topic's limit is here")]
                    help = "lower the `max_rate` under `forward`, if the link to the peer is the slow one"
                    yield cls.of_row(context.table, row, forward.at("max_rate"), message, help, also)
