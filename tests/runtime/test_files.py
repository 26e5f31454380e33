"""Files that are written whole or not at all."""

from __future__ import annotations

from pathlib import Path

import pytest

from roverlink.runtime.atomic_files import replacing, write_whole


def _fail_midway(path: Path) -> None:
    with replacing(path) as part:
        part.write_bytes(b"ne")
        assert path.read_bytes() == b"old"
        raise ValueError("half of it")


def test_a_file_is_replaced_only_when_all_is_written(tmp_path: Path) -> None:
    """Until then it is as it was, and for good where writing fails or nothing was written; nothing else is left."""
    path = tmp_path / "file"
    write_whole(path, b"old")
    with pytest.raises(ValueError, match="half"):
        _fail_midway(path)
    assert path.read_bytes() == b"old"
    with replacing(path):
        pass
    assert path.read_bytes() == b"old"
    with replacing(path) as part:
        part.write_bytes(b"new")
    assert path.read_bytes() == b"new"
    assert list(tmp_path.iterdir()) == [path]


def test_links_and_devices_stay_what_they_are(tmp_path: Path) -> None:
    """What a link leads to is replaced; a device is written to."""
    path, link = tmp_path / "file", tmp_path / "link"
    link.symlink_to(path)
    write_whole(link, b"new")
    assert link.is_symlink()
    assert path.read_bytes() == b"new"
    with replacing(Path("/dev/null")) as part:
        assert part == Path("/dev/null")
