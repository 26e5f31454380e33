"""Pictures of the page for docs/operations.md, made with a real browser: python -m bench.link_page_pictures."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from bench.errors import BenchError
from bench.vision.browser import Visitor, browser
from bench.watched_link import WatchedLink, watched_link

FOLDER = Path("docs/operations")
SCREEN, PHONE = (1280, 1560), (390, 1100)
_DRIVE_S = 20.0


def main(words: list[str]) -> int:
    """Make all pictures. Returns 2 if there is no browser."""
    parser = argparse.ArgumentParser(prog="python -m bench.link_page_pictures", description=__doc__)
    parser.add_argument(
        "--out", type=Path, default=FOLDER, metavar="DIR", help="folder for the pictures (default: %(default)s)"
    )
    folder = parser.parse_args(words).out
    folder.mkdir(parents=True, exist_ok=True)
    try:
        with browser() as visitor, watched_link() as link:
            _photograph(visitor, link, folder)
    except BenchError as error:
        print(f"bench: {error}", file=sys.stderr)
        return 2
    return 0


def _photograph(visitor: Visitor, link: WatchedLink, folder: Path) -> None:
    """Photograph the page after a drive, with a few bad datagrams, whose commands have just stopped."""
    visitor.screen(*SCREEN)
    visitor.open(link.url)
    link.boards_speak = link.driver_speaks = True
    time.sleep(_DRIVE_S)  # the curve of the plot needs this time
    visitor.click("#active")
    visitor.run("choosePlot('arm_pos', 'jaw_actual_position')")
    link.driver_speaks = False
    link.send(b"\xff\xff")
    visitor.until(lambda: "stop drive_motor" in visitor.text("#alarms") and "not a valid" in visitor.text("#log"))
    _write(folder / "page.png", visitor)
    visitor.screen(*PHONE)
    _write(folder / "phone.png", visitor)


def _write(path: Path, visitor: Visitor) -> None:
    path.write_bytes(visitor.photograph())
    print(f"picture: {path}, {path.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
