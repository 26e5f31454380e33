"""The rules of the commands that edit the table or the ledger: add, retire, accept."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule, Severity

NO_SUCH_ROW = Rule(
    "RET101",
    "no-such-row",
    """`roverlink retire` names a number that no row has.

Nothing is retired, since the number might be a slip of the hand.

Bad::

    $ roverlink retire 7     # the rows have 1, 2 and 3

Good::

    $ roverlink retire 3
""",
)

NOTHING_TO_ACCEPT_INTO = Rule(
    "RET102",
    "no-ledger-to-accept-into",
    """`--accept` is used without a table or without `--history`.

Accepted numbers are written to the ledger, and a tree of .proto files without a table has no ledger.

Bad::

    $ roverlink lint proto --history --accept

Good::

    $ roverlink lint --history --accept
""",
    Severity.FATAL,
)

NO_PLACE_FOR_A_ROW = Rule(
    "RET103",
    "no-place-for-a-row",
    """`roverlink add` finds no list of rows under `messages` with one row below the other.

The new row is written like the rows that are there; without one it is not known how.

Bad::

    messages: []

Good::

    messages:
      - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros}
""",
)
