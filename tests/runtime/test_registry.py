"""Loading generated code, and telling whether it fits what else is loaded."""

from __future__ import annotations

import dataclasses
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from google.protobuf import descriptor_pb2, descriptor_pool

from generated import checks
from generated.registry import REGISTRY
from roverlink.runtime import Registry, RegistryError, SetupError, load_registry
from roverlink.runtime.core import descriptor_check
from roverlink.runtime.core.registry import EndName
from roverlink.runtime.ros_arguments import parameters

_REPOSITORY = Path(__file__).parents[2]


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project elsewhere, with generated code of its own."""
    folder = tmp_path / "project"
    shutil.copytree(_REPOSITORY / "generated", folder / "generated", ignore=shutil.ignore_patterns("ros"))
    return folder


def _is_generated(module: str) -> bool:
    return module.partition(".")[0] == "generated"


@pytest.fixture
def unloaded(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A program that has no generated code yet."""
    ours = {name: module for name, module in sys.modules.items() if _is_generated(name)}
    monkeypatch.setattr(sys, "path", [*sys.path])
    for name in ours:
        del sys.modules[name]
    yield
    for name in [name for name in sys.modules if _is_generated(name)]:
        del sys.modules[name]
    sys.modules.update(ours)


def test_without_a_folder_the_import_path_decides(registry: Registry) -> None:
    """`load_registry()` takes the `generated` that is installed."""
    assert load_registry() is registry
    assert load_registry(_REPOSITORY) is registry


def test_a_folder_without_generated_code_is_named(tmp_path: Path) -> None:
    """Where nothing was generated, the error says where and what to do."""
    with pytest.raises(RegistryError, match=f"no generated code in {tmp_path}.*roverlink generate"):
        load_registry(tmp_path)


def test_the_code_of_another_project_is_not_mistaken_for_it(project: Path) -> None:
    """A program that has loaded one project's code does not go on with it when it is asked for another's."""
    with pytest.raises(RegistryError, match="generated code of another project is loaded already"):
        load_registry(project)


@pytest.mark.usefixtures("unloaded")
def test_a_project_is_loaded_by_its_folder(project: Path) -> None:
    """`load_registry(folder)` finds the generated code of that folder."""
    assert len(load_registry(project).handlers) == 21
    assert Path(str(sys.modules["generated.registry"].__file__)).is_relative_to(project)


@pytest.mark.usefixtures("unloaded")
@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("import generated.handlers.nothing", r"no generated code in .*generated\.handlers\.nothing"),
        ("REGISTRY = 1", "is not a Registry"),
        ("REGISTRY = ", r"registry\.py"),
        ("pass", "REGISTRY"),
        ("from roverlink.runtime.core.handler import Nothing", "Nothing"),
        ("from google.protobuf.runtime_version import VersionError; raise VersionError('too old')", "too old"),
        ("import a_library_that_is_not_there", "cannot be imported: .*'a_library_that_is_not_there'"),
    ],
    ids=["half of it", "no registry", "syntax error", "nothing", "older runtime", "newer protobuf", "no library"],
)
def test_code_that_does_not_load_is_told(project: Path, text: str, expected: str) -> None:
    """Whatever is wrong with the generated code, it is one error with what to do, and no traceback."""
    (project / "generated" / "registry.py").write_text(text)
    with pytest.raises(RegistryError, match=f"{expected}.*; run `roverlink generate`"):
        load_registry(project)


@pytest.mark.usefixtures("unloaded")
def test_modules_of_another_commit_are_found_at_start(project: Path) -> None:
    """Where the protobuf modules that load are not those of the generation, loading fails and lists each difference."""
    module, field = project / "generated" / "checks.py", '(1, "accel_x", "float")'
    text = module.read_text()
    assert field in text
    module.write_text(text.replace(field, field.replace("float", "double"), 1))
    with pytest.raises(RegistryError) as caught:
        load_registry(project)
    name = "SensorBoardIMUInfo"
    assert f"{name}: the generated code has '1 accel_x double', the loaded module does not" in str(caught.value)
    assert f"{name}: the loaded module has '1 accel_x float', the generated code does not" in str(caught.value)


# --- descriptors ------------------------------------------------------------------------------------------------

_FIELD = descriptor_pb2.FieldDescriptorProto


@pytest.fixture(scope="module", autouse=True)
def _private_messages() -> None:
    """Messages of the tests' own, in the pool that the check looks in."""
    file = descriptor_pb2.FileDescriptorProto(name="tests/private.proto", package="tests", syntax="proto3")
    part = file.message_type.add(name="Part")
    part.field.add(name="text", number=1, type=_FIELD.TYPE_STRING, label=_FIELD.LABEL_OPTIONAL)
    whole = file.message_type.add(name="Whole")
    whole.enum_type.add(name="Mode").value.add(name="OFF", number=0)
    whole.field.add(name="later", number=9, type=_FIELD.TYPE_SINT32, label=_FIELD.LABEL_OPTIONAL)
    whole.field.add(name="parts", number=2, type_name=".tests.Part", label=_FIELD.LABEL_REPEATED)
    whole.field.add(name="mode", number=1, type_name=".tests.Whole.Mode", label=_FIELD.LABEL_OPTIONAL)
    whole.field.add(name="numbers", number=3, type=_FIELD.TYPE_FIXED64, label=_FIELD.LABEL_REPEATED)
    descriptor_pool.Default().Add(file)


_WHOLE = (
    (1, "mode", "tests.Whole.Mode"),
    (2, "parts", "repeated tests.Part"),
    (3, "numbers", "repeated fixed64"),
    (9, "later", "sint32"),
)


def test_a_message_is_described_by_number_name_and_type() -> None:
    """Fields come in the order of their numbers, in the words of a .proto."""
    assert descriptor_check.describe(descriptor_pool.Default().FindMessageTypeByName("tests.Whole")) == _WHOLE
    descriptor_check.check_descriptors({"tests.Whole": _WHOLE, "tests.Part": ((1, "text", "string"),)}, {})


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        (_WHOLE[:3], ["the loaded module has '9 later sint32', the generated code does not"]),
        ((*_WHOLE, (10, "more", "bool")), ["the generated code has '10 more bool', the loaded module does not"]),
        (
            (*_WHOLE[:2], (3, "numbers", "fixed64"), _WHOLE[3]),
            ["the generated code has '3 numbers fixed64'", "the loaded module has '3 numbers repeated fixed64'"],
        ),
        *(
            (
                (*_WHOLE[:3], (number, name, kind)),
                [f"the generated code has '{number} {name} {kind}'", "the loaded module has '9 later sint32'"],
            )
            for number, name, kind in ((8, "later", "sint32"), (9, "after", "sint32"), (9, "later", "int32"))
        ),
    ],
    ids=["one more", "one less", "not repeated", "other number", "other name", "other encoding"],
)
def test_each_disagreement_is_told(fields: descriptor_check.Fields, expected: list[str]) -> None:
    """A field more or less, another number, name, label or type: the message, and each difference, are named."""
    with pytest.raises(RegistryError) as caught:
        descriptor_check.check_descriptors({"tests.Whole": fields, "tests.Part": ((1, "text", "string"),)}, {})
    for line in expected:
        assert f"tests.Whole: {line}" in str(caught.value)
    assert "tests.Part:" not in str(caught.value)
    assert str(caught.value).count("tests.Whole:") == len(expected)
    assert "roverlink generate" in str(caught.value)


def test_a_message_that_is_not_loaded_is_told() -> None:
    """A message that is missing altogether is one line, among those of the others."""
    with pytest.raises(RegistryError, match=r"tests\.Nothing: not loaded[^$]*tests\.Whole"):
        descriptor_check.check_descriptors({"tests.Nothing": ((1, "a", "bool"),), "tests.Whole": ()}, {})


def test_an_enum_that_differs_is_told() -> None:
    """A value of another name or number, and an enum that is not loaded: each is a line."""
    name = "DrivingBoardDiagnostics.State"
    loaded = checks.ENUMS[name]
    with pytest.raises(RegistryError) as caught:
        descriptor_check.check_descriptors({}, {name: (*loaded[:-1], (9, "ELSE")), "tests.NoEnum": ((0, "A"),)})
    assert f"{name}: the generated code has '9 ELSE', the loaded module does not" in str(caught.value)
    assert f"{name}: the loaded module has '{loaded[-1][0]} {loaded[-1][1]}', the generated code does not" in str(
        caught.value
    )
    assert "tests.NoEnum: not loaded" in str(caught.value)


# --- the registry -----------------------------------------------------------------------------------------------


def test_every_handler_is_found_by_number_name_and_topic(registry: Registry) -> None:
    """The look-ups lead to the same handlers, one for each of the table's rows."""
    assert len(registry.handlers) == 21
    for handler in registry.handlers:
        route = handler.route
        assert registry.by_number[route.number] is handler
        assert registry.by_name[route.name] is handler
        assert registry.by_topic[route.topic] is handler
        assert route.peer in registry.peers_by_name
        assert route.inbound == (route.direction == f"{route.peer}_to_ros")


def test_the_envelope_has_each_handler_under_its_number(registry: Registry) -> None:
    """Number, name and type of each payload are those of the envelope's oneof."""
    fields = registry.envelope.DESCRIPTOR.oneofs_by_name[registry.oneof].fields
    assert {(f.number, f.name, f.message_type) for f in fields} == {
        (h.route.number, h.route.name, h.payload_type.DESCRIPTOR) for h in registry.handlers
    }


# --- parameters -------------------------------------------------------------------------------------------------


def test_the_defaults_are_those_of_the_contract(registry: Registry) -> None:
    """Ports and policy of a node that was given nothing."""
    read = parameters.read(registry, {})
    assert (read.listen_port, read.dst_ip, read.forward_policy) == (5000, "127.0.0.1", "mapping")
    assert read.addresses == {
        EndName("basestation"): (("127.0.0.1",), 6000),
        EndName("hardware"): (("127.0.0.1",), 6001),
    }


def test_given_parameters_are_taken(registry: Registry) -> None:
    """Each parameter that is given replaces its default; those that every node has change nothing."""
    given = {
        "listen_port": 0,
        "listen_address": "127.0.0.1",
        "dst_ip": "rover.local",
        "dst_a_port": 1,
        "dst_b_port": 65_535,
        "forward_policy": "all",
        "source_policy": "any",
        "max_datagram": 65_507,
        "receive_buffer": 1,
    }
    assert set(given) == set(parameters.defaults(registry))
    read = parameters.read(registry, {**given, "use_sim_time": True, "start_type_description_service": True})
    assert [address.port for address in read.addresses.values()] == [1, 65_535]
    for name, value in given.items():
        assert name in ("dst_a_port", "dst_b_port") or getattr(read, name) == value


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("listen_prt", 5000, "unknown parameter 'listen_prt'; did you mean 'listen_port'?"),
        ("zzz", 1, "unknown parameter 'zzz'; known: listen_port, listen_address, dst_ip"),
        ("listen_port", "5000", "'listen_port' is '5000'; it must be of type int"),
        ("listen_port", True, "'listen_port' is True; it must be of type int"),
        ("listen_port", 5000.0, "'listen_port' is 5000.0; it must be of type int"),
        ("dst_ip", None, "'dst_ip' is None; it must be of type str"),
        ("listen_port", 65_536, "'listen_port' is 65536; a UDP port is a number from 1 to 65535"),
        ("listen_port", -1, "'listen_port' is -1"),
        ("dst_a_port", 0, "'dst_a_port' is 0; a UDP port is a number from 1 to 65535"),
        ("forward_policy", "none", "'forward_policy' is 'none'; it must be one of mapping, all"),
        ("max_datagram", 0, "'max_datagram' is 0; a UDP datagram has 1 to 65507 bytes"),
        ("max_datagram", 65_508, "'max_datagram' is 65508"),
        ("receive_buffer", 0, "'receive_buffer' is 0; it must be from 1 to"),
        ("receive_buffer", 2**31, "'receive_buffer' is 2147483648"),
    ],
)
def test_a_wrong_parameter_is_told(registry: Registry, name: str, value: object, expected: str) -> None:
    """A name that is not known, a value of another type, a value that cannot be: each is named with what could be."""
    with pytest.raises(SetupError) as caught:
        parameters.read(registry, {name: value})
    assert expected in str(caught.value)


def test_the_ports_are_named_by_the_table(registry: Registry) -> None:
    """A peer's port parameter and its default are the table's, whatever they are."""
    peers = (dataclasses.replace(REGISTRY.peers[0], name="moon", port_parameter="moon_port", port=7000),)
    read = parameters.read(dataclasses.replace(registry, peers=peers), {})
    assert read.addresses == {EndName("moon"): (("127.0.0.1",), 7000)}
