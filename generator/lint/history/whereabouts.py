"""Text that says on which branches a declaration exists today, or that it is not committed yet."""

from __future__ import annotations

from functools import lru_cache

from roverlink.generator.lint.history.branch_names import branch_name
from roverlink.generator.lint.history.uncommitted import is_uncommitted

_MOST_NAMED = 3


@lru_cache  # many declarations are on the same branches
def whereabouts(refs: tuple[str, ...]) -> str:
    """Return where a declaration exists today: ``on the branch main``, ``in the index, not committed yet``.

    ``refs`` are the refs of the branches, and the index or the working tree (see `uncommitted`). These two are only
    named if no branch has the declaration. The text is empty without refs.
    """
    committed = [ref for ref in refs if not is_uncommitted(ref)]
    if refs and not committed:
        return f"in {refs[0]}, not committed yet"
    if committed == ["HEAD"]:
        return "on HEAD, which is on no branch"
    # `origin/main` says nothing new beside `main`.
    names = [
        branch_name(ref)
        for ref in committed
        if f"refs/heads/{ref.split('/', 3)[-1]}" not in committed or "/heads/" in ref
    ]
    if len(names) > _MOST_NAMED:
        names = [*names[:_MOST_NAMED], f"{len(names) - _MOST_NAMED} more"]
    if len(names) < 2:
        return "".join(f"on the branch {name}" for name in names)
    return f"on the branches {', '.join(names[:-1])} and {names[-1]}"
