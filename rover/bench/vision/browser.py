"""Headless browser: Chromium or Chrome, controlled through W3C WebDriver."""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from bench.errors import BenchError

PATIENCE_S = 240.0
"""Limit in seconds, far longer than any step needs even on a busy machine."""


class Visitor:
    """User of a page: looks and clicks."""

    def __init__(self, driver: Any) -> None:
        self._driver = driver

    def open(self, url: str) -> None:
        """Open a page, and forget what the browser said about the page before."""
        # The server of that page may have ended, and the page still asks it.
        self._driver.get("about:blank")
        self.complaints()
        self._driver.get(url)

    def screen(self, width: int, height: int) -> None:
        """Set the size of the page in pixels; a window cannot be as narrow as a phone's screen."""
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self._driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)

    def text(self, selector: str) -> str:
        """Return the visible text of an element."""
        return str(self._find(selector).text)

    def shown(self, selector: str) -> bool:
        """Return true if an element is visible."""
        return bool(self._find(selector).is_displayed())

    def count(self, selector: str) -> int:
        """Return the number of elements."""
        return len(self._driver.find_elements("css selector", selector))

    def click(self, selector: str) -> None:
        """Click an element."""
        self._find(selector).click()

    def enter(self, selector: str, text: str) -> None:
        """Type a text into a field."""
        self._find(selector).send_keys(text)

    def run(self, program: str) -> Any:
        """Run a script in the page; return its result, or that of its promise."""
        return self._driver.execute_script(program)

    def until(self, wanted: Callable[[], Any]) -> None:
        """Wait until a condition is true. Raises `TimeoutError` with the page's text if it never is."""
        deadline = time.monotonic() + PATIENCE_S
        while not wanted():
            if time.monotonic() > deadline:
                raise TimeoutError(f"the page did not reach the expected state:\n{self.text('body')}")
            time.sleep(0.1)

    def complaints(self) -> list[str]:
        """Return the browser's error messages since the last call."""
        return [entry["message"] for entry in self._driver.get_log("browser")]

    def photograph(self, selector: str = "") -> bytes:
        """Return a screenshot as PNG: of an element, or of the screen."""
        return bytes(self._find(selector).screenshot_as_png if selector else self._driver.get_screenshot_as_png())

    def _find(self, selector: str) -> Any:
        return self._driver.find_element("css selector", selector)


@contextmanager
def browser(width: int = 1280, height: int = 900) -> Iterator[Visitor]:
    """Start a browser with a screen of this size. Raises `BenchError` if there is none."""
    try:
        from selenium import webdriver
    except ImportError as error:
        raise BenchError("selenium, which controls the browser, is not installed: pip install selenium") from error
    program = shutil.which("chromedriver")
    if program is None:
        raise BenchError("chromedriver is not on the PATH; on Debian: apt-get install chromium-driver")
    options = webdriver.ChromeOptions()
    # Without a sandbox, which needs privileges that root in a container does not have; it opens only our own pages.
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--no-proxy-server"):
        options.add_argument(argument)
    options.page_load_strategy = "eager"  # an image that is a stream of pictures may never be loaded
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(program))
    try:
        visitor = Visitor(driver)
        visitor.screen(width, height)
        yield visitor
    finally:
        driver.quit()
