"""Earlier states of the project in git: the commit that a ref names, and its files in a temporary folder."""

from __future__ import annotations

import contextlib
import dataclasses
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from roverlink.generator import lock
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Severity, Span, shown
from roverlink.generator.git import SUBMODULE, Commit, GitError, Repository, commit_of_line
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


@dataclass(frozen=True, slots=True)
class Checkout:
    """The files of a state that the lint reads: those on disk, or those of a commit, in a temporary folder.

    The files of a submodule are written by `add_submodules`, because most submodules have nothing to do with the
    .proto files.
    """

    folder: Path
    name: str = ""
    """The beginning of the names of the files in diagnostics; empty for the files on disk that are checked."""
    pinned: dict[str, tuple[str, str]] = dataclasses.field(default_factory=dict)
    """The submodules whose files are not written, by path: the path of the repository around it, and its commit."""
    parts: dict[str, tuple[Repository, str]] = dataclasses.field(default_factory=dict)
    """The repositories whose files are written, and the commit of each, by path; that of the project has none."""

    def add(self, repository: Repository, commit: str, path: str, findings: list[Diagnostic]) -> None:
        """Write the files of a repository at a commit; ``path`` is empty, or that of the submodule.

        A diagnostic for each file that is left out is added to ``findings``. Raises `DiagnosticsError` if the commit
        cannot be read.
        """
        self.parts[path] = repository, commit
        try:
            entries = repository.entries(commit)
            links = [(at, id) for mode, id, at in entries if mode == SUBMODULE and not _leads_out(at)]
            self.pinned.update({shown(path, at): (path, id) for at, id in links})
            for file, data in repository.contents(entries, _is_wanted):
                if isinstance(data, str):
                    fault = f"the file cannot be read: {data}"
                elif _leads_out(file):
                    fault = "the path leads out of the folder of the state"
                else:
                    target = self.folder / path / file
                    target.parent.mkdir(parents=True, exist_ok=True)
                    target.write_bytes(data)
                    continue
                findings.append(UnreadableState.at(Span(shown(self.name, shown(path, file))), fault))
        except (GitError, OSError) as error:
            message = f"the state cannot be read: {error}"
            raise DiagnosticsError([UnreadableState.at(Span(shown(self.name, path)), message)]) from error

    def add_submodules(self, root: str, findings: list[Diagnostic]) -> None:
        """Write the files of the submodules in the folder ``root``, or around it, as the state pins them.

        Raises `DiagnosticsError`, also with ``findings``, if this clone lacks the commit of the submodule around the
        folder. For one in the folder, a hint is added to ``findings``, unless it is not checked out either.
        """
        while path := next((path for path in self.pinned if _is_part(root, path) or _is_part(path, root)), None):
            at, commit = self.pinned.pop(path)
            around, place = self.parts[at][0], path.removeprefix(f"{at}/")
            if repository := around.submodule_with(place, commit):
                self.add(repository, commit, path, findings)
                continue
            message = f"the submodule's commit {commit[:10]} is not in this clone"
            help = f"get it with `git submodule update --init {path}` or `git -C {path} fetch origin {commit}`"
            finding = UnreadableState.at(Span(shown(self.name, path)), message, help)
            if _is_part(root, path):
                raise DiagnosticsError([*findings, finding])
            if not _is_empty(around.folder / place):
                findings.append(dataclasses.replace(finding, severity=Severity.HINT))

    def commit_of(self, span: Span) -> Commit | None:
        """Return the commit that last changed the line of a place in this state; None if it is not known."""
        if not self.parts:
            return None
        file = span.file.removeprefix(shown(self.name, ""))
        path = self._part(file)
        repository, commit = self.parts[path]
        return commit_of_line(_commits_of_lines(repository, file.removeprefix(f"{path}/"), commit), span.line)

    def commit_at(self, folder: str) -> str:
        """Return the id of the commit to which the files in a folder belong: the project's, or that of a submodule.

        It is empty for files on disk.
        """
        return self.parts[self._part(folder)][1] if self.parts else ""

    def _part(self, path: str) -> str:
        return max((part for part in self.parts if _is_part(path, part)), key=len)


_commits_of_lines = cache(Repository.commits_of_lines)


def _is_part(path: str, folder: str) -> bool:
    """Return True if a path is that of the folder, or of something in it; an empty one is the project's folder."""
    return not folder or path == folder or path.startswith(f"{folder}/")


def _leads_out(path: str) -> bool:
    """Return True if a path of a commit leads out of its folder: git can store such a path, but never checks it out."""
    return not {"", "..", ".git"}.isdisjoint(path.split("/"))


def _is_empty(folder: Path) -> bool:
    return folder.is_dir() and not any(folder.iterdir())


@contextlib.contextmanager
def checked_out(repository: Repository, commit: str, ref: str, findings: list[Diagnostic]) -> Iterator[Checkout]:
    """Write the files of a commit that the lint reads to a temporary folder, and yield them.

    ``ref`` is the name of the commit for diagnostics. A diagnostic for each file that is left out is added to
    ``findings``. Raises `DiagnosticsError` if the commit cannot be read.
    """
    with tempfile.TemporaryDirectory(prefix="roverlink-state-") as folder:
        checkout = Checkout(Path(folder), repository.in_commit(ref))
        checkout.add(repository, commit, "", findings)
        yield checkout


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
