"""Numbers in texts for the user."""

from __future__ import annotations


def counted(count: float, what: str) -> str:
    """Return a number with the noun ``what``: ``1 row``, ``2 rows``, ``2 classes``, ``2.5 times``."""
    plural = f"{what}es" if what.endswith("s") else f"{what}s"
    return f"{count:.15g} {what if count == 1 else plural}"
