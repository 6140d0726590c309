"""DDS for tests: a domain of their own on the loopback, without multicast, and its publishers.

Anyone who waits, waits for what a process or the wire tells, never for a time to pass.
"""

from __future__ import annotations

import os
import random
import socket
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

URI = """<CycloneDDS><Domain>
<General><AllowMulticast>false</AllowMulticast>
<Interfaces><NetworkInterface address="127.0.0.1" multicast="false"/></Interfaces></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex>
<MaxAutoParticipantIndex>20</MaxAutoParticipantIndex>
<LeaseDuration>{lease}</LeaseDuration>
<Peers><Peer address="127.0.0.1"/></Peers></Discovery>
<Internal><SocketReceiveBufferSize min="default" max="16MiB"/></Internal>
</Domain></CycloneDDS>"""


@contextmanager
def domain() -> Iterator[int]:
    """A domain that nobody uses: its first port is held by the test itself."""
    while True:
        number = random.SystemRandom().randint(1, 100)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as held:
            try:
                # the port of multicast discovery, which nobody needs here
                held.bind(("127.0.0.1", 7400 + 250 * number))
            except OSError:
                continue
            yield number
            return


def environment(number: int, lease: str = "10 s") -> Mapping[str, str]:
    """That of a process in the domain, which the others take for lost after so long a silence."""
    uri = URI.format(lease=lease)
    return {**os.environ, "ROS_DOMAIN_ID": str(number), "CYCLONEDDS_URI": uri}
