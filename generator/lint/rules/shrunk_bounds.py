"""Rules about nanopb's options: bounds that are stricter than before, and lines without effect."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from roverlink.generator.diagnostics import Diagnostic, Severity
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.rules import LintRule
from roverlink.generator.nanopb import FieldBounds
from roverlink.generator.protos.schema import ProtoField, ProtoMessage
from roverlink.numerals import counted

_BITS = {"int32": 32, "sint32": 32, "uint32": 32, "int64": 64, "sint64": 64, "uint64": 64}


class _Bounded(NamedTuple):
    """A field, and the options of nanopb that limit its size."""

    field: ProtoField
    given: FieldBounds

    @property
    def capacity(self) -> int | None:
        """The largest number of bytes in a string or `bytes` field; None without a limit.

        The zero byte that C adds to a string is not counted.
        """
        if self.field.type != "string":
            return self.given.max_size
        if self.given.max_length is not None:
            return self.given.max_length
        return None if self.given.max_size is None else self.given.max_size - 1

    @property
    def bits(self) -> int | None:
        """Number of bits of an integer; None for other types."""
        return self.given.int_size or _BITS.get(self.field.type)


class BoundShrank(LintRule, id="FIX103"):
    """A field accepts less than before, because a nanopb option that limits its size was changed.

    Older senders still send as much as the old limit allowed. nanopb does not shorten such a value: it rejects the
    whole message, and the board never sees it. With a fixed length or count, nanopb also rejects every shorter value.

    Bad::

        # note.options, where it said `Note.text max_length:20` before
        Note.text max_length:16

    Good::

        # note.options
        Note.text max_length:24
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each field that has a smaller size limit than in the earlier state."""
        if context.bounds is None:
            return
        for change in context.changes:
            if change.bounds_before is None:
                continue
            for message in context.schema.messages.values():
                before = change.before.messages.get(message.full_name)
                earlier = {field.number: field for field in before.fields} if before else {}
                for field in message.fields:
                    if old := earlier.get(field.number):
                        now = _Bounded(field, context.bounds.of_field(message.full_name, field.name))
                        yield from _check(
                            message, now, _Bounded(old, change.bounds_before.of_field(message.full_name, old.name))
                        )


def _check(message: ProtoMessage, now: _Bounded, before: _Bounded) -> Iterator[Diagnostic]:
    for option, text in (*_shrunk_size(now, before), *_shrunk_count(now, before), *_shrunk_integer(now, before)):
        yield BoundShrank.at(
            now.given.places.get(option, now.field.span),
            f"'{message.full_name}.{now.field.name}' accepts {text} before",
            f"put back the old value of `{option}`, or add a new field with a new number",
            [(before.given.places.get(option, before.field.span), "the earlier limit is here")],
            type=message.full_name,
            number=now.field.number,
        )


_Shrunk = tuple[str, str]  # the option, and a text about the values that the field accepts


def _shrunk_size(now: _Bounded, before: _Bounded) -> Iterator[_Shrunk]:
    size, earlier = now.capacity, before.capacity
    if now.given.fixed_length and size is not None and (size != earlier or not before.given.fixed_length):
        accepted = _at_most(earlier, before.given.fixed_length)
        yield "fixed_length", f"exactly {counted(size, 'byte')} now; it accepted {accepted}"
    elif size is not None and _is_less(size, earlier):
        option = "max_length" if now.given.max_length is not None else "max_size"
        yield option, f"at most {counted(size, 'byte')} now; it accepted {earlier}"


def _shrunk_count(now: _Bounded, before: _Bounded) -> Iterator[_Shrunk]:
    count, earlier = now.given.max_count, before.given.max_count
    if now.given.fixed_count and count is not None and (count != earlier or not before.given.fixed_count):
        accepted = _at_most(earlier, before.given.fixed_count)
        yield "fixed_count", f"exactly {counted(count, 'value')} now; it accepted {accepted}"
    elif count is not None and _is_less(count, earlier):
        yield "max_count", f"at most {counted(count, 'value')} now; it accepted {earlier}"


def _shrunk_integer(now: _Bounded, before: _Bounded) -> Iterator[_Shrunk]:
    if now.given.int_size and _is_less(now.bits, before.bits):
        yield "int_size", f"{now.bits} bits now; it accepted {before.bits}"


def _at_most(bound: int | None, fixed: bool) -> str:
    if bound is None:
        return "any number"
    return str(bound) if fixed else f"up to {bound}"


def _is_less(now: int | None, before: int | None) -> bool:
    """Return True if a size limit is smaller than before. A field that had no limit before does not count.

    It is allowed to add a limit, because every field needs one before a board can use it.
    """
    return now is not None and before is not None and now < before


class NanopbPatternWithoutMatch(LintRule, id="NPB102", severity=Severity.WARNING):
    """A line of a `.options` file matches no declaration of its `.proto` file.

    The size limit in the line has no effect. The field was renamed, or the package is missing from the name.

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
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each line of a .options file that matches no declaration."""
        for file, pattern, span in context.bounds.unused if context.bounds else ():
            help = "write the full name, with the package: pkg.Message.field"
            yield cls.at(span, f"no name in {file} matches {pattern!r}", help)
