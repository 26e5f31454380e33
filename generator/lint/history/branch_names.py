"""Branches of a repository: their last commits, and their names."""

from __future__ import annotations

from collections.abc import Sequence

from roverlink.generator.lint.history.commits import Ref

_LOCAL, _REMOTE = "refs/heads/", "refs/remotes/"
_DEFAULTS = tuple(f"{place}{name}" for name in ("main", "master") for place in (_LOCAL, f"{_REMOTE}origin/"))


def branches(refs: Sequence[Ref]) -> dict[str, str]:
    """Return the last commit of each local and remote branch, by ref. HEAD is included if it is on no branch."""
    # A symbolic ref, such as refs/remotes/origin/HEAD, is a second name of a branch that is listed itself.
    return {
        ref.name: ref.commit
        for ref in refs
        if not ref.target and (ref.name == "HEAD" or ref.name.startswith((_LOCAL, _REMOTE)))
    }


def default_branch(refs: Sequence[Ref]) -> str | None:
    """Return the full ref of the default branch, into which others are merged; None if there is none."""
    names = branches(refs)
    # `git clone` writes refs/remotes/<remote>/HEAD: a symbolic ref to the default branch of the remote (git-remote(1),
    # set-head). A repository that was made with `git init` has none, and then the usual names decide.
    heads = {ref.name: ref.target for ref in refs if ref.name.startswith(_REMOTE) and ref.name.endswith("/HEAD")}
    of_remotes = [heads.pop(f"{_REMOTE}origin/HEAD", ""), *heads.values()]
    return next((name for name in (*of_remotes, *_DEFAULTS) if name in names), None)


def branch_name(ref: str) -> str:
    """Return the short name of a branch from its ref: ``main``, or ``origin/main`` for a remote branch."""
    return ref.removeprefix(_LOCAL).removeprefix(_REMOTE)


def short_name(ref: str) -> str:
    """Return a branch's name from its ref, without the remote: ``main`` for ``refs/remotes/origin/main``."""
    return ref.removeprefix(_REMOTE).partition("/")[2] if ref.startswith(_REMOTE) else ref.removeprefix(_LOCAL)
