"""A mission seen from above: the map, what was not where the map has it, the way, the stops."""

from io import BytesIO
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray
from PIL import Image

from simulation.mission import Mission
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
    marks = axes.scatter([], [], marker="X", s=60, color=_STOP, zorder=5)
    hits = axes.scatter([], [], marker="*", s=120, color=_CONTACT, zorder=8)
    frames = []
    for count in range(1, len(mission.track) + 1, _EVERY):
        track = mission.track[:count]
        line.set_data([p.x for p in track], [p.y for p in track])
        robot.set_xy(_corners(ROBOT, track[-1]))
        for markers, events in ((marks, mission.stops), (hits, mission.touched)):
            past = [(e.at.x, e.at.y) for e in events if e.seconds <= (count - 1) / 10]
            markers.set_offsets(np.array(past).reshape(-1, 2))
        canvas.draw()
        frame = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
        frames.append(frame.quantize(colors=64))
    image = BytesIO()
    first, *others = frames
    first.save(image, format="GIF", save_all=True, append_images=others, duration=_FRAME, loop=0)
    return image.getvalue()


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
