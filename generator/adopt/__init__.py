"""Adoption of a tree of .proto files that was written without a table: a draft of mapping.yaml in one pass.

- `proto_tree` finds the envelope, and the files that compile together.
- `guesses` guesses senders and receivers from names, folders and comments.
- `retired_numbers` reads from git the numbers that were used before.
- `fitting` finds names that ROS 2 allows, and fields that cannot be converted.
- `lint_levels` lowers the rules that the tree breaks.
- `draft` is the content of the table, and `table_text` its text.

This package writes no file of the project. For a folder without .proto files, `roverlink.generator.new_project` starts
a project.
"""

from __future__ import annotations

from roverlink.generator.adopt.adoption import Adoption, AdoptionRequest, adopt

__all__ = ["Adoption", "AdoptionRequest", "adopt"]
