"""Sources of packages from git repositories: the files that the extraction reads, at one commit."""

from __future__ import annotations

import subprocess
from collections.abc import Collection
from pathlib import Path

from check_launch.catalogue.facts import Source

SUFFIXES = frozenset({".cpp", ".cc", ".hpp", ".h", ".py", ".cmake", ".cfg", ".txt", ".xml", ".yaml", ".yml"})


def exported(repository: Path, name: str, ref: str, folder: Path, suffixes: Collection[str] = SUFFIXES) -> Source:
    """Write the files of a commit into a folder, and return what the catalogue says about their source.

    Raises `subprocess.CalledProcessError` if the repository has no such commit.
    """
    commit, date = _git(repository, "log", "-1", "--format=%H %cs", ref).decode().split()
    entries = (line.split(b"\t", 1) for line in _git(repository, "ls-tree", "-r", "-z", commit).split(b"\0") if line)
    files = {path.decode(): about.split()[2] for about, path in entries if about.startswith(b"100")}
    files = {path: blob for path, blob in files.items() if Path(path).suffix in suffixes}
    contents = _git(repository, "cat-file", "--batch", given=b"\n".join(files.values()) + b"\n")
    position = 0
    for path in files:
        end = contents.index(b"\n", position)
        header = contents[position:end].split()
        position = end + 1
        if header[-1] == b"missing":  # a snapshot may lack large files
            continue
        size = int(header[2])
        target = folder / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(contents[position : position + size])
        position += size + 1
    return Source(name, commit, date)


def _git(repository: Path, *arguments: str, given: bytes = b"") -> bytes:
    # Whoever maintains the catalogue has chosen the folder; git comes from the PATH, as for other commands.
    command = ["git", "-C", str(repository), *arguments]
    return subprocess.run(command, check=True, input=given, stdout=subprocess.PIPE).stdout  # noqa: S603
