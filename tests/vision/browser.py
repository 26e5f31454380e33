"""A real browser without a window: Chromium or Chrome, driven by its own driver over W3C's WebDriver."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

_DRIVER = "chromedriver"


@contextmanager
def browser(width: int, height: int) -> Iterator[Any]:
    """A browser whose page is so large, in pixels. The test is skipped where there is none to be had."""
    webdriver = pytest.importorskip("selenium.webdriver", reason="selenium is not installed: pip install selenium")
    driver = shutil.which(_DRIVER)
    if driver is None:
        pytest.skip("no chromedriver on the PATH; on Debian: apt-get install chromium-driver")
    options = webdriver.ChromeOptions()
    # Without a sandbox, since that needs rights that a container's root has not; it sees our own page alone.
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--no-proxy-server"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    opened = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
    try:
        resize(opened, width, height)
        yield opened
    finally:
        opened.quit()


def resize(opened: Any, width: int, height: int) -> None:
    """Show the page as on a screen of this size, a phone's among them: a window cannot be so narrow."""
    opened.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False},
    )


def complaints(opened: Any) -> list[str]:
    """What the browser had to say against the page since it was asked last: errors, and what was blocked."""
    return [entry["message"] for entry in opened.get_log("browser")]
