"""Rules for the commands that change the table or the ledger: `add`, `retire` and `lint --accept`."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule, Severity

NO_SUCH_ROW = Rule(
    "RET101",
    "no-such-row",
    """`roverlink retire` names a number that no row has.

No row is changed, because the number may be a typing error.

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

`--accept` writes the numbers that `--history` reports into the ledger (mapping.lock). A tree of .proto files without a
table has no ledger.

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
    """`roverlink add` finds no list of rows under `messages` with one row per line.

The new row copies the style of the last row, so a row must exist. Write the first row by hand.

Bad::

    messages: []

Good::

    messages:
      - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros}
""",
)
