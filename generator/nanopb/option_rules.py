"""Rules about nanopb's options, and about size limits in the table."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule, Severity


class UnreadableNanopbOptions(Rule, id="NPB101"):
    """An option for nanopb, in a `.options` file or in a `.proto` file, cannot be read.

    nanopb would stop or ignore the line, and the lint would compute the sizes of messages without the option.

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
    """


class UnfitBound(Rule, id="NPB103"):
    """A size limit under `bounds` in mapping.yaml names a field that does not exist, or that cannot have this limit.

    A bound is a size limit of a field, under `bounds` of a row. Only strings and bytes have a length. Only repeated
    fields have a count.

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
    """


class BoundsInTwoPlaces(Rule, id="NPB104"):
    """mapping.yaml has `bounds` for a field, but a `.options` file stands beside the `.proto` file of the field.

    nanopb reads only one `.options` file for each `.proto` file, so it would ignore the limits in one of the two
    places.

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
    """


class NanopbNotInstalled(Rule, id="NPB105", severity=Severity.FATAL):
    """The project has options for nanopb, but the package nanopb is not installed.

    The package defines the options. Without it, the largest size of a message on a microcontroller is unknown. This is
    a hint if no peer of the table has a `max_size`, because then only a smaller limit than before can be overlooked.

    Bad::

        $ roverlink lint     # proto/note.options is there, the package nanopb is not

    Good::

        $ pip install 'nanopb>=0.4.9,<0.5'
    """
