"""A headless Chromium for tests that look at pages: nothing of it leaves this machine, nothing is downloaded."""

import contextlib
import shutil

import pytest

FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--disable-dev-shm-usage", "--hide-scrollbars",
)  # fmt: skip
PROGRAMS = {"browser": ("chromium", "chromium-browser", "google-chrome"), "driver": ("chromedriver",)}


def programs():
    """Paths of the browser and of its driver, None for what is not on PATH."""
    return {kind: next((path for name in names if (path := shutil.which(name))), None) for kind, names in PROGRAMS.items()}


def needs_browser():
    """A mark that skips, and names what is missing, where there is no browser."""
    missing = [" or ".join(PROGRAMS[kind]) for kind, path in programs().items() if path is None]
    return pytest.mark.skipif(bool(missing), reason=f"not on PATH: {' and '.join(missing)} (Debian: chromium, chromium-driver)")


@contextlib.contextmanager
def opened(profile, width=1000, height=750):
    """A browser with a new profile in an empty folder."""
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service

    found = programs()
    options = Options()
    options.binary_location = found["browser"]
    for flag in (*FLAGS, f"--window-size={width},{height}", f"--user-data-dir={profile}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(executable_path=found["driver"]))
    try:
        yield driver
    finally:
        driver.quit()
