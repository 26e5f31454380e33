"""Pictures of the page for docs/operations.md, made with a real browser: python -m bench.link_page_pictures."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from bench.errors import BenchError
from bench.followed_page import FollowedPage, followed_page
from bench.watched_link import WatchedLink, watched_link
from rover.bench.vision.browser import Visitor, browser

FOLDER = Path("docs/operations")
SCREEN, TABLET, PHONE = (1280, 1560), (768, 820), (390, 1100)
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
        with browser() as visitor, TemporaryDirectory() as keys:
            token_file = Path(keys) / "token"
            with watched_link(token_file) as link:
                _photograph(visitor, link, token_file, folder)
            with followed_page() as page:
                _photograph_several(visitor, page, folder)
            with followed_page() as page:
                _photograph_boards(visitor, page, folder)
    except BenchError as error:
        print(f"bench: {error}", file=sys.stderr)
        return 2
    return 0


def _photograph(visitor: Visitor, link: WatchedLink, token_file: Path, folder: Path) -> None:
    """Photograph the page after a drive, with a few bad datagrams, whose commands have just stopped; then unlock it."""
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
    visitor.screen(*SCREEN)
    visitor.run("scrollTo(0, 0)")
    visitor.click("#unlock")
    visitor.enter("#token", token_file.read_text(encoding="ascii").strip())
    visitor.click("#unlock-form button")
    visitor.until(lambda: visitor.shown("#parameter-section"))
    visitor.enter("#parameters [name='dst_ip']", "10.0.0.7")
    _write(folder / "parameters.png", visitor, "#parameter-section")


def _photograph_several(visitor: Visitor, page: FollowedPage, folder: Path) -> None:
    """Photograph the tabs of three bridges in the dark; a board of the second is silent."""

    def all_speak() -> None:
        for name in ("drone", "rover", "winch"):
            fresh = {"imu_info": 0.2, "drive_diag": 0.1, "rover_localization": 0.3}
            page.hear(name, ages={**fresh, "arm_pos": 12.0} if name == "rover" else fresh)

    def see(wanted: Callable[[], bool]) -> None:
        def seen() -> bool:
            all_speak()
            return wanted()

        visitor.until(seen)

    all_speak()
    visitor.screen(*TABLET)
    visitor.open(f"{page.url}#/rover")
    see(lambda: "1 new" in visitor.text("#tabs") and visitor.text("#name") == "rover")
    visitor.click("#theme")
    see(lambda: "SILENT" in visitor.text("#peers"))
    _write(folder / "bridges.png", visitor)


def _photograph_boards(visitor: Visitor, page: FollowedPage, folder: Path) -> None:
    """Photograph the peers of a bridge whose table has addresses of boards and the link message."""
    page.hear("rover", ages={"imu_info": 0.2, "drive_diag": 0.1}, links=True)
    visitor.screen(*SCREEN)
    visitor.open(page.url)
    visitor.run("setTheme(false)")
    visitor.until(lambda: "other protos" in visitor.text("#peers"))
    _write(folder / "boards.png", visitor, "#peers [data-key='hardware']")


def _write(path: Path, visitor: Visitor, selector: str = "") -> None:
    path.write_bytes(visitor.photograph(selector))
    print(f"picture: {path}, {path.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
