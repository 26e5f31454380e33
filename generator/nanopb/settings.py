"""Options that hold somewhere, each with the place where it was said."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from generator.diagnostics import Span
from generator.nanopb.bounds import FieldBounds
from generator.nanopb.options import Value, Values


@dataclass(frozen=True, slots=True)
class Settings:
    """The options that are set."""

    values: Values = field(default_factory=dict)
    said: Mapping[str, Span] = field(default_factory=dict)

    def with_(self, values: Values, span: Span) -> Settings:
        """These, but for what is said at a place."""
        if not values:
            return self
        return Settings({**self.values, **values}, {**self.said, **dict.fromkeys(values, span)})

    def number(self, name: str) -> int | None:
        """An option that is a number; ``None`` where it is not set."""
        value = self.values.get(name)
        return value if isinstance(value, int) else None

    def text(self, name: str) -> str:
        """An option that is a text, or one of some names; empty where it is not set."""
        value: Value | None = self.values.get(name)
        return value if isinstance(value, str) else ""

    def on(self, name: str) -> bool:
        """Whether an option that is off by default is on."""
        return bool(self.values.get(name))

    def of_field(self, left_out: bool) -> FieldBounds:
        """What they come to for a field; for other reasons than its type, nanopb may leave it out."""
        bits = self.text("int_size").removeprefix("IS_")
        return FieldBounds(
            max_size=self.number("max_size"),
            max_length=self.number("max_length"),
            max_count=self.number("max_count"),
            fixed_length=self.on("fixed_length"),
            fixed_count=self.on("fixed_count"),
            type=self.text("type") or FieldBounds().type,
            fallback_type=self.text("fallback_type") or FieldBounds().fallback_type,
            int_size=int(bits) if bits.isdigit() else 0,
            type_override=self.text("type_override").removeprefix("TYPE_").lower(),
            label_override=self.text("label_override").removeprefix("LABEL_").lower(),
            ignored=left_out or self.text("type") == "FT_IGNORE",
            said=self.said,
        )
