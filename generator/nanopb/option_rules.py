"""What can be wrong with nanopb's options."""

from __future__ import annotations

from generator.diagnostics import Rule, Severity

UNREADABLE_OPTIONS = Rule("NPB101", "unreadable-nanopb-options")
"""An option of nanopb's, in a .options file or in a .proto file, or the whole file, cannot be read."""

UNFIT_BOUND = Rule("NPB103", "unfit-bound")
"""A bound in the table is for no field, or for one that cannot have it."""

BOUNDS_IN_TWO_PLACES = Rule("NPB104", "bounds-in-two-places")
"""The table gives bounds to fields of a file that has a .options file of its own."""

PATTERN_WITHOUT_MATCH = Rule("NPB102", "nanopb-pattern-without-match", Severity.WARNING)
"""A line of a .options file is for nothing that its .proto file declares."""

NANOPB_MISSING = Rule("NPB105", "nanopb-not-installed", Severity.FATAL)
"""There are options of nanopb, and the package that says what they mean is not installed."""
