"""A real browser without a window: Chromium or Chrome, driven by its own driver over W3C's WebDriver."""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from bench.errors import BenchError

PATIENCE_S = 240.0
"""Far longer than anything takes, on a machine that is busy with other things."""


class Visitor:
    """Somebody who looks at a page and clicks."""

    def __init__(self, driver: Any) -> None:
        self._driver = driver

    def open(self, url: str) -> None:
        """Go to a page."""
        self._driver.get(url)

    def screen(self, width: int, height: int) -> None:
        """Look through a page of so many pixels: a window cannot be so narrow as a phone's."""
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self._driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)

    def text(self, selector: str) -> str:
        """What can be read in an element."""
        return str(self._find(selector).text)

    def shown(self, selector: str) -> bool:
        """Whether an element can be seen."""
        return bool(self._find(selector).is_displayed())

    def count(self, selector: str) -> int:
        """How many elements there are."""
        return len(self._driver.find_elements("css selector", selector))

    def click(self, selector: str) -> None:
        """Click where an element is."""
        self._find(selector).click()

    def run(self, program: str) -> Any:
        """What a program in the page returns, or what it promises."""
        return self._driver.execute_script(program)

    def until(self, wanted: Callable[[], Any]) -> None:
        """Look until something is as wanted. Raises `TimeoutError`, with what there is, where it never is."""
        deadline = time.monotonic() + PATIENCE_S
        while not wanted():
            if time.monotonic() > deadline:
                raise TimeoutError(f"the page is not as it should be:\n{self.text('body')}")
            time.sleep(0.1)

    def complaints(self) -> list[str]:
        """What the browser had to say against the page since it was asked last: errors, and what was blocked."""
        return [entry["message"] for entry in self._driver.get_log("browser")]

    def photograph(self) -> bytes:
        """The screen as PNG."""
        return bytes(self._driver.get_screenshot_as_png())

    def _find(self, selector: str) -> Any:
        return self._driver.find_element("css selector", selector)


@contextmanager
def browser(width: int = 1280, height: int = 900) -> Iterator[Visitor]:
    """A browser with a screen of so many pixels. Raises `BenchError` where there is none to be had."""
    try:
        from selenium import webdriver
    except ImportError as error:
        raise BenchError("a browser is driven by selenium, which is not installed: pip install selenium") from error
    program = shutil.which("chromedriver")
    if program is None:
        raise BenchError("there is no chromedriver on the PATH; on Debian: apt-get install chromium-driver")
    options = webdriver.ChromeOptions()
    # Without a sandbox, which needs rights that root in a container has not; it sees pages of ours alone.
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--no-proxy-server"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(program))
    try:
        visitor = Visitor(driver)
        visitor.screen(width, height)
        yield visitor
    finally:
        driver.quit()
