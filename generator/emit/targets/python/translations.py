"""Generated file ``translations.json``: the conversions of all rows and extra topics as data, for the native core.

The handlers hold the same conversions as code, and define them. The runtime makes the native core's table from this
file, from the protobuf descriptors and from the classes of the ROS messages.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from fractions import Fraction
from typing import Any

from roverlink.generator import ir
from roverlink.generator.emit.arithmetic import Step, steps, steps_back
from roverlink.generator.emit.render import Files
from roverlink.generator.ir.interfaces import (
    BoardTime,
    Chosen,
    Constant,
    Moment,
    Parts,
    Recovered,
    Rotation,
    Taken,
    TargetField,
    Unset,
)
from roverlink.generator.ir.model import ConversionKind

Json = dict[str, Any]

_NANOSECONDS = 1_000_000_000  # in a second


def emit(bridge: ir.Bridge) -> Files:
    """Yield the file."""
    content = {
        "messages": {ros: _conversion(conversion) for ros, conversion in sorted(bridge.conversions().items())},
        "topics": [
            {"number": route.number, "topic": standard.topic, **_standard(standard)}
            for route in bridge.routes
            for standard in route.standard_topics
        ],
    }
    yield "generated/translations.json", json.dumps(content, indent=1, ensure_ascii=False) + "\n"


# --- messages of the package ------------------------------------------------------------------------------------


def _conversion(conversion: ir.Conversion) -> list[Json]:
    return [_field(field) for field in conversion.fields]


def _field(field: ir.FieldConversion) -> Json:
    made: Json = {"ros": field.ros.name, "proto": ".".join(field.proto_path)}
    if field.entry is not None:
        made["entry"] = {"ros": field.entry.ros, "key": _field(field.entry.key), "value": _field(field.entry.value)}
        return made
    if field.kind is not ConversionKind.VALUE:
        made["kind"] = field.kind.name.lower()
    if field.repeated:
        made["repeated"] = True
    if field.wrapping:
        made["wrapping"] = field.wrapping.field
    made |= {key: getattr(field, key) for key in ("converter", "member", "presence", "which") if getattr(field, key)}
    if field.choices:
        made["choices"] = {choice.proto: choice.constant for choice in field.choices}
    return made


# --- standard messages ------------------------------------------------------------------------------------------


def _standard(standard: ir.StandardTopic) -> Json:
    back = None if standard.obstacle else [_recovered(recovered) for recovered in standard.recovered]
    return {"fields": [_target(field) for field in standard.fields if not isinstance(field.value, Unset)], "back": back}


def _target(field: TargetField) -> Json:
    value, made = field.value, {"ros": field.name}
    if isinstance(value, Parts):
        parts = [_target(part) for part in value.fields if not isinstance(part.value, Unset)]
        return {**made, "parts": parts}
    if isinstance(value, Rotation):
        return {**made, "rotation": [_number(part) for part in (value.roll, value.pitch, value.yaw)]}
    if isinstance(value, Moment):
        return {**made, "moment": _moment(value)}
    return made if isinstance(value, Unset) else {**made, **_number(value)}


def _number(value: Taken | Chosen | Constant) -> Json:
    if isinstance(value, Constant):
        return {"constant": value.value}
    made: Json = {"from": value.source.dotted}
    if value.default is not None:
        made["otherwise"] = value.default.value
    if isinstance(value, Chosen):
        return {**made, "cases": [[case.number, case.counterpart.value] for case in value.cases]}
    whole = value.source.is_integer and value.scaling.is_whole
    return made | _flags(steps(value.scaling, whole=whole), round=value.rounded)


def _moment(value: Moment) -> Json:
    if isinstance(value, BoardTime):
        return {"counter": value.counter.dotted}
    if value.source is None:
        return {}
    whole = value.source.is_integer and value.nanoseconds.denominator == 1
    scaled = () if value.nanoseconds == 1 else (Step("*", value.nanoseconds, whole),)
    return {"from": value.source.dotted, **_flags(scaled, round=not whole)}


def _flags(found: Iterable[Step], **flags: bool) -> Json:
    listed = [[step.operator, step.value] for step in found]
    return {**({"steps": listed} if listed else {}), **{name: True for name, value in flags.items() if value}}


def _recovered(recovered: Recovered) -> Json:
    value, made = recovered.value, {"ros": ".".join(recovered.path)}
    if isinstance(value, Rotation):
        parts = (value.roll, value.pitch, value.yaw)
        return {**made, "rotation": [_back(part, "float64") if isinstance(part, Taken) else None for part in parts]}
    if isinstance(value, Taken):
        return {**made, **_back(value, recovered.type.name)}
    if isinstance(value, Chosen):
        return {**made, "to": value.source.dotted, "cases": _inverse(value)}
    return {**made, "moment": _time_back(value)}


def _back(value: Taken, type: str) -> Json:
    source, scaling = value.source, value.scaling
    whole = source.is_integer and scaling.is_whole and abs(scaling.factor) == 1 and not type.startswith("float")
    single = source.type == "float32" and (type == "float64" or not scaling.is_identity)
    flags = _flags(steps_back(scaling, whole=whole), round=source.is_integer and not whole, single=single)
    return {"to": source.dotted, **flags}


def _inverse(value: Chosen) -> list[list[Any]]:
    return [[case.counterpart.value, case.number] for case in value.cases]


def _time_back(value: Moment) -> Json:
    source, divisor = value.source, value.nanoseconds
    if source is None:
        return {}
    made = {"to": source.dotted}
    if divisor == 1:
        return made
    if source.is_integer and divisor.denominator == 1:
        return made | _flags([Step("//", divisor, whole=True)])
    return made | _flags([Step("/", Fraction(divisor))], round=source.is_integer)
