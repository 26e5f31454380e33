"""The cache of a history's states: it saves reading, and whatever is wrong with it changes nothing else."""

from __future__ import annotations

from pathlib import Path

import pytest
from repositories import RepositoryBuilder, envelope

from roverlink import user_cache
from roverlink.generator.lint.history import History, blob_cache, proto_history, read_history

_FILE = "envelope.proto"


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """A repository in which a number has two usages, one of them in a broken state."""
    builder = RepositoryBuilder(tmp_path / "repository")
    builder.commit("Begin", {_FILE: envelope("Imu imu = 1;")})
    builder.commit("Break", {_FILE: envelope("// Old old = 7;", "Gps gps = 1;", "Ph ph 2;")})
    return builder.write()


@pytest.fixture
def cache_file(repository: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The cache of the repository, after its history was read once."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    read_history(repository)
    (file,) = (tmp_path / "cache" / "roverlink" / "history").iterdir()
    return file


@pytest.fixture
def parsed(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The texts that are parsed."""
    texts: list[str] = []
    parse = proto_history.parse
    monkeypatch.setattr(proto_history, "parse", lambda text: (texts.append(text), parse(text))[1])
    return texts


def _said(found: History) -> object:
    return [
        (number, usages) for ask in (found.numbers, found.claims) for number, usages in ask("PBEnvelope").items()
    ] + list(found.reuses("PBEnvelope"))


def test_no_state_is_parsed_twice(repository: Path, cache_file: Path, parsed: list[str]) -> None:
    """The second run says what the first said, without parsing; a new state is parsed alone."""
    first = _said(read_history(repository))
    assert cache_file.is_file()
    assert parsed == []
    cache_file.unlink()
    assert _said(read_history(repository)) == first
    assert len(parsed) == 2


@pytest.mark.parametrize("damage", [b"", b"x", b"{}", b"\x80\x04N.", b"0" * 64 + b"\n{}"])
def test_a_damaged_cache_is_read_again(
    repository: Path, cache_file: Path, parsed: list[str], monkeypatch: pytest.MonkeyPatch, damage: bytes
) -> None:
    """A cache that is cut short, is none, or is of another version is replaced."""
    whole = cache_file.read_bytes()
    for content in (damage, whole[:-9], whole + b" ", whole[1:]):
        parsed.clear()
        cache_file.write_bytes(content)
        read_history(repository)
        assert len(parsed) == 2
        assert cache_file.read_bytes() == whole
    parsed.clear()
    monkeypatch.setattr(blob_cache, "_version", lambda: b"another")
    read_history(repository)
    assert len(parsed) == 2
    assert cache_file.read_bytes() != whole


def test_no_cache_can_be_written(repository: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where there is a file in the place of the folder, or a folder in the place of the file, history is read."""
    (tmp_path / "cache").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    first = _said(read_history(repository))
    (tmp_path / "cache").unlink()
    read_history(repository)
    (file,) = (tmp_path / "cache" / "roverlink" / "history").iterdir()
    file.unlink()
    file.mkdir()
    assert _said(read_history(repository)) == first


def test_the_cache_is_bounded(repository: Path, cache_file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Files that were not used for long are removed, and a cache that is too large is not written."""
    other = cache_file.with_name("other.json")
    cache_file.rename(other)
    monkeypatch.setattr(user_cache, "_LARGEST", other.stat().st_size + 10)
    read_history(repository)
    assert (cache_file.is_file(), other.exists()) == (True, False)
    cache_file.unlink()
    monkeypatch.setattr(user_cache, "_LARGEST", 100)
    read_history(repository)
    assert not cache_file.exists()
