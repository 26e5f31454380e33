"""Fields that need another number, because their number belonged to another field or was reserved."""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.lint.comparison.judged_changes import judge_pair
from roverlink.generator.lint.comparison.judgement import Meaning
from roverlink.generator.lint.comparison.oneof_changes import broken_by_oneof
from roverlink.generator.lint.comparison.pairing import FieldPair, MessagePair, fields_of_messages
from roverlink.generator.protos.number_ranges import covers, missing
from roverlink.generator.protos.schema import ProtoField


def misplaced_fields(pair: MessagePair) -> Iterator[ProtoField]:
    """Yield the new fields whose number belonged to another field before, or was reserved before."""
    # A number that was reserved once had another meaning, which only old boards still know.
    freed = [part for was in pair.old.reserved for part in missing(was, pair.new.reserved)]
    pairs = {field_pair.new.number: field_pair for field_pair in fields_of_messages(pair)}
    for field in sorted(pair.new.fields, key=lambda field: field.number):
        one = pairs.get(field.number)
        of_another = one is not None and (_is_another(one) or any(map(_is_another, _inside_of_map(one))))
        if of_another or covers(freed, field.number):
            yield field


def _is_another(pair: FieldPair) -> bool:
    return judge_pair(pair).meaning not in (Meaning.SAME, Meaning.RENAMED) or broken_by_oneof(pair)


def _inside_of_map(pair: FieldPair) -> Iterator[FieldPair]:
    """Yield the key and the value of a map field, each as it was before the change and as it is now.

    Yield nothing for other fields.
    """
    change = pair.change
    old, new = change.before.messages.get(pair.old.type_name), change.after.messages.get(pair.new.type_name)
    if old and new and new.map_entry and old.full_name == new.full_name:
        yield from fields_of_messages(MessagePair(change, old, new))
