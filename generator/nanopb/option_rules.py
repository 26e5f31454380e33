"""The rules of nanopb's options and of bounds in the table."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule, Severity

UNREADABLE_OPTIONS = Rule(
    "NPB101",
    "unreadable-nanopb-options",
    """An option for nanopb, in a `.options` file or in a `.proto` file, cannot be read.

nanopb would stop or ignore the line, and the size of an envelope would be computed without it.

Bad::

    # proto/note.proto
    message Note { string text = 1; repeated float samples = 2; }
    # proto/note.options
    Note.text max_sise:20

Good::

    # proto/note.proto
    message Note { string text = 1; repeated float samples = 2; }
    # proto/note.options
    Note.text max_size:20
""",
)

PATTERN_WITHOUT_MATCH = Rule(
    "NPB102",
    "nanopb-pattern-without-match",
    """A line of a `.options` file matches nothing that its `.proto` file declares.

The bound has no effect; the field was renamed, or the name lacks its package.

Bad::

    # proto/note.proto
    message Note { string text = 1; repeated float samples = 2; }
    # proto/note.options
    Note.txt max_size:20

Good::

    # proto/note.proto
    message Note { string text = 1; repeated float samples = 2; }
    # proto/note.options
    Note.text max_size:20
""",
    Severity.WARNING,
)

UNFIT_BOUND = Rule(
    "NPB103",
    "unfit-bound",
    """A bound in the table names no field, or a field that cannot have it.

Only texts and bytes have a length, only repeated fields have a count.

Bad::

    # mapping.yaml
    - {number: 1, name: note, proto: Note, topic: note, direction: board_to_ros, bounds: {text: {count: 20}}}
    # proto/note.proto
    message Note { string text = 1; repeated float samples = 2; }

Good::

    # mapping.yaml
    - {number: 1, name: note, proto: Note, topic: note, direction: board_to_ros, bounds: {text: {length: 20}}}
    # proto/note.proto
    message Note { string text = 1; repeated float samples = 2; }
""",
)

BOUNDS_IN_TWO_PLACES = Rule(
    "NPB104",
    "bounds-in-two-places",
    """The table bounds fields of a file that has a `.options` file.

nanopb reads one `.options` file for a `.proto` file, so one of the two would be ignored.

Bad::

    # mapping.yaml
    - {number: 1, name: note, proto: Note, topic: note, direction: board_to_ros, bounds: {text: {length: 20}}}
    # proto/note.proto
    message Note { string text = 1; repeated float samples = 2; }
    # proto/note.options
    Note.samples max_count:8

Good::

    # mapping.yaml
    - {number: 1, name: note, proto: Note, topic: note, direction: board_to_ros,
       bounds: {text: {length: 20}, samples: {count: 8}}}
    # proto/note.proto
    message Note { string text = 1; repeated float samples = 2; }
""",
)

NANOPB_MISSING = Rule(
    "NPB105",
    "nanopb-not-installed",
    """There are options for nanopb, and the package that says what they mean is not installed.

Without it, the largest size of a message on a microcontroller is not known.

Bad::

    $ roverlink lint     # proto/note.options is there, the package nanopb is not

Good::

    $ pip install 'roverlink[nanopb]'
""",
    Severity.FATAL,
)
