"""Where the files of the C++ library go, and what stands around the text in them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from roverlink.generator.emit.render import Files, header, render
from roverlink.generator.emit.targets.cpp import layout

FOLDER = "generated/cpp"


@dataclass(frozen=True, slots=True)
class Pair:
    """A header and a source file of one name."""

    package: str
    name: str
    """With its folder: ``handlers/imu_info``."""
    origin: str
    """What the two are generated from."""

    @property
    def header(self) -> str:
        """The header, as an include directive names it."""
        return f"{self.package}/{self.name}.hpp"

    @property
    def source(self) -> str:
        """The source file, below the folder."""
        return f"src/{self.name}.cpp"


def pair(files: Pair, template: str, **view: Any) -> Files:
    """Both files, by the two templates of a name."""
    yield header_file(files, template, **view)
    text = render(f"cpp/{template}.cpp.j2", package=files.package, own_header=files.header, **view)
    yield f"{FOLDER}/{files.source}", f"{header(files.origin, '//')}\n\n{text}"


def header_file(files: Pair, template: str, **view: Any) -> tuple[str, str]:
    """The header, with its guard."""
    text = render(f"cpp/{template}.hpp.j2", package=files.package, **view)
    guard = layout.guard(files.header)
    opened = f"{header(files.origin, '//')}\n\n#ifndef {guard}\n#define {guard}\n"
    return f"{FOLDER}/include/{files.header}", f"{opened}\n{text}\n#endif  // {guard}\n"
