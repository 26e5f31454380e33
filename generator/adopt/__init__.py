"""Adoption of existing .proto files for `roverlink init --from`: drafts a mapping.yaml for them.

- `proto_tree` reads the folder, and finds the envelope and the files that compile together with it.
- `missing_imports` says where the files of imports are that start at another folder.
- `guesses` guesses the sender and the receivers of each message from names, folders and comments.
- `retired_numbers` reads from git's history the field numbers that the envelope used before.
- `fitting` changes names that ROS 2 forbids, and leaves out fields that cannot be converted.
- `lint_levels` lowers the severity of the lint rules that the .proto files break.
- `draft` holds the drafted content of mapping.yaml, and `table_text` converts it to text.

This package writes no file of the project. For a folder without .proto files, `roverlink.generator.new_project` starts
a project.
"""

from __future__ import annotations

from roverlink.generator.adopt.adoption import Adoption, AdoptionRequest, adopt

__all__ = ["Adoption", "AdoptionRequest", "adopt"]
