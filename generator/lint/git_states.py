"""Earlier states of the project in git: the commit that a ref names, and its files in a temporary folder."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Iterator
from pathlib import Path

from roverlink.generator import lock
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Span, shown
from roverlink.generator.git import GitError, Repository
from roverlink.generator.lint.input_rules import CLONE, DEEPEN, NoSuchState, UnreadableState


def commit_of_ref(repository: Repository, ref: str, option: str) -> str:
    """Return the id of the commit that a ref names; raise `DiagnosticsError` if there is none.

    ``option`` is the option of the command line with the ref, or with a folder or a file.
    """
    try:
        return repository.resolve(ref)
    except GitError as error:
        message, help = f"{ref!r} is not a folder, a file, or a git ref", _other_refs(repository, ref)
        if str(error):  # git says nothing if only the ref is unknown
            message, help = f"{ref!r} is not a folder or a file, and no git ref can be read: {error}", CLONE
        raise DiagnosticsError([NoSuchState.at(Span(option), message, help)]) from error


@contextlib.contextmanager
def checked_out(repository: Repository, commit: str, ref: str, findings: list[Diagnostic]) -> Iterator[Path]:
    """Write the files of a commit that the lint reads to a temporary folder, and yield the folder.

    ``ref`` is the name of the commit for diagnostics. A diagnostic for each file that is left out is added to
    ``findings``. Raises `DiagnosticsError` if the commit cannot be read.
    """
    with tempfile.TemporaryDirectory(prefix="roverlink-state-") as folder:
        try:
            for file, data in repository.contents(commit, _is_wanted):
                if isinstance(data, str):
                    fault = f"the file cannot be read: {data}"
                elif not {"", ".."}.isdisjoint(file.split("/")):  # git can store such a path, but never checks it out
                    fault = "the path leads out of the folder of the state"
                else:
                    target = Path(folder, file)
                    target.parent.mkdir(parents=True, exist_ok=True)
                    target.write_bytes(data)
                    continue
                findings.append(UnreadableState.at(Span(shown(repository.in_commit(ref), file)), fault))
        except (GitError, OSError) as error:
            raise DiagnosticsError([UnreadableState.at(Span(ref), f"the state cannot be read: {error}")]) from error
        yield Path(folder)


def _other_refs(repository: Repository, ref: str) -> str:
    """Return the help for a git ref that does not exist: which refs there are."""
    try:
        repository.resolve(f"origin/{ref}")
    except GitError:
        return f"`git branch --all` and `git tag` list the refs; a shallow clone gets all of them with {DEEPEN}"
    return f"write 'origin/{ref}': this clone has {ref!r} only as a branch of the remote"


def _is_wanted(file: str) -> bool:
    # The table may have another name than usual.
    ledgers = (lock.NAME, lock.ACCEPTED_NAME)
    return file.endswith((".proto", ".options")) or file in ledgers or (file.endswith(".yaml") and "/" not in file)
