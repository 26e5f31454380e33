"""The rules of `roverlink init`."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule, Severity

NOTHING_TO_TAKE_OVER = Rule(
    "ADO101",
    "nothing-to-take-over",
    """`roverlink init` is given a folder without a `.proto` file.

There is no envelope from which rows could be drafted.

Bad::

    $ roverlink init --from protos   # the folder is called proto

Good::

    $ roverlink init --from proto
""",
    Severity.FATAL,
)

NO_SUCH_ENVELOPE = Rule(
    "ADO102",
    "no-such-envelope",
    """`roverlink init` finds no message that can be the envelope, or not the one that is named.

The envelope is a message with a oneof whose members are the payloads.

Bad::

    $ roverlink init --from proto --envelope x.proto

Good::

    $ roverlink init --from proto --envelope envelope.proto --message PBEnvelope
""",
    Severity.FATAL,
)

IN_THE_WAY = Rule(
    "ADO103",
    "file-in-the-way",
    """`roverlink init` would overwrite a file that it did not generate.

Nothing that somebody wrote is replaced. Move the file, or generate into another folder.

Bad::

    docs/messages.md: fatal[ADO103] is there already, and was not generated

Good::

    $ mv docs/messages.md docs/old-messages.md
""",
    Severity.FATAL,
)

PROTOS_WITHOUT_TABLE = Rule(
    "ADO104",
    "protos-without-table",
    """`roverlink init` starts a project, but the folder `proto` already holds `.proto` files.

A new project would ignore them. `--from` drafts a table for the files that are there.

Bad::

    $ roverlink init                # proto/robot.proto is there

Good::

    $ roverlink init --from proto
""",
    Severity.FATAL,
)
