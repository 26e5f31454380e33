"""The ledger's wire schema, as far as it goes, in the words in which the protos of today are known."""

from __future__ import annotations

from generator import ir
from generator.ledger.model import Ledger, Number, Owner
from generator.protos import ProtoEnum, ProtoEnumValue, ProtoField, ProtoMessage, Schema


def as_schema(ledger: Ledger) -> Schema:
    """What could travel as of the last generate. What the ledger does not hold is empty: files, JSON names, options."""
    return Schema(
        files=(),
        messages={name: _message(name, owner, ledger) for name, owner in ledger.messages.items()},
        enums={name: _enum(name, owner) for name, owner in ledger.enums.items()},
    )


def _message(name: str, owner: Owner, ledger: Ledger) -> ProtoMessage:
    fields = [
        _field(number, number.fact, ledger)
        for number in owner.numbers
        if isinstance(number.fact, ir.WireField) and not number.gone
    ]
    return ProtoMessage(
        span=owner.span,
        places=owner.places,
        comment="",
        options=b"",
        full_name=name,
        file="",
        fields=tuple(fields),
        oneofs=tuple(dict.fromkeys(field.oneof for field in fields if field.oneof)),
        map_entry=False,
        extension_ranges=(),
        reserved=tuple(owner.reserved),
        reserved_names=tuple(owner.reserved_names),
        facets={},
    )


def _field(number: Number, fact: ir.WireField, ledger: Ledger) -> ProtoField:
    kind = "message" if fact.type in ledger.messages else "enum" if fact.type in ledger.enums else ""
    always_optional = not fact.label and (kind == "message" or fact.oneof)
    return ProtoField(
        span=number.span,
        places={},
        comment="",
        options=b"",
        number=fact.number,
        name=fact.name,
        type=kind or fact.type,
        type_name=fact.type if kind else "",
        label="optional" if always_optional else fact.label,
        declared_optional=False,
        oneof=fact.oneof,
        json_name="",
        facets={},
    )


def _enum(name: str, owner: Owner) -> ProtoEnum:
    return ProtoEnum(
        span=owner.span,
        places=owner.places,
        comment="",
        options=b"",
        full_name=name,
        file="",
        values=tuple(
            ProtoEnumValue(number.span, {}, "", b"", number.fact.name, number.fact.number)
            for number in owner.numbers
            if not number.gone
        ),
        reserved=tuple(owner.reserved),
        reserved_names=tuple(owner.reserved_names),
    )
