"""Rules about input that the lint cannot read: an earlier state, the protos, git's history, or pins."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule, Severity

NO_SUCH_STATE = Rule(
    "STA101",
    "no-such-state",
    """`--against` names something that is not a folder, a file or a git ref.

Without the earlier state, the lint cannot check any change.

Bad::

    $ roverlink lint --against mian

Good::

    $ roverlink lint --against main
""",
    Severity.FATAL,
)

UNREADABLE_STATE = Rule(
    "STA102",
    "unreadable-state",
    """The earlier state, or a file of it, cannot be read or does not compile.

The lint cannot check changes of messages that are unknown there.

Bad::

    old.binpb: fatal[STA102] is not a descriptor set

Good::

    $ protoc --include_imports -o old.binpb -I proto proto/imu.proto
""",
    Severity.FATAL,
)

NO_PROTOS = Rule(
    "STA103",
    "no-protos",
    """The folder does not exist, or contains no `.proto` file.

A lint that read nothing must not pass.

Bad::

    $ roverlink lint protos
    protos: fatal[STA103] contains no .proto file

Good::

    $ roverlink lint proto
""",
    Severity.FATAL,
)

NO_ENVELOPE_MESSAGE = Rule(
    "STA104",
    "no-envelope-message",
    """In a tree without a table, the envelope's message is not declared or not named.

The numbers of payloads are numbers of the envelope, so the lint has to know this message.

Bad::

    $ roverlink next-number proto

Good::

    $ roverlink next-number proto --message PBEnvelope
""",
    Severity.FATAL,
)

UNREADABLE_HISTORY = Rule(
    "STA105",
    "unreadable-history",
    """git's history cannot be read.

There is no repository, or git is not installed.

Bad::

    $ cd ~/download/rover-main && roverlink lint --history

Good::

    $ git clone https://example.com/rover && cd rover && roverlink lint --history
""",
    Severity.FATAL,
)

LIMITED_HISTORY = Rule(
    "STA106",
    "limited-history",
    """A part of the history is missing, or some state of a file cannot be read.

A number that was used only in that part looks unused. Many CI systems clone without history by default.

Bad::

    $ git clone --depth 1 https://example.com/rover

Good::

    $ git fetch --unshallow
""",
    Severity.WARNING,
)

UNREADABLE_PINS = Rule(
    "PIN101",
    "unreadable-pins",
    """A source of pins cannot be read, contains no pin, or names a commit that the repository does not have.

If the commit of a consumer is unknown, it may disagree with all others.

Bad::

    $ roverlink lint --pins pins.txt   # `rover 0000000`

Good::

    $ roverlink lint --pins pins.txt   # `rover 4f1c2ab`
""",
    Severity.FATAL,
)
