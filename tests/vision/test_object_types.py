"""The file classes.yaml, and the types of objects."""

from __future__ import annotations

from pathlib import Path

import pytest
from needs import NO_OPENCV

pytest.importorskip("cv2", reason=NO_OPENCV)

from roverlink.runtime.core.errors import SetupError
from roverlink.vision.objects.object_types import ClassesFile, ObjectTypes, read_classes

_NUMBERS = {"OBJECT_UNKNOWN": 0, "OBJECT_ROCK": 1, "OBJECT_MAIN_SWITCH": 3, "OBJECT_SWITCH": 5}


def _types(said: list[str], file: ClassesFile = ClassesFile(), *classes: str) -> ObjectTypes:  # noqa: B008  # frozen
    return ObjectTypes(file, _NUMBERS, classes, said.append)


@pytest.mark.parametrize(
    ("name", "number"),
    [("rock", 1), ("Rock", 1), ("OBJECT_ROCK", 1), ("main switch", 3), ("main-switch", 3), ("main_switch", 3)],
)
def test_a_class_has_the_type_of_its_name(name: str, number: int) -> None:
    """However it is written; the start that all types share may be left out."""
    said: list[str] = []
    assert _types(said).of(name) == number
    assert said == []


def test_a_class_without_a_type_is_unknown_and_told_once() -> None:
    """With what to do."""
    said: list[str] = []
    types = _types(said)
    assert [types.of(name) for name in ("dog", "dog", "cat", "rock")] == [0, 0, 0, 1]
    assert said == [
        f"objects of the class {name!r} are sent as unknown; add a line to the types in --classes FILE"
        for name in ("dog", "cat")
    ]


def test_the_file_names_classes_and_types(tmp_path: Path) -> None:
    """Names as a list, or as in the data.yaml of a YOLO data set."""
    path = tmp_path / "classes.yaml"
    for names in ("[stone, e-stop]", "{0: stone, 1: e-stop}"):
        path.write_text(f"names: {names}\ntypes: {{stone: OBJECT_ROCK, e-stop: OBJECT_MAIN_SWITCH}}\n")
        file = read_classes(path)
        assert file.names == ("stone", "e-stop")
        types = _types([], file, *file.names)
        assert [types.of(name) for name in file.names] == [1, 3]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("typs: {}", "1:1: the file has an unknown key 'typs'; did you mean 'types'?"),
        ("names: stone", "1:8: names is not a list of different names"),
        ("names: [a, a]", "1:8: names is not a list of different names"),
        ("names: [a, [b]]", "1:8: names is not a list of different names"),
        ("names: {1: a}", "1:8: the keys of names are not 0, 1, 2 and so on"),
        ("types: [a]", "1:8: types is not a mapping"),
        ("types:\n  rock: OBJECT_ROK", "2:9: type of rock is OBJECT_ROK; did you mean 'OBJECT_ROCK'?"),
        ("types:\n  rock: [1]", "2:9: type of rock is a list of 1;"),
        ("types:\n  rok: OBJECT_ROCK", "2:8: the detector has no class 'rok'; did you mean 'rock'?"),
    ],
)
def test_mistakes_are_located(tmp_path: Path, text: str, message: str) -> None:
    """With line and column, and what was meant."""
    path = tmp_path / "classes.yaml"
    path.write_text(text)
    with pytest.raises(SetupError) as raised:
        _types([], read_classes(path), "rock")
    assert str(raised.value).startswith(f"{path}:")
    assert message.split(":", 2)[2].strip() in str(raised.value)
    assert f"{path}:{message.split(':')[0]}:" in str(raised.value)
