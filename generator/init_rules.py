"""Rules for the command `roverlink init`."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule, Severity

NOTHING_TO_TAKE_OVER = Rule(
    "ADO101",
    "nothing-to-take-over",
    """The folder given to `roverlink init --from` contains no `.proto` file, or is outside the git repository.

`roverlink init` drafts the rows of the table from the envelope, which is declared in a `.proto` file of the repository.

Bad::

    $ roverlink init --from protos   # but the folder is named proto

Good::

    $ roverlink init --from proto
""",
    Severity.FATAL,
)

NO_SUCH_ENVELOPE = Rule(
    "ADO102",
    "no-such-envelope",
    """`roverlink init` finds no message that can be the envelope, or not the one that the options name.

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
    """`roverlink init` would overwrite a file that it did not generate, or cannot read a file that it would keep.

Files that were not generated are never replaced. Move the file, or generate into another folder. A link out of the git
repository, a pipe and a device are not read.

Bad::

    docs/messages.md: fatal[ADO103] the file exists and was not generated

Good::

    $ mv docs/messages.md docs/old-messages.md
""",
    Severity.FATAL,
)

PROTOS_WITHOUT_TABLE = Rule(
    "ADO104",
    "protos-without-table",
    """`roverlink init` starts a project, but the folder `proto` already contains `.proto` files.

The table of a new project would have no rows for these files. With `--from`, the command drafts a table for them.

Bad::

    $ roverlink init                # proto/robot.proto exists

Good::

    $ roverlink init --from proto
""",
    Severity.FATAL,
)
