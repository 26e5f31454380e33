"""The definitions of the standard messages are those of the rosbags package, and what is said of them fits."""

from __future__ import annotations

import importlib

import pytest

from roverlink.generator.emit.targets.python import runtime_interfaces
from roverlink.generator.emit.targets.python.interfaces import OF_THE_RUNTIME
from roverlink.generator.ir.interfaces import InterfaceType
from roverlink.generator.resolve import units
from roverlink.generator.resolve.interfaces import definitions, extract, meanings
from roverlink.generator.resolve.interfaces.definitions import DistributionsDisagreeError


def _type_at(message: str, path: str) -> InterfaceType | None:
    """The type of a field, in any distribution."""
    for distribution in definitions.DISTRIBUTIONS:
        name, type = message, None
        for part in path.split("."):
            interface = definitions.interface(name, distribution)
            fields = {field.name: field.type for field in interface.fields} if interface else {}
            type = fields.get(part)
            name = type.name if type else ""
        if type:
            return type
    return None


def test_the_file_is_what_rosbags_says() -> None:
    """The definitions in the repository are those of rosbags; each distribution has its fields in its own order."""
    committed = definitions.FILE.read_text(encoding="utf-8")
    assert extract.text() == committed, "run python -m roverlink.generator.resolve.interfaces.extract"
    for distribution in definitions.DISTRIBUTIONS:
        stored = importlib.import_module(f"rosbags.typesys.stores.ros2_{distribution}").FIELDDEFS
        for name, (_, fields) in stored.items():
            if "/msg/" in name and (found := definitions.interface(name, distribution)):
                names = [field for field, _ in fields if field != "structure_needs_at_least_one_member"]
                assert [field.name for field in found.fields] == names, (name, distribution)


def test_what_differs_needs_a_choice() -> None:
    """A message with a field of one distribution is an error, until that one is chosen; a constant is left out."""
    with pytest.raises(DistributionsDisagreeError, match="the field `float32 variance` of sensor_msgs/msg/Range"):
        definitions.interface("sensor_msgs/msg/Range", "")
    humble, jazzy = (definitions.interface("sensor_msgs/msg/Range", name) for name in ("humble", "jazzy"))
    assert humble is not None
    assert jazzy is not None
    assert [field.name for field in jazzy.fields] == [*(field.name for field in humble.fields), "variance"]
    both = definitions.interface("sensor_msgs/msg/NavSatStatus", "")
    assert both is not None
    assert "STATUS_UNKNOWN" not in [constant.name for constant in both.constants]


def test_what_is_known_is_about_fields() -> None:
    """Each field of which something is known exists; one with a unit holds numbers, and its unit is one."""
    for table in (meanings.ZERO_MEANS, meanings.ABSENT_WHERE_MINUS_ONE, meanings.UNITS):
        assert [(name, path) for name, known in table.items() for path in known if _type_at(name, path) is None] == []
    for message, of_fields in meanings.UNITS.items():
        for path, unit in of_fields.items():
            type = _type_at(message, path)
            assert type
            assert type.is_message or type.name.startswith("float"), path
            units.parse(unit)


@pytest.mark.slow
def test_the_classes_of_the_runtime_are_current() -> None:
    """The modules of runtime/interfaces are what the definitions say."""
    for path, text in runtime_interfaces.texts():
        assert path.read_text(encoding="utf-8") == text, "run make generate"


def test_the_messages_of_the_runtime_are_those_of_every_distribution() -> None:
    """Their fields are the same in all, and the newest one, whose definitions the classes have, has all constants."""
    for name in OF_THE_RUNTIME:
        assert definitions.interface(name, "") is not None  # else, it raises an error
        newest = definitions.interface(name, definitions.DISTRIBUTIONS[-1])
        assert newest is not None
        for distribution in definitions.DISTRIBUTIONS:
            own = definitions.interface(name, distribution)
            assert own is not None
            assert {*own.constants} <= {*newest.constants}
