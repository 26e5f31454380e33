"""Make a file with the keys of a peer or board that must sign its datagrams.

Make a file with two random keys: one for the datagrams of a peer or board to the bridge, and one for those
of the bridge to it. Both ends need the same file. Only its owner can read it. The command shows no key.

With --rotate, add two new keys to the file, which both ends accept from then on. They go on signing with
the old keys until you mark the new ones with `send_with = yes`. The page docs/security.md shows the steps.

Example: roverlink link keygen basestation
"""

from __future__ import annotations

import argparse
from datetime import datetime, timezone
from pathlib import Path

from roverlink.console import OK, Subparsers, documented_command
from roverlink.runtime.keys.key_file import SUFFIX, add_keys, make_key_file


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    parser.add_argument("name", metavar="NAME", help="name of the peer or board in mapping.yaml, such as basestation")
    parser.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help=f"the file (default: NAME{SUFFIX} in this folder); its folder must exist",
    )
    parser.add_argument("--rotate", action="store_true", help="add new keys to the file, which must exist")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Write the file, and print the ids of its new keys and what to do with it."""
    path = arguments.out or Path(f"{arguments.name}{SUFFIX}")
    now = datetime.now(timezone.utc)
    keys = (add_keys if arguments.rotate else make_key_file)(path, arguments.name, now)
    for file_key in keys:
        print(f"{path}: new key {file_key.key.id} from {file_key.key.sender} to {file_key.receiver}")
    if arguments.rotate:
        print("copy the file to the other end and restart both; then mark the new keys with `send_with = yes`")
    else:
        print("copy the file to the other end over a safe way, such as scp; whoever has it can command the rover")
    return OK
