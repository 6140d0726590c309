"""A mission seen from above: the map, what was not where the map has it, the way, the stops."""

from collections.abc import Sequence
from io import BytesIO
from math import dist
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray
from PIL import Image

from simulation.mission import Contact, Mission
from simulation.world.motion import Pose
from simulation.world.scene import ROBOT, STORE, Barrel, Box

_INK, _MAPPED, _MOVED, _WAY, _STOP, _GOAL, _CONTACT = (
    "#333333",
    "#b8c4cf",
    "#e8871e",
    "#2463a8",
    "#c0182a",
    "#2e8540",
    "#8a1a9b",
)

_HEADING = 10
"""Seconds from an arrow of the way to the next; every third has its time."""
_APART = 0.4
"""Metres between contacts with a name of their own; between arrows of the way half of it."""
_EVERY, _FRAME = 20, 66
"""Tenths of a simulated second from a frame to the next; milliseconds that it is shown."""


def draw(mission: Mission) -> bytes:
    """The picture as PNG."""
    figure, axes = _figure(mission, 110)
    _way(axes, mission)
    figure.legend(loc="outside lower center", ncols=4, frameon=False, fontsize=9)
    image = BytesIO()
    figure.savefig(image, format="png")
    return image.getvalue()


def animate(mission: Mission) -> bytes:
    """The mission as GIF, at some thirty times its speed."""
    figure, axes = _figure(mission, 60)
    canvas: Any = FigureCanvasAgg(figure)  # Any: it carries no annotations.
    (line,) = axes.plot([], [], color=_WAY, lw=1.6)
    robot = axes.add_patch(_outline(ROBOT, mission.track[0], facecolor=_WAY, alpha=0.6))
    (nose,) = axes.plot([], [], color=_INK, lw=2.2, solid_capstyle="round", zorder=4)
    marks = axes.scatter([], [], marker="X", s=60, color=_STOP, zorder=5)
    hits = axes.scatter([], [], marker="*", s=120, color=_CONTACT, zorder=8)
    clock, state = (_caption(axes, x) for x in (0.03, 0.16))
    frames = []
    for count in _counts(len(mission.track)):
        track, now = mission.track[:count], (count - 1) / 10
        if count == len(mission.track):
            now = mission.duration  # what came after the last tenth of a second is in it, too
        line.set_data([p.x for p in track], [p.y for p in track])
        robot.set_xy(_corners(ROBOT, track[-1]))
        nose.set_data(*_nose(track[-1]))
        for markers, events in ((marks, mission.stops), (hits, mission.touched)):
            past = [(e.at.x, e.at.y) for e in events if e.seconds <= now]
            markers.set_offsets(np.array(past).reshape(-1, 2))
        clock.set_text(f"{now:.1f} s")
        text, colour = _state(mission, now)
        touched = sum(contact.seconds <= now for contact in mission.touched)
        state.set(text=f"{text}{_times(touched)}", color=colour)
        canvas.draw()
        frame = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
        frames.append(frame.quantize(colors=256))
    image = BytesIO()
    first, *others = frames
    first.save(image, format="GIF", save_all=True, append_images=others, duration=_FRAME, loop=0)
    return image.getvalue()


def _caption(axes: Any, x: float) -> Any:
    """A text over the room, empty so far."""
    return axes.text(
        x,
        0.955,
        "",
        transform=axes.transAxes,
        va="top",
        fontsize=13,
        color=_INK,
        zorder=10,
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 2},
    )


def _counts(length: int) -> list[int]:
    """How much of the way each frame has; the last one has all of it."""
    counts = [*range(1, length + 1, _EVERY)]
    return counts if not counts or counts[-1] == length else [*counts, length]


def _state(mission: Mission, now: float) -> tuple[str, str]:
    """What the safety function wants, in words and a colour."""
    if not mission.scenario.safety.on:
        return "no safety function", _INK
    wanted = [stop for seconds, stop in mission.requests if seconds <= now]
    if not wanted:
        return "the safety function is silent", _INK
    return ("stop requested", _STOP) if wanted[-1] else ("free to drive", _GOAL)


def _times(contacts: int) -> str:
    return "" if not contacts else f", {contacts} contact{'s' if contacts > 1 else ''}"


def _nose(at: Pose) -> tuple[list[float], list[float]]:
    """A line from the middle of the robot to its front."""
    ahead = ROBOT.length / 2
    return [at.x, at.x + ahead * np.cos(at.yaw)], [at.y, at.y + ahead * np.sin(at.yaw)]


def _figure(mission: Mission, dpi: int) -> tuple[Figure, Any]:
    """The room with its inspection points, without the robot."""
    figure = Figure(figsize=(9.0, 7.6), dpi=dpi, layout="constrained")
    axes = figure.add_subplot()
    _room(axes, mission)
    _goals(axes)
    axes.set_aspect("equal")
    axes.set_xlim(-0.25, STORE.length + 0.25)
    axes.set_ylim(-0.25, STORE.width + 0.25)
    axes.set_xlabel("x in m")
    axes.set_ylabel("y in m")
    figure.suptitle(f"{mission.scenario.title} (seed {mission.seed})", fontsize=13)
    axes.set_title(_summary(mission), fontsize=10, color=_INK)
    return figure, axes


def _summary(mission: Mission) -> str:
    return (
        f"{mission.duration:.0f} s, {mission.goals_reached} of {mission.goals_total} goals, "
        f"{len(mission.stops)} stops, {mission.contacts} contacts, "
        f"least true clearance {mission.true_clearance * 100:.1f} cm"
    )


def _room(axes: Any, mission: Mission) -> None:
    real = {obstacle.name: obstacle for obstacle in mission.scene.obstacles}
    labels = {"on the map": _MAPPED}
    for obstacle in STORE.obstacles:
        if real[obstacle.name] == obstacle:
            axes.add_patch(_shape(obstacle, facecolor=_MAPPED, edgecolor=_INK, lw=0.8))
            continue
        labels["really there, not on the map"] = _MOVED
        ghost = _shape(obstacle, facecolor="none", edgecolor=_INK, lw=1.0, ls=":")
        axes.add_patch(ghost)
        moved = real[obstacle.name]
        axes.add_patch(_shape(moved, facecolor=_MOVED, edgecolor=_INK, lw=1.0))
    walker = mission.scenario.store.walker
    if walker is not None:
        labels["somebody who walks in"] = _MOVED
        axes.add_patch(Circle(walker.end, walker.radius, facecolor=_MOVED, edgecolor=_INK, lw=1.0))
        axes.annotate(
            "", walker.end, walker.start, arrowprops={"arrowstyle": "->", "color": _MOVED, "lw": 2}
        )
    for text, colour in labels.items():
        axes.scatter([], [], marker="s", s=70, color=colour, edgecolor=_INK, lw=0.8, label=text)


def _shape(obstacle: Box | Barrel, **style: Any) -> Circle | Polygon:
    if isinstance(obstacle, Barrel):
        return Circle((obstacle.x, obstacle.y), obstacle.radius, **style)
    return _outline(obstacle, Pose(obstacle.x, obstacle.y, obstacle.yaw), **style)


def _outline(box: Box, at: Pose, **style: Any) -> Polygon:
    """A box seen from above, somewhere else than where it says."""
    return Polygon(_corners(box, at), closed=True, **style)


def _corners(box: Box, at: Pose) -> NDArray[np.float64]:
    half, side = box.length / 2, box.width / 2
    corners = [(half, side), (-half, side), (-half, -side), (half, -side)]
    turned = Affine2D().rotate(at.yaw).translate(at.x, at.y).transform(corners)
    return np.asarray(turned, np.float64)


def _way(axes: Any, mission: Mission) -> None:
    track = mission.track
    axes.plot(
        [p.x for p in track], [p.y for p in track], color=_WAY, lw=1.6, label="the robot's way"
    )
    if track:
        axes.add_patch(_outline(ROBOT, track[-1], facecolor=_WAY, alpha=0.35, edgecolor=_WAY))
        axes.plot(*_nose(track[-1]), color=_INK, lw=2.2, solid_capstyle="round")
    _headings(axes, track)
    for stop in mission.stops:
        axes.add_patch(_outline(ROBOT, stop.at, facecolor="none", edgecolor=_STOP, lw=1.0))
    if mission.stops:
        axes.scatter(
            [stop.at.x for stop in mission.stops],
            [stop.at.y for stop in mission.stops],
            marker="X",
            s=70,
            color=_STOP,
            zorder=5,
            label="stopped by the safety function",
        )
    if mission.touched:
        axes.scatter(
            [contact.at.x for contact in mission.touched],
            [contact.at.y for contact in mission.touched],
            marker="*",
            s=190,
            color=_CONTACT,
            zorder=8,
            label="contact with an obstacle",
        )
    for contacts in _clusters(mission.touched):
        axes.annotate(
            _contact_times(contacts),
            (contacts[0].at.x, contacts[0].at.y),
            xytext=(11, -14),
            textcoords="offset points",
            fontsize=8,
            color=_CONTACT,
            zorder=9,
        )


def _clusters(contacts: Sequence[Contact]) -> list[list[Contact]]:
    """The contacts by their places, so that names do not overlap."""
    clusters: list[list[Contact]] = []
    for contact in contacts:
        here = (contact.at.x, contact.at.y)
        for cluster in clusters:
            if dist((cluster[0].at.x, cluster[0].at.y), here) < _APART:
                cluster.append(contact)
                break
        else:
            clusters.append([contact])
    return clusters


def _contact_times(contacts: Sequence[Contact]) -> str:
    """`12.5 s`; `5 contacts: 12.5, 29.4, 29.5 s, ...`."""
    times = ", ".join(f"{contact.seconds:.1f}" for contact in contacts[:3])
    more = ", ..." if len(contacts) > 3 else ""
    count = f"{len(contacts)} contacts: " if len(contacts) > 1 else ""
    return f"{count}{times} s{more}"


def _headings(axes: Any, track: Sequence[Pose]) -> None:
    """Where the robot was every ten seconds, and where it looked; not again while it stands."""
    poses = track[:: 10 * _HEADING]
    drawn: list[Pose] = []
    for seconds, pose in zip(range(0, 10**9, _HEADING), poses, strict=False):
        if drawn and dist((drawn[-1].x, drawn[-1].y), (pose.x, pose.y)) < _APART / 2:
            continue
        drawn.append(pose)
        xs, ys = _nose(pose)
        axes.annotate(
            "",
            (xs[1], ys[1]),
            (xs[0], ys[0]),
            arrowprops={"arrowstyle": "-|>", "color": _WAY, "lw": 1.0, "shrinkA": 0, "shrinkB": 0},
        )
        if len(drawn) % 3 == 0:
            axes.annotate(
                f"{seconds} s",
                (pose.x, pose.y),
                xytext=(5, 5),
                textcoords="offset points",
                fontsize=7,
                color=_WAY,
            )


def _goals(axes: Any) -> None:
    *points, home = STORE.goals
    axes.scatter(
        [p.x for p in points],
        [p.y for p in points],
        marker="o",
        s=170,
        facecolor="white",
        edgecolor=_GOAL,
        lw=1.8,
        zorder=6,
        label="inspection point",
    )
    for number, point in enumerate(points, 1):
        axes.text(
            point.x, point.y, str(number), ha="center", va="center_baseline", color=_GOAL, zorder=7
        )
    axes.scatter(
        [home.x], [home.y], marker="*", s=190, color=_GOAL, zorder=6, label="start and end"
    )
