"""Adoption of a tree of .proto files that was written without a table: drafts a mapping.yaml for the tree.

- `proto_tree` finds the envelope, and the files that compile together.
- `guesses` guesses the sender and the receivers of each message from names, folders and comments.
- `retired_numbers` reads from git the numbers that were used before.
- `fitting` changes names that ROS 2 forbids, and leaves out fields that cannot be converted.
- `lint_levels` lowers the severity of the rules that the tree breaks.
- `draft` holds the content of the table, and `table_text` writes it as text.

This package writes no file of the project. For a folder without .proto files, `roverlink.generator.new_project` starts
a project.
"""

from __future__ import annotations

from roverlink.generator.adopt.adoption import Adoption, AdoptionRequest, adopt

__all__ = ["Adoption", "AdoptionRequest", "adopt"]
