"""Taking over a tree of .proto files that was written without a table: mapping.yaml is drafted in one pass.

- `proto_tree`: which message is the envelope, and which files compile together;
- `guesses`: who sends what to whom, from names, folders and comments;
- `retired_numbers`: the numbers that history shows were used;
- `fitting`: names that ROS 2 allows, and fields that it cannot have;
- `lint_levels`: the rules that the tree breaks already;
- `draft`: what will stand in the table, and `table_text`, how it is written.

Nothing of the project is written here. Where there is nothing to take over, `roverlink.generator.new_project` starts
a project.
"""

from __future__ import annotations

from roverlink.generator.adopt.adoption import Adoption, Wanted, adopt

__all__ = ["Adoption", "Wanted", "adopt"]
