"""The definitions of the standard messages are those of the rosbags package, and what is said of them fits."""

from __future__ import annotations

import importlib
import pkgutil

import pytest

from roverlink.generator.emit.targets.python.interfaces import OF_THE_RUNTIME
from roverlink.generator.ir.interfaces import InterfaceType
from roverlink.generator.resolve import units
from roverlink.generator.resolve.interfaces import definitions, extract, meanings
from roverlink.generator.resolve.interfaces.definitions import DistributionsDisagreeError
from roverlink.runtime import interfaces
from roverlink.runtime.core.messages import Message, fields_of


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
    """The definitions in the repository are those of rosbags for Humble and Jazzy."""
    committed = definitions.FILE.read_text(encoding="utf-8")
    assert extract.text() == committed, "run python -m roverlink.generator.resolve.interfaces.extract"


def test_what_differs_needs_a_choice() -> None:
    """A message with a field of one distribution is an error, until that one is chosen; a constant is left out."""
    with pytest.raises(DistributionsDisagreeError, match="the field `float32 variance` of sensor_msgs/msg/Range"):
        definitions.interface("sensor_msgs/msg/Range", "")
    humble, jazzy = (definitions.interface("sensor_msgs/msg/Range", name) for name in definitions.DISTRIBUTIONS)
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


def _of_the_runtime() -> dict[str, type[Message]]:
    """Return the classes of `roverlink.runtime.interfaces` that are not of the node itself or of `vision`, by name."""
    others = {"builtin_interfaces", "rcl_interfaces", "rosgraph_msgs", "vision_msgs"}
    packages = {module.name for module in pkgutil.iter_modules(interfaces.__path__)} - others
    modules = [importlib.import_module(f"roverlink.runtime.interfaces.{package}") for package in packages]
    return {
        one.__msgtype__: one
        for module in modules
        for one in vars(module).values()
        if isinstance(one, type) and issubclass(one, Message) and one.__module__ == module.__name__
    }


def test_generated_code_takes_what_the_runtime_has() -> None:
    """The generator knows each class of the runtime, which has the fields and constants of every distribution."""
    classes = _of_the_runtime()
    assert classes.keys() == OF_THE_RUNTIME
    for name, one in classes.items():
        for distribution in ("", *definitions.DISTRIBUTIONS):
            interface = definitions.interface(name, distribution)
            assert interface is not None
            assert [field.name for field in fields_of(one)] == [field.name for field in interface.fields]
            assert all(getattr(one, constant.name) == constant.value for constant in interface.constants)
