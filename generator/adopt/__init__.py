"""Taking over a tree of .proto files that was written without a table: mapping.yaml is drafted, tried, and corrected.

- `tree`: which message is the envelope, and which files compile together;
- `guesses`: who sends what to whom, from names, folders and comments;
- `past`: the numbers that history shows were used;
- `draft`: what will stand in the table, and `text`, how it is written;
- `trial`: the draft is compiled and linted in a copy; what does not fit is renamed, left out, or counted for less,
  each time with the reason beside it.

Nothing of the project is written here.
"""

from __future__ import annotations

from generator.adopt.adoption import Adoption, Wanted, adopt

__all__ = ["Adoption", "Wanted", "adopt"]
