"""Extract the catalogues of all distributions from the sources of the packages, and say what has changed.

The repositories and their branches stand in sources.yaml. A repository that is not in the folder of the sources is
cloned there from GitHub; one that is there, as a clone or a mirror, is not fetched again.

Example: python -m check_launch.extraction ~/sources --distribution humble
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from check_launch.catalogue.catalogue_files import DISTRIBUTIONS, file_of, text_of
from check_launch.extraction.assembling import Assembler, Checkout, packages_in
from check_launch.extraction.git_sources import exported
from check_launch.extraction.launch_files import launch_files_of
from check_launch.extraction.supplement import read_supplement
from roverlink.runtime.atomic_files import write_whole
from roverlink.runtime.core.errors import SetupError

_SOURCES = Path(__file__).with_name("sources.yaml")


def main() -> int:
    """Extract the catalogues, print what has changed and what could not be extracted. Return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="folder with the repositories, named as in sources.yaml")
    parser.add_argument("--distribution", choices=DISTRIBUTIONS, nargs="+", default=DISTRIBUTIONS)
    parser.add_argument("--sources", type=Path, default=_SOURCES, help="list of repositories (default: sources.yaml)")
    parser.add_argument("--output", type=Path, help="folder to write into (default: that of the catalogues)")
    arguments = parser.parse_args()
    try:
        listed = yaml.safe_load(arguments.sources.read_text(encoding="utf-8"))
        for name, stated in listed.items():
            if not (arguments.folder / name).exists():
                clone = ["git", "clone", "--quiet", "--bare", f"https://github.com/{stated['from']}", name]
                subprocess.run(clone, cwd=arguments.folder, check=True)  # noqa: S603  # names of our own list
        for distribution in arguments.distribution:
            _extract(distribution, listed, arguments.folder, arguments.output)
    except (OSError, SetupError, subprocess.CalledProcessError, yaml.YAMLError) as error:
        print(f"cannot extract: {error}", file=sys.stderr)
        return 2
    return 0


def _extract(distribution: str, listed: Mapping[str, Any], repositories: Path, output: Path | None) -> None:
    supplement = read_supplement()
    with tempfile.TemporaryDirectory() as folder:
        assembler = Assembler(_checkouts(distribution, listed, repositories, Path(folder)), supplement)
        launch_files = {
            package: dict(launch_files_of(path))
            for package, path in assembler.folders()
            if package in supplement.launch_files
        }
        catalogue = assembler.catalogue(distribution, launch_files)
    file = output / f"{distribution}.json" if output else file_of(distribution)
    before = file_of(distribution)
    old = before.read_text(encoding="utf-8") if before.is_file() else "{}"
    new = text_of(catalogue)
    write_whole(file, new.encode())
    for name in sorted(assembler.unexplained):
        print(f"{distribution}: not explained: {name}", file=sys.stderr)
    for line in _changes(json.loads(old), json.loads(new)):
        print(f"{distribution}: {line}")
    print(
        f"{distribution}: {len(catalogue.packages)} packages, {len(catalogue.classes)} classes, "
        f"{len(catalogue.plugins)} plugins"
    )


def _checkouts(distribution: str, listed: Mapping[str, Any], repositories: Path, folder: Path) -> Iterator[Checkout]:
    """Yield the sources of the repositories that have a version for a distribution."""
    for name, stated in listed.items():
        if distribution in stated:
            inner = folder / name
            source = exported(repositories / name, name, str(stated[distribution]), inner)
            yield Checkout(name, inner, source, packages_in(inner), bool(stated.get("supplemented")))


def _changes(before: Mapping[str, Any], after: Mapping[str, Any], path: str = "") -> Iterator[str]:
    """Yield what a catalogue has that the one before had not, and the reverse, each with its path in the file."""
    for key in sorted(before.keys() | after.keys()):
        name, old, new = f"{path} {key}".lstrip(), before.get(key), after.get(key)
        if key not in after or key not in before:
            yield f"{'+' if key in after else '-'} {name}"
        elif isinstance(old, dict) and isinstance(new, dict):
            yield from _changes(old, new, name)
        elif isinstance(old, list) and isinstance(new, list):
            texts = [list(map(json.dumps, old)), list(map(json.dumps, new))]
            yield from (f"- {name}: {text}" for text in texts[0] if text not in texts[1])
            yield from (f"+ {name}: {text}" for text in texts[1] if text not in texts[0])
        elif json.dumps(old) != json.dumps(new):  # as texts, because NaN does not equal itself
            yield f"~ {name}: {json.dumps(old)} is now {json.dumps(new)}"


if __name__ == "__main__":
    sys.exit(main())
