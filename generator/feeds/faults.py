"""What can be wrong with a mapping to a standard message."""

from __future__ import annotations

from generator.diagnostics import Rule

UNKNOWN_MESSAGE = Rule("STD102", "unknown-standard-message")
DISTRIBUTIONS_DISAGREE = Rule("STD103", "distributions-disagree")
UNKNOWN_TARGET = Rule("STD104", "unknown-target-field")
UNKNOWN_SOURCE = Rule("STD105", "unknown-source-field")
UNSET_TARGET = Rule("STD106", "target-field-unset")
UNUSED_SOURCE = Rule("STD107", "source-field-unused")
SET_TWICE = Rule("STD108", "target-field-set-twice")
WRONG_FORM = Rule("STD109", "mapping-does-not-fit")
UNKNOWN_UNIT = Rule("STD110", "unknown-unit")
UNIT_MISSING = Rule("STD111", "unit-missing")
DIMENSION = Rule("STD112", "dimension-does-not-fit")
NARROWING = Rule("STD113", "lossy-narrowing")
FRAME_ID_MISSING = Rule("STD114", "frame-id-missing")
ENUM_TABLE = Rule("STD115", "enum-table-incomplete")
UNKNOWN_VALUE = Rule("STD116", "unknown-enum-value")
ABSENCE_UNSAID = Rule("STD117", "absence-unsaid")
NO_WAY_BACK = Rule("STD118", "no-way-back")
