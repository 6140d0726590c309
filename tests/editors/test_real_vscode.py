"""The packed extension in a real VS Code, which runs behind a page of Chromium.

FRETC_VSCODE is the command of a VS Code for the browser, such as `code-server`.
"""

import json
import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests import programs
from tests.editors import npm_packages

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[2]
_SENTENCES = """+++
id = "R1"
title = "Stop"
+++
whenever near the robot shall within 2 ticks satisfy stopped
+++
id = "R2"
title = "Start at rest"
+++
the robot shall initially satisfy !near
"""
_BINDINGS = """[clock]
tick = "100 ms"
[signal.n]
path = "/table.near"
[signal.s]
path = "/table.stopped"
[proposition.near]
expr = "n > 0"
role = "input"
[proposition.stopped]
expr = "s > 0"
role = "output"
"""
_LOG = "t,near,stopped\n0.0,0,0\n0.1,1,0\n0.2,0,0\n0.3,0,0\n0.4,0,0\n0.5,0,0\n"


class VsCode:
    """A running VS Code with the extension, and a project in its workspace."""

    def __init__(self, command: str, top: Path, extension: Path) -> None:
        self._command, self.top, self.workspace = command, top, top / "workspace"
        self.picture = top / "page.png"
        server = top / "fretc"
        server.write_text(f"#!{sys.executable} -P\nfrom fretc.cli import main\nmain()\n")
        server.chmod(0o755)
        files = {
            "workspace/requirements/r.fret": _SENTENCES,
            "workspace/requirements/bindings.toml": _BINDINGS,
            "workspace/log.csv": _LOG,
            "workspace/.vscode/settings.json": json.dumps({"fretc.log": "log.csv"}),
            "data/User/settings.json": json.dumps(
                {"fretc.path": str(server), "workbench.startupEditor": "none"}
            ),
        }
        for name, text in files.items():
            self.top.joinpath(name).parent.mkdir(parents=True, exist_ok=True)
            self.top.joinpath(name).write_text(text, encoding="utf-8")
        self._folders = "--user-data-dir", str(top / "data"), "--extensions-dir", str(top / "ext")
        self._run("--install-extension", str(extension / "fretish.vsix"))
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self._port = free.getsockname()[1]

    def start(self, *options: str) -> "subprocess.Popen[bytes]":
        address = f"127.0.0.1:{self._port}"
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        command = [
            self._command,
            *self._folders,
            "--auth",
            "none",
            "--bind-addr",
            address,
            *options,
        ]
        with self.top.joinpath("server.log").open("wb") as log:
            return subprocess.Popen(command, env=environment, stdout=log, stderr=log)

    def open(self, page: Any) -> None:
        from playwright import sync_api as playwright

        for _ in range(100):
            try:
                page.goto(f"http://127.0.0.1:{self._port}/?folder={self.workspace}")
                break
            except playwright.Error:  # the server does not listen yet
                page.wait_for_timeout(200)
        page.wait_for_selector(".monaco-workbench", timeout=60_000)

    def _run(self, *options: str) -> None:
        result = subprocess.run(
            [self._command, *self._folders, *options], capture_output=True, text=True, check=False
        )
        assert result.returncode == 0, result.stderr


@pytest.fixture(scope="module")
def extension(tmp_path_factory: pytest.TempPathFactory) -> Path:
    programs.vscode()
    folder = npm_packages.copy("vscode", tmp_path_factory.mktemp("package"))
    npm_packages.run(folder, "npm", "run", "package")
    return folder


@pytest.fixture
def vscode(tmp_path: Path, extension: Path) -> VsCode:
    return VsCode(programs.vscode(), tmp_path, extension)


@pytest.fixture
def page() -> Iterator[Any]:
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=programs.installed("chromium"), args=["--no-sandbox"]
        )
        page = browser.new_page(viewport={"width": 1500, "height": 900})
        page.set_default_timeout(60_000)
        yield page
        browser.close()


def command(page: Any, name: str) -> None:
    _ask(page, "F1")
    page.keyboard.type(name)
    page.locator(".quick-input-list .monaco-list-row.focused", has_text=name).wait_for()
    page.keyboard.press("Enter")


def _ask(page: Any, key: str) -> None:
    """Open the field for a command or a file; a key that comes while the focus moves is lost."""
    for _ in range(20):
        page.keyboard.press(key)
        page.wait_for_timeout(500)
        if page.locator(".quick-input-widget input").first.is_visible():
            return


def open_file(page: Any, name: str) -> None:
    _ask(page, "Control+p")
    page.keyboard.type(name)
    page.locator(".quick-input-list .monaco-list-row.focused", has_text=name).wait_for()
    page.keyboard.press("Enter")
    page.wait_for_selector(".view-lines")


def web_view(page: Any, index: int) -> Any:
    return page.frame_locator("iframe.webview.ready").nth(index).frame_locator("#active-frame")


def test_a_person_explains_audits_and_plays(vscode: VsCode, page: Any) -> None:
    server = vscode.start("--disable-workspace-trust")
    try:
        vscode.open(page)
        open_file(page, "r.fret")
        page.locator(".testing-run-glyph").nth(1).wait_for()  # a mark at each sentence
        command(page, "FRETish: Explain the Requirement")
        explanation = web_view(page, 0)
        explanation.locator("h1", has_text="Stop (R1)").wait_for()
        assert explanation.locator("table").count() >= 2
        assert explanation.locator("img").evaluate("image => image.naturalWidth") > 100
        page.locator(".tab", has_text="r.fret").click()
        command(page, "Test: Run All Tests")
        command(page, "Testing: Focus on Test Explorer View")
        page.locator(".result-summary", has_text="1/2").wait_for()  # R1 is violated
        page.screenshot(path=str(vscode.picture))
        assert page.locator(".testing-run-glyph.codicon-testing-failed-icon").count() == 1
        assert page.locator(".testing-run-glyph.codicon-testing-passed-icon").count() == 1
        evidence = vscode.workspace.joinpath("build/evidence.json").read_text()
        assert '"verdict": "violated"' in evidence
        page.locator(".tab", has_text="r.fret").click()
        command(page, "FRETish: Play With Traces")
        page.locator(".tab", has_text="Play requirements").wait_for()
    finally:
        server.terminate()
        server.wait()


def test_nothing_runs_before_the_workspace_is_trusted(vscode: VsCode, page: Any) -> None:
    marker = vscode.top / "hostile-has-run"
    hostile = vscode.workspace / "hostile"
    hostile.write_text(f"#!/bin/sh\ntouch '{marker}'\n")
    hostile.chmod(0o755)
    settings = vscode.workspace / ".vscode/settings.json"
    settings.write_text(json.dumps({"fretc.path": str(hostile), "fretc.log": "log.csv"}))
    server = vscode.start()
    try:
        vscode.open(page)
        page.locator(".monaco-dialog-box .monaco-button", has_text="No").first.click()
        open_file(page, "r.fret")
        page.locator(".mtk1, .view-line span", has_text="whenever").first.wait_for()
        page.wait_for_timeout(5_000)
        page.screenshot(path=str(vscode.picture))
        assert page.locator(".testing-run-glyph").count() == 0
        assert not marker.exists()
    finally:
        server.terminate()
        server.wait()
