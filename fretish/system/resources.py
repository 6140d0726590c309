"""Time and memory: what this process uses, and limits by which it is interrupted or ended.

| | Linux | macOS | Windows |
|---|---|---|---|
| interruption by CPU time | timer | timer | thread |
| end by CPU time | system | system | thread |
| end by memory | system | thread | thread |

In WebAssembly there are neither timers nor threads: the program that runs Python sets the limits.

A thread notices an excess only when a library lets Python's threads run. Callers have a limit on
the wall clock, too.
"""

from __future__ import annotations

import _thread
import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from math import ceil, inf
from pathlib import Path
from threading import Event, Thread
from types import FrameType

OUT_OF_TIME, OUT_OF_MEMORY = 124, 125
"""Exit statuses of a process that a thread has ended."""
_STATM = Path("/proc/self/statm")
"""Where Linux states the memory of this process, in pages."""
_PERIOD = 0.05
"""Seconds between two checks of a thread."""


if sys.platform == "win32":
    import ctypes

    class _Counters(ctypes.Structure):
        """PROCESS_MEMORY_COUNTERS."""

        _fields_ = [
            ("cb", ctypes.c_uint32),
            ("page_faults", ctypes.c_uint32),
            ("peak_working_set", ctypes.c_size_t),
            ("working_set", ctypes.c_size_t),
            ("rest", ctypes.c_size_t * 6),
        ]

    def resident_memory() -> int:
        """The memory of this process in bytes; 0: unknown."""
        counters = _Counters(cb=ctypes.sizeof(_Counters))
        kernel = ctypes.WinDLL("kernel32")
        kernel.GetCurrentProcess.restype = ctypes.c_void_p
        asked = kernel.K32GetProcessMemoryInfo
        asked.argtypes = (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_uint32)
        found = asked(kernel.GetCurrentProcess(), ctypes.byref(counters), counters.cb)
        return int(counters.working_set) if found else 0
else:

    def resident_memory() -> int:
        """The memory of this process in bytes; on macOS the most that it ever had; 0: unknown."""
        with suppress(OSError):
            pages = int(_STATM.read_bytes().split()[1])
            return pages * os.sysconf("SC_PAGE_SIZE")
        try:
            import resource
        except ImportError:
            return 0
        most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return most if sys.platform == "darwin" else most * 1024  # KiB on other systems


def address_space() -> int:
    """The address space of this process in bytes, on Linux; 0 elsewhere."""
    if sys.platform != "win32":
        with suppress(OSError):
            return int(_STATM.read_bytes().split()[0]) * int(os.sysconf("SC_PAGE_SIZE"))
    return 0


@contextmanager
def periodically(seconds: float, look: Callable[[], None]) -> Iterator[None]:
    """Context in which the main thread calls a function every so many CPU seconds.

    Without timers of CPU time (Windows) a second thread counts seconds of the wall clock. In
    WebAssembly the function is never called. The
    function is called between two steps of Python. Its first exception interrupts the block; from
    then on, and after the block, a signal calls nothing.
    """
    if sys.platform == "emscripten":
        yield
        return
    ended = Event()

    def handler(_number: int, _frame: FrameType | None) -> None:
        if ended.is_set():
            return
        try:
            look()
        except BaseException:
            ended.set()  # nothing interrupts what follows, such as the end of this context
            raise

    if sys.platform != "win32" and hasattr(signal, "setitimer"):
        signal.signal(signal.SIGPROF, handler)  # Not reset: a late signal would end the process.
        signal.siginterrupt(signal.SIGPROF, False)
        signal.setitimer(signal.ITIMER_PROF, seconds, seconds)
        try:
            with _set_after(ended):
                yield
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0)
        return
    before = signal.signal(signal.SIGABRT, handler)
    thread = Thread(target=_interrupt, args=(seconds, ended), daemon=True)
    thread.start()
    try:
        with _set_after(ended):
            yield
    finally:
        thread.join()
        signal.signal(signal.SIGABRT, before)


@contextmanager
def _set_after(event: Event) -> Iterator[None]:
    try:
        yield
    finally:
        event.set()


def _interrupt(seconds: float, ended: Event) -> None:
    while not ended.wait(seconds):
        _thread.interrupt_main(signal.SIGABRT)


class ProcessLimits:
    """Limits of this process, which has no other purpose than one task: an excess ends it."""

    def __init__(self, memory: int) -> None:
        """Limit the memory.

        Args:
            memory: bytes, of address space on Linux, elsewhere of resident memory.
        """
        self._seconds, self._memory = inf, memory
        self._has_timer = False
        if sys.platform != "win32":
            try:
                import resource
            except ImportError:
                pass
            else:
                self._has_timer = True
                resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
                if sys.platform == "linux":
                    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
                    return
        Thread(target=self._watch, daemon=True).start()

    def allow(self, seconds: int) -> None:
        """Set the limit to so many CPU seconds from now."""
        if sys.platform == "win32" or not self._has_timer:
            self._seconds = time.process_time() + seconds
            return
        import resource

        used = resource.getrusage(resource.RUSAGE_SELF)
        most = resource.getrlimit(resource.RLIMIT_CPU)[1]
        soon = ceil(used.ru_utime + used.ru_stime) + seconds
        resource.setrlimit(resource.RLIMIT_CPU, (soon if most < 0 else min(soon, most), most))

    def _watch(self) -> None:
        while True:
            time.sleep(_PERIOD)
            if time.process_time() > self._seconds:
                os._exit(OUT_OF_TIME)
            if resident_memory() > self._memory:
                os._exit(OUT_OF_MEMORY)


def exceeded_time(status: int) -> bool:
    """Whether the exit status of a process says that it took more CPU time than allowed."""
    signals = [-getattr(signal, name, 0) for name in ("SIGXCPU", "SIGPROF")]
    return status == OUT_OF_TIME or (status < 0 and status in signals)
