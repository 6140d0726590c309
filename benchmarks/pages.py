"""Every page that people decide by, of simulated runs, and pictures of them, to be looked at.

    python -m benchmarks.pages OUT [--only REGEX]

Simulates runs of the warehouse robot, audits them against `requirements/mission`, and makes the
report of 8 and of 50 runs, `play --log`, and the trends of five nights. What is there already is
kept, so that a changed page is made again in seconds. Chromium then takes a picture of each page:
of the first screen and of all, wide and on a telephone, dark, and printed. It prints for each page
the time to make it, its size, its heights, what the console said, and the number of sheets.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from tests import programs

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

ROOT = Path(__file__).parents[1]
EIGHT = ("blind-zone", "lidar-silent", "log-cut", "nominal", "obstacle-moved",
         "safety-late", "safety-off", "walker")  # fmt: skip
MORE = (*EIGHT, "far-threshold", "zero-late")
NIGHTS = 5
SECONDS = "60"
"""Of each mission."""


def fretc(*arguments: str | Path, cwd: Path) -> float:
    """Run a command, and return its wall time in seconds.

    It fails if it does not write the file that is its last argument: the exit status is about
    verdicts and damaged logs, too.
    """
    start = time.perf_counter()
    command = [str(Path(sys.executable).with_name("fretc")), *map(str, arguments)]
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)
    if not (cwd / arguments[-1]).exists():
        raise SystemExit(f"{' '.join(command)}\n{done.stdout}{done.stderr}")
    return time.perf_counter() - start


def simulated(folder: Path) -> None:
    """A folder of logs for each night, with a run of each scenario."""
    for night in range(1, NIGHTS + 1):
        for name in MORE:
            path = folder / "runs" / str(night) / f"{name}.mcap"
            if not path.exists():
                path.parent.mkdir(parents=True, exist_ok=True)
                with_seed = ("--seed", str(night), "--duration", SECONDS, "-o", path)
                fretc("simulate", name, *with_seed, cwd=folder)


def audited(folder: Path) -> None:
    """Evidence of each night, of 8 runs and of all 50."""
    project, runs = folder / "requirements", folder / "runs"
    if not project.exists():
        shutil.copytree(ROOT / "requirements" / "mission", project)
    build = folder / "build"
    for night in range(1, NIGHTS + 1):
        made = build / f"night-{night}.json"
        labels = ("--label", f"date=2026-11-{20 + night}", "--label", f"version=2.{night // 3}")
        if not made.exists():
            fretc("audit", runs / str(night), *labels, "-o", made, cwd=folder)
    if not (build / "8.json").exists():
        logs = [runs / "4" / f"{name}.mcap" for name in EIGHT]
        fretc("audit", *logs, "-o", build / "8.json", cwd=folder)
    if not (build / "50.json").exists():
        fretc("audit", runs, "-o", build / "50.json", cwd=folder)
    if not (build / "analysis.json").exists():
        fretc("analyze", "requirements", "-o", build / "analysis.json", cwd=folder)


def made(folder: Path) -> Iterator[tuple[str, float]]:
    """Each page, and the seconds that its command took."""
    nights = [f"build/night-{night}.json" for night in range(1, NIGHTS + 1)]
    log = "runs/4/safety-late.mcap"
    commands: dict[str, Sequence[str]] = {
        "report-8": ("report", "--evidence", "build/8.json", "--html"),
        "report-8-play": ("report", "--evidence", "build/8.json", "--play", "--html"),
        "report-50": ("report", "--evidence", "build/50.json", "--html"),
        "trends": ("trends", *nights, "--reports", "{name}.html", "--html"),
        "play": ("play", "-o"),
        "play-log": ("play", "--log", log, "-o"),
    }
    for name, command in commands.items():
        yield name, fretc(*command, f"{name}.html", cwd=folder)


# What Chromium shows -----------------------------------------------------------------------------


def pictures(browser: Browser, path: Path) -> str:
    """Take the pictures of a page, and return what was measured."""
    heights, messages = [], list[str]()
    for width, height, scheme in ((1440, 900, "light"), (390, 844, "light"), (1440, 900, "dark")):
        page = browser.new_page(viewport={"width": width, "height": height})
        page.emulate_media(color_scheme=scheme)  # type: ignore[arg-type]
        page.on("console", lambda message: messages.append(message.text))
        page.on("pageerror", lambda error: messages.append(str(error)))
        page.goto(path.as_uri())
        stem = path.with_name(f"{path.stem}-{width}-{scheme}")
        heights.append(_screens(page, stem))
        if scheme == "dark":
            page.emulate_media(color_scheme="light")
            sheets = page.pdf(path=path.with_suffix(".pdf"), prefer_css_page_size=True)
        page.close()
    count = len(re.findall(rb"/Type /Page\b(?!s)", sheets))
    return f"{heights[0]:>7} {heights[1]:>7} {count:>7}  {'; '.join(messages) or 'nothing'}"


def _screens(page: Page, stem: Path) -> int:
    """The first screen and the whole page, and its height in pixels."""
    page.screenshot(path=f"{stem}.png")
    height = int(page.evaluate("document.documentElement.scrollHeight"))
    most = 16_000  # Chromium draws no higher picture.
    clip = {"x": 0, "y": 0, "width": page.evaluate("innerWidth"), "height": min(height, most)}
    page.screenshot(path=f"{stem}-all.png", full_page=True, clip=clip)  # type: ignore[arg-type]
    return height


def main() -> None:
    """Make the runs and pages that are missing, and print a line for each page."""
    from playwright.sync_api import sync_playwright

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--only", default="", help="pages whose name has this regular expression")
    args = parser.parse_args()
    folder = args.out.absolute()
    folder.mkdir(parents=True, exist_ok=True)
    os.environ["PYTHONPATH"] = str(ROOT)
    os.environ.setdefault("SOURCE_DATE_EPOCH", "1795305600")
    simulated(folder)
    audited(folder)
    took = dict(made(folder))
    print(f"{'page':>15} {'made':>7} {'MB':>6} {'1440':>7} {'390':>7} {'sheets':>7}  console")
    with sync_playwright() as driver:
        path = programs.path("chromium")
        browser = driver.chromium.launch(executable_path=path, args=["--no-sandbox"])
        for name, seconds in took.items():
            if re.search(args.only, name):
                page = folder / f"{name}.html"
                size = page.stat().st_size / 1e6
                columns = pictures(browser, page)
                print(f"{name:>15} {seconds:>5.1f} s {size:>6.2f} {columns}", flush=True)


if __name__ == "__main__":
    main()
