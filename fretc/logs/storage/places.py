"""Restrictions on the locations of logs: evidence from elsewhere names locations."""

from __future__ import annotations

import os
from collections.abc import Sequence
from urllib.parse import unquote, urlsplit

from fretc.logs.storage.log_names import is_url
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class AllowedLocations:
    """The locations that may be opened.

    Allowed are files below the current folder and below folders that the user names, `https`, and
    URLs below one that the user names.
    """

    allowed: Sequence[str] = ()
    """Folders, and prefixes of URLs."""
    offline: bool = False
    """Whether no server is contacted."""

    def refusal(self, location: str) -> str:
        """The reason why a location may not be opened; empty: it may be."""
        return self._of_url(location) if is_url(location) else self._of_file(location)

    def _of_url(self, url: str) -> str:
        if self.offline:
            return "it is on a server, and `--offline` is given"
        if any(_begins(url, start) for start in self.allowed if is_url(start)):
            return ""
        if "::" in url:
            return "it combines several protocols"
        try:
            parts = urlsplit(url)
        except ValueError:
            return "it is not a URL"
        scheme = parts.scheme.lower()
        return "" if scheme == "https" and parts.hostname else f"its protocol is `{scheme}`"

    def _of_file(self, path: str) -> str:
        real = os.path.realpath(path)
        folders = [os.curdir, *(name for name in self.allowed if not is_url(name))]
        inside = any(
            os.path.commonpath([real, folder]) == folder
            for folder in map(os.path.realpath, folders)
        )
        return "" if inside else "it is outside the folders that are searched"


def _begins(url: str, start: str) -> bool:
    """Whether the URL is below another one, without `..` and without combined protocols."""
    if not url.startswith(start):
        return False
    rest = url[len(start) :]
    steps = unquote(rest).replace("\\", "/").split("/")
    below = start.endswith("/") or not rest or rest.startswith("/")
    return below and ".." not in steps and "::" not in rest
