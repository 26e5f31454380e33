"""Rules for the command `roverlink init`."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule, Severity


class NothingToTakeOver(Rule, id="ADO101", severity=Severity.FATAL):
    """The folder given to `roverlink init --from` contains no `.proto` file, or is outside the git repository.

    `roverlink init` drafts the rows of the table from the envelope, which is declared in a `.proto` file of the
    repository.

    Bad::

        $ roverlink init --from protos   # but the folder is named proto

    Good::

        $ roverlink init --from proto
    """


class NoSuchEnvelope(Rule, id="ADO102", severity=Severity.FATAL):
    """`roverlink init` finds no message that can be the envelope, or not the one that the options name.

    The envelope is a message with a oneof whose members are the payloads.

    Bad::

        $ roverlink init --from proto --envelope x.proto

    Good::

        $ roverlink init --from proto --envelope envelope.proto --message PBEnvelope
    """


class FileInTheWay(Rule, id="ADO103", severity=Severity.FATAL):
    """`roverlink init` would overwrite a file that it did not generate, or cannot read a file that it would keep.

    Files that were not generated are never replaced. Move the file, or generate into another folder. A link out of the
    git repository, a pipe and a device are not read.

    Bad::

        docs/messages.md: fatal[ADO103] the file exists and was not generated

    Good::

        $ mv docs/messages.md docs/old-messages.md
    """


class ProtosWithoutTable(Rule, id="ADO104", severity=Severity.FATAL):
    """`roverlink init` starts a project, but the folder `proto` already contains `.proto` files.

    The table of a new project would have no rows for these files. With `--from`, the command drafts a table for them.

    Bad::

        $ roverlink init                # proto/robot.proto exists

    Good::

        $ roverlink init --from proto
    """
