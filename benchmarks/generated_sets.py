"""Requirement sets as industry writes them: modes, thresholds, hysteresis, timeouts, latches."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from fretish.bindings.declarations import Role

Roles = Mapping[str, Role]


def controllers(count: int) -> tuple[Sequence[str], Roles]:
    """Ten sentences for each of some controllers, which share nothing; and the roles."""
    sentences: list[str] = []
    roles: dict[str, Role] = {}
    for i in range(count):
        sentences += [
            f"the unit{i} shall always satisfy mode{i} = 0 | mode{i} = 1 | mode{i} = 2",
            f"upon start{i} the unit{i} shall within {3 + i % 5} ticks "
            f"satisfy mode{i} = 1 | stop{i}",
            f"whenever stop{i} the unit{i} shall immediately satisfy mode{i} = 0",
            f"whenever temperature{i} > {80 + i} the unit{i} shall immediately satisfy !heater{i}",
            f"whenever temperature{i} < {60 - i} the unit{i} shall immediately satisfy heater{i}",
            f"whenever pressure{i} > {100 + i} the unit{i} shall within 3 ticks satisfy alarm{i}",
            f"whenever preBool(false, alarm{i}) & !reset{i} the unit{i} shall immediately satisfy "
            f"alarm{i}",
            f"whenever mode{i} = 0 the unit{i} shall within 5 ticks satisfy speed{i} < 1",
            f"the unit{i} shall always satisfy speed{i} >= 0 & speed{i} <= {20 + i} & "
            f"absReal(speed{i} - preReal(0.0, speed{i})) <= 8",
            f"upon mode{i} = 2 the unit{i} shall for 10 ticks satisfy speed{i} <= 10 & "
            f"(alarm{i} => !heater{i} | temperature{i} < 60)",
        ]
        inputs = ("start", "stop", "reset", "temperature", "pressure")
        roles |= {f"{name}{i}": Role.INPUT for name in inputs}
        outputs = ("mode", "heater", "alarm", "speed")
        roles |= {f"{name}{i}": Role.OUTPUT for name in outputs}
    return sentences, roles


def one_plant() -> tuple[Sequence[str], Roles]:
    """Fifty sentences that share outputs, over five numbers."""
    inputs, outputs = ("level", "flow", "heat"), ("valve", "pump")
    lamps = [f"lamp{i}" for i in range(8)]
    sentences = [
        "the plant shall always satisfy valve >= 0 & valve <= 100",
        "the plant shall always satisfy pump >= 0 & pump <= 50",
        "whenever level > 90 the plant shall immediately satisfy valve >= 80",
        "whenever level < 10 the plant shall immediately satisfy valve <= 5",
        "whenever flow > 40 the plant shall within 2 ticks satisfy pump <= 10",
        "whenever heat > 70 the plant shall within 5 ticks satisfy pump >= 20 | flow > 40",
        "whenever emergency the plant shall immediately satisfy pump = 0",
        "upon emergency the plant shall for 5 ticks satisfy lamp0",
        "whenever pump = 0 & valve > 50 the plant shall immediately satisfy lamp1",
        "whenever preBool(false, lamp1) & !reset the plant shall immediately satisfy lamp1",
    ]
    for i in range(8):
        sentences += [
            f"whenever level > {20 + 8 * i} the plant shall within {1 + i % 3} ticks "
            f"satisfy lamp{i}",
            f"whenever flow > {5 + 4 * i} & heat > {30 + 4 * i} the plant shall immediately "
            f"satisfy lamp{i} | valve > {10 + 5 * i}",
            f"whenever lamp{i} & reset the plant shall at the next timepoint satisfy lamp{i} | "
            f"pump < {30 + i}",
            f"upon heat > {40 + 5 * i} the plant shall for {2 + i % 4} ticks satisfy "
            f"pump <= {45 - i} | lamp{i}",
            f"the plant shall always satisfy lamp{i} | lamp{(i + 1) % 8} | valve <= {90 - i}",
        ]
    roles = dict.fromkeys((*inputs, "emergency", "reset"), Role.INPUT)
    return sentences, {**roles, **dict.fromkeys((*outputs, *lamps), Role.OUTPUT)}
