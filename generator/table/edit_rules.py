"""Rules for the commands that change the table or the ledger: `add`, `retire` and `lint --accept`."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule, Severity


class NoSuchRow(Rule, id="RET101"):
    """`roverlink number retire` names a number or a row that the table does not have.

    No row is changed, because the argument may be a typing error.

    Bad::

        $ roverlink number retire 7     # the rows have 1, 2 and 3

    Good::

        $ roverlink number retire 3
    """


class AcceptWithoutHistory(Rule, id="RET102", severity=Severity.FATAL):
    """`--accept` is used for numbers without `--history`.

    `--accept` writes the numbers that `--history` reports into the ledger: mapping.lock, or in a folder of .proto files
    without a table the file accepted-numbers.lock.

    Bad::

        $ roverlink lint --accept 18

    Good::

        $ roverlink lint --history --accept 18
    """


class NoPlaceForARow(Rule, id="RET103"):
    """`roverlink add` finds no list of rows under `messages` with one row per line.

    The new row copies the style of the last row, so a row must exist. Write the first row by hand.

    Bad::

        messages: []

    Good::

        messages:
          - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros}
    """


class NoFindingToAccept(Rule, id="RET104", severity=Severity.FATAL):
    """`--accept` names a number about which `--history` reports nothing, or a rule without a finding.

    Nothing is written, because the number may be a typing error. A number of the envelope is written alone. A number of
    another message, or of an enum, is written with the full name: `rover.ImuInfo:3`. The help of a finding contains the
    command that accepts it. A rule can only be accepted in a folder without a table, because a table has `lint`.

    Bad::

        $ roverlink lint --history --accept 81     # the finding is about 18

    Good::

        $ roverlink lint --history --accept 18
    """
