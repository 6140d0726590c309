"""Python as on a system that has little of POSIX: read at the start of each process of the test.

Modules of the standard library are imported before, with all that Linux has; what is imported later
finds neither some modules nor some names.
"""

import importlib
import os
import signal
import sys
from types import ModuleType
from typing import Any

BEFORE = """
asyncio click ctypes.util hashlib http.client inspect logging multiprocessing.connection
multiprocessing.popen_fork multiprocessing.popen_spawn_posix multiprocessing.queues
multiprocessing.resource_tracker multiprocessing.spawn multiprocessing.synchronize numpy pathlib
selectors shutil socket subprocess tempfile
""".split()
MODULES = {"fcntl", "grp", "posix", "pwd", "resource", "termios", "tty"}
NAMES = {
    "os": "O_CLOEXEC O_DIRECTORY O_NOCTTY O_NOFOLLOW O_NONBLOCK fchmod fork forkpty getegid "
    "geteuid getgid getpgid getuid killpg mkfifo nice pread preadv pwrite register_at_fork "
    "sched_getaffinity setsid uname wait4 waitid",
    "signal": "ITIMER_PROF ITIMER_REAL SIGALRM SIGCHLD SIGKILL SIGPROF SIGSTOP SIGXCPU alarm "
    "pthread_sigmask setitimer siginterrupt",
}


class Missing:
    """A finder by which some modules cannot be imported."""

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> None:
        if name in MODULES:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)


for each in BEFORE:
    importlib.import_module(each)
for each in MODULES:
    sys.modules.pop(each, None)
sys.meta_path.insert(0, Missing())
for whole in (os, signal):
    part = ModuleType(whole.__name__)
    part.__dict__.update(whole.__dict__)
    for name in NAMES[whole.__name__].split():
        delattr(part, name)
    sys.modules[whole.__name__] = part
