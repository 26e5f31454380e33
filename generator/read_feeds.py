"""What a row says of messages of ROS 2's common interfaces, as it stands in the file."""

from __future__ import annotations

from collections.abc import Mapping

from generator.diagnostics import Diagnostic
from generator.ir import Qos
from generator.table import FeedSettings, Form
from generator.table_rules import KEY_WITHOUT_STANDARD, WRONG_TYPE
from generator.yaml_scalars import Item

_KEYS = ("frame_id", "stamp", "unset")


def is_standard(ros: str) -> bool:
    """Whether a row's `ros` names a message of another package."""
    return "/" in ros


def read_feed(item: Item, qos: Qos) -> FeedSettings:
    """A topic with a standard message; ``item`` is an entry of `also`, or the row itself."""
    stamp = item.entries.get("stamp")
    return FeedSettings(
        item.span,
        item.spans(),
        topic=item.get("topic"),
        ros=item.get("ros"),
        qos=qos,
        frame_id=item.get("frame_id"),
        stamp=_form(stamp) if stamp else None,
        fields={path: _form(entry) for path, entry in item.entry("fields").entries.items()},
        unset=item.texts("unset"),
        ignore=item.texts("ignore"),
    )


def _form(item: Item) -> Form:
    if item.value is not None:
        return Form(item.span, item.value)
    if item.is_list:
        return Form(item.span, items=tuple(_form(one) for one in item.items))
    return Form(item.span, entries={name: _form(entry) for name, entry in item.entries.items()})


def read_renames(item: Item, findings: list[Diagnostic]) -> Mapping[str, str]:
    """The `fields` of a row whose message is of the table's own package; what belongs to others is a finding."""
    for key in _KEYS:
        if item.has(key):
            message = f"{key} is for standard messages, and the row's own message is none"
            help = "name a message with its package under `ros`, or put the key into an entry of `also`"
            findings.append(KEY_WITHOUT_STANDARD.at(item.entries[key].span, message, help))
    renames: dict[str, str] = {}
    for path, entry in item.entry("fields").entries.items():
        if isinstance(entry.value, str):
            renames[path] = entry.value
        else:
            message = f"fields.{path} is no string; in a message of our own it is the name of the ROS field"
            help = "a row with a standard message has its package in `ros`, as in sensor_msgs/Imu"
            findings.append(WRONG_TYPE.at(entry.span, message, help))
    return renames
