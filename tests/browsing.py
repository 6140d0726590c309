"""Documents in a browser: pages that are taken again, and what they complained about."""

from __future__ import annotations

from contextlib import ExitStack
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tests import programs

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page


class Visits:
    """Documents in the pages of one browser, which ask nothing of a network.

    A page is taken again in the next test: to make one takes longer than to open a document in it.
    """

    def __init__(self, browser: Browser) -> None:
        self._browser = browser
        self._made: dict[bool, list[Page]] = {True: [], False: []}
        self._used = {True: 0, False: 0}
        self.messages: list[str] = []
        """What stands in the console, and errors of scripts."""
        self.asked: list[str] = []
        """The addresses that were asked for."""

    def begin(self) -> None:
        """A test begins: all pages are free, and nothing was said."""
        self._used = {True: 0, False: 0}
        self.messages.clear()
        self.asked.clear()

    def open(
        self,
        path: Path,
        width: int = 1280,
        height: int = 900,
        *,
        scheme: Any = "light",
        scripts: bool = True,
        address: str = "",
    ) -> Page:
        """The document in a page that no other visit of this test has.

        Args:
            path: of the document.
            width: of the screen, in pixels.
            height: as well.
            scheme: `light` or `dark`.
            scripts: whether they run.
            address: what stands behind the path.
        """
        page = self._page(scripts)
        page.set_viewport_size({"width": width, "height": height})
        page.emulate_media(media="null", color_scheme=scheme)
        page.mouse.move(0, 0)
        page.goto(f"{path.absolute().as_uri()}{address}")
        return page

    def again(self, page: Page) -> Page:
        """The document and the address of a page in another one."""
        other = self._page(scripts=True)
        other.goto(page.url)
        return other

    def _page(self, scripts: bool) -> Page:
        made, place = self._made[scripts], self._used[scripts]
        self._used[scripts] += 1
        if place == len(made):
            if made:
                context = made[0].context
            else:
                context = self._browser.new_context(offline=True, java_script_enabled=scripts)
            page = context.new_page()
            page.on("console", lambda message: self.messages.append(message.text))
            page.on("pageerror", lambda error: self.messages.append(str(error)))
            page.on("request", lambda request: self.asked.append(request.url))
            made.append(page)
        return made[place]


def serious(page: Page, of: str = "") -> list[tuple[str, str]]:
    """What axe finds in the parts that the selector names: its rule, and the first element."""
    page.evaluate((files("axe_playwright_python") / "axe.min.js").read_text("utf-8"))
    found = page.evaluate("of => axe.run(of || document, {resultTypes: ['violations']})", of)[
        "violations"
    ]
    return [
        (each["id"], each["nodes"][0]["html"][:200])
        for each in found
        if each["impact"] in ("serious", "critical")
    ]


_running: list[tuple[ExitStack, Visits]] = []


def started() -> Visits:
    """The pages of the browser that runs, or of a new one; skipped where there is none."""
    if not _running:
        from playwright.sync_api import sync_playwright

        path = programs.installed("chromium")
        stack = ExitStack()
        driver = stack.enter_context(sync_playwright())
        browser = driver.chromium.launch(executable_path=path, args=["--no-sandbox"])
        stack.callback(browser.close)
        _running.append((stack, Visits(browser)))
    return _running[0][1]


def end() -> None:
    """End the browser, if one runs."""
    while _running:
        _running.pop()[0].close()
