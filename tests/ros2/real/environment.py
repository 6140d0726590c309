"""Real ROS 2 for tests: rclpy and Fast DDS from wheels, in an environment that all runs share.

    python -m tests.ros2.real.environment RELEASE...

makes it where it is not there yet, and fails where it cannot be had. It is no part of the
environment of the tests, since `lark-parser`, which rclpy needs, overwrites `lark`.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import venv
from functools import cache
from pathlib import Path

from tests import programs

_MESSAGES = "diagnostic", "geometry", "nav", "sensor", "std"
RELEASES = {
    release: (
        f"ros-{release}-rclpy[fastrtps]=={rclpy}",
        *(f"ros-{release}-{name}-msgs=={messages}" for name in _MESSAGES),
        "pytest>=8.2",
    )
    for release, rclpy, messages in (("jazzy", "7.1.6", "5.3.6"), ("kilted", "9.1.2", "5.5.1"))
}
"""Each release of ROS 2 with what is installed of it."""


class NotInstalledError(Exception):
    """What pip has said."""


def folder(release: str) -> Path:
    """Where the environment is: beside those of other versions, in the user's cache."""
    top = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "fretc-tests"
    key = hashlib.sha256(repr((RELEASES[release], sys.version)).encode()).hexdigest()[:12]
    return top / f"ros2-{release}-{key}"


def install(release: str) -> Path:
    """Return the Python of the environment; the first who asks makes it, and others wait.

    Raises:
        NotInstalledError: there are no wheels for this platform, or no registry answers.
    """
    import fcntl  # Windows has none, and no wheels of ROS 2 either

    place = folder(release)
    place.parent.mkdir(parents=True, exist_ok=True)
    with place.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not place.is_dir():
            partial = place.with_suffix(".partial")  # what a killed run has left is made again
            shutil.rmtree(partial, ignore_errors=True)
            _fill(partial, RELEASES[release])
            partial.rename(place)
    return place / "bin" / "python"


def _fill(place: Path, packages: tuple[str, ...]) -> None:
    venv.create(place, with_pip=False)
    pip = (sys.executable, "-m", "pip", "--python", str(place / "bin" / "python"))
    done = subprocess.run(
        [*pip, "install", "-q", "--retries", "1", *packages],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        shutil.rmtree(place)
        raise NotInstalledError(done.stderr[-300:])


@cache
def _installed(release: str) -> Path | str:
    try:
        return install(release)
    except NotInstalledError as error:
        return str(error)


def python(release: str = "jazzy") -> Path:
    """The Python that has rclpy; the test is skipped where it cannot be had."""
    way = f"pip install {' '.join(RELEASES[release])}"
    found = f"hidden: {way}" if programs.hidden() else _installed(release)
    return found if isinstance(found, Path) else programs.leave_out(f"needs ROS 2, {way}: {found}")


if __name__ == "__main__":
    for each in sys.argv[1:]:
        print(install(each))
