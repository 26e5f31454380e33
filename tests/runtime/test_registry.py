"""Loading generated code, and telling whether it fits what else is loaded."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from generated import checks
from roverlink.runtime import Registry, RegistryError, load_registry
from roverlink.runtime.core import descriptor_check

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
        ("nothing", r"cannot be imported: .*/generated/registry\.py:1: NameError: "),
        ("import a_library_that_is_not_there", "cannot be imported: .*'a_library_that_is_not_there'"),
    ],
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


def test_an_enum_that_differs_and_what_is_not_loaded_are_told() -> None:
    """A value of another name or number, a message and an enum that are not loaded: each is a line."""
    name = "DrivingBoardDiagnostics.State"
    loaded = checks.ENUMS[name]
    with pytest.raises(RegistryError) as caught:
        descriptor_check.check_descriptors(
            {"tests.Nothing": ((1, "a", "bool"),)}, {name: (*loaded[:-1], (9, "ELSE")), "tests.NoEnum": ((0, "A"),)}
        )
    assert f"{name}: the generated code has '9 ELSE', the loaded module does not" in str(caught.value)
    assert f"{name}: the loaded module has '{loaded[-1][0]} {loaded[-1][1]}', the generated code does not" in str(
        caught.value
    )
    assert all(f"tests.{missing}: not loaded" in str(caught.value) for missing in ("Nothing", "NoEnum"))
