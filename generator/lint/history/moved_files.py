"""Files that came into the proto root from elsewhere in the repository, whose earlier history counts, too.

A commit that moves ``api/imu.proto`` to ``proto/imu.proto`` removes the one and adds the other, and the types of the
one go on as types of the other. Then the history of ``api/imu.proto`` belongs to the proto root, up to this commit. If
one commit copies the file and another one deletes the original, its history is not followed, but reported as lost. So
is the history of files that were put in the place of a submodule.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from posixpath import basename, relpath

from roverlink.generator.git import Commit
from roverlink.generator.lint.history.commits import Edit, Revision
from roverlink.generator.lint.history.continuations import Place, continuations
from roverlink.generator.lint.history.numbered_types import NumberedTypes

TypesOf = Callable[[str | None], NumberedTypes]
Moves = Mapping[str, Collection[str]]
"""The files outside of the proto root that were moved to it, by path, with the ids of the commits that did it."""


def blobs_to_compare(revisions: Sequence[Revision], root: str) -> list[str]:
    """Return the ids of the blobs that `moves_into` and `lost_pasts` compare.

    ``root`` is the path of the proto root in the repository, with a slash at its end.
    """
    found: dict[str, None] = {}
    for revision in revisions:
        for gone, come in _pairs(revision, lambda path: not path.startswith(root), lambda _: True):
            found |= dict.fromkeys(blob for blob in (gone.old, come.new) if blob)
    for _, gone, come in _copies(revisions, root):
        found |= dict.fromkeys(blob for blob in (gone.old, come.new) if blob)
    return list(found)


def with_moved_files(revisions: Sequence[Revision], root: str, moves: Moves) -> list[Revision]:
    """Return the revisions with only those edits that belong to the proto root; their paths are relative to it.

    These are the edits of files below ``root``, and of files that a later commit moved there; see `moves_into`.
    """
    numbers = {
        commit: number
        for number, commit in enumerate({commit_id for commits in moves.values() for commit_id in commits})
    }
    after = _moves_before(revisions, numbers)
    masks = {path: sum(1 << numbers[commit] for commit in commits) for path, commits in moves.items()}

    def belongs(edit: Edit, commit: str) -> bool:
        if edit.path.startswith(root):
            return True
        # After the move, another file may get the path. But a merge removes the path where it was not removed yet.
        return edit.path in masks and (edit.new is None or not masks[edit.path] & after[commit])

    def edits(revision: Revision) -> tuple[Edit, ...]:
        kept = (edit for edit in revision.edits if belongs(edit, revision.id))
        return tuple(edit._replace(path=relpath(edit.path, root)) for edit in kept)

    return [replace(revision, edits=edits(revision)) for revision in revisions]


@dataclass(frozen=True, slots=True)
class LostPast:
    """A file of the proto root whose earlier history is not known, because it was not moved in one commit."""

    path: str
    """Path of the file, relative to the proto root."""
    origin: str
    """Path of the deleted file from which it was copied, or of the submodule in whose place it was put.

    The path is relative to the top of the repository.
    """
    of_submodule: bool
    """True if the earlier history is in the repository of a submodule."""
    commit: Commit
    """The commit that added the file to the proto root."""


def lost_pasts(revisions: Sequence[Revision], root: str, types_of: TypesOf, moves: Moves) -> list[LostPast]:
    """Return the files of the proto root that were copied from a file elsewhere which another commit deleted.

    Files that a commit put in the place of a submodule are returned, too.
    """
    found: dict[str, LostPast] = {}
    for revision in revisions:
        for origin in (edit.path for edit in revision.edits if edit.was_submodule and root.startswith(f"{edit.path}/")):
            for come in (edit for edit in revision.edits if edit.new and edit.path.startswith(root)):
                found[come.path] = LostPast(relpath(come.path, root), origin, True, revision.commit)
    for revision, gone, come in _copies(revisions, root):
        if gone.path not in moves and come.path not in found and _is_move(gone, come, types_of):
            found[come.path] = LostPast(relpath(come.path, root), gone.path, False, revision.commit)
    return list(found.values())


def _copies(revisions: Sequence[Revision], root: str) -> Iterator[tuple[Revision, Edit, Edit]]:
    """Yield the files that a commit adds to the proto root, each with a file of the same name that was elsewhere.

    The file elsewhere does not exist today. Its edit has its last content before the commit.
    """
    blobs: dict[str, str | None] = {}
    for revision in revisions:
        blobs |= {edit.path: edit.new for edit in revision.edits if not edit.path.startswith(root)}
    deleted = {path for path, blob in blobs.items() if blob is None}
    known: dict[str, dict[str, str]] = {}
    added = set[str]()
    for revision in revisions:
        for edit in revision.edits:
            if edit.path.startswith(root):
                if edit.new and edit.path not in added:
                    added.add(edit.path)
                    origins = known.get(basename(edit.path), {})
                    yield from ((revision, Edit(path, blob, None), edit) for path, blob in origins.items())
            elif edit.new and edit.path in deleted:
                known.setdefault(basename(edit.path), {})[edit.path] = edit.new


def moves_into(revisions: Sequence[Revision], root: str, types_of: TypesOf) -> Moves:
    """Return the files that were moved to the proto root from elsewhere, perhaps after earlier moves.

    ``types_of`` must know the blobs of `blobs_to_compare`.
    """
    moves: dict[str, set[str]] = {}
    for revision in reversed(revisions):  # the latest move first: its source may be the target of an earlier one
        pairs = _pairs(
            revision, lambda path: not path.startswith(root), lambda path: path.startswith(root) or path in moves
        )
        for path in [gone.path for gone, come in pairs if _is_move(gone, come, types_of)]:
            moves.setdefault(path, set()).add(revision.id)
    return moves


def _pairs(
    revision: Revision, is_source: Callable[[str], bool], is_target: Callable[[str], bool]
) -> Iterator[tuple[Edit, Edit]]:
    """Yield the removed and the added files of a revision that have the same content or the same name."""
    removed = [edit for edit in revision.edits if edit.old and not edit.new and is_source(edit.path)]
    added = [edit for edit in revision.edits if edit.new and not edit.old and is_target(edit.path)] if removed else []
    by_key: dict[str, list[Edit]] = {}
    for come in added:
        for key in {come.new or "", basename(come.path)}:
            by_key.setdefault(key, []).append(come)
    for gone in removed:
        yield from ((gone, come) for key in (gone.old or "", basename(gone.path)) for come in by_key.get(key, ()))


def _is_move(gone: Edit, come: Edit, types_of: TypesOf) -> bool:
    if gone.old == come.new:
        return True
    removed = {Place(gone.path, name): type for name, type in types_of(gone.old).items()}
    added = {Place(come.path, name): type for name, type in types_of(come.new).items()}
    return bool(continuations(removed, added))


def _moves_before(revisions: Sequence[Revision], numbers: dict[str, int]) -> dict[str, int]:
    """Return for each commit the moves among its ancestors, as an integer whose bits are the moves' numbers."""
    before: dict[str, int] = {}
    for revision in revisions:
        mask = 0
        for parent in revision.parents:
            if parent in before:
                mask |= before[parent] | (1 << numbers[parent] if parent in numbers else 0)
        before[revision.id] = mask
    return before
