"""A mission seen from above: the map, what was not where the map has it, the way, the stops."""

from pathlib import Path
from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
from matplotlib.transforms import Affine2D

from simulation.mission import Mission
from simulation.motion import Pose
from simulation.scene import ROBOT, STORE, Barrel, Box

_INK, _MAPPED, _MOVED, _WAY, _STOP, _GOAL = (
    "#333333",
    "#b8c4cf",
    "#e8871e",
    "#2463a8",
    "#c0182a",
    "#2e8540",
)


def draw(mission: Mission, path: Path) -> None:
    """Write the picture as PNG.

    Raises:
        OSError: the file cannot be written.
    """
    figure = Figure(figsize=(9.0, 7.6), dpi=110, layout="constrained")
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    _room(axes, mission)
    _way(axes, mission)
    _goals(axes)
    axes.set_aspect("equal")
    axes.set_xlim(-0.25, STORE.length + 0.25)
    axes.set_ylim(-0.25, STORE.width + 0.25)
    axes.set_xlabel("x in m")
    axes.set_ylabel("y in m")
    figure.suptitle(f"{mission.scenario.title} (seed {mission.seed})", fontsize=13)
    axes.set_title(_summary(mission), fontsize=10, color=_INK)
    figure.legend(loc="outside lower center", ncols=4, frameon=False, fontsize=9)
    canvas.print_figure(path, format="png")


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
        shown = real[obstacle.name]
        axes.add_patch(_shape(shown, facecolor=_MOVED, edgecolor=_INK, lw=1.0))
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
    half, side = box.length / 2, box.width / 2
    corners = [(half, side), (-half, side), (-half, -side), (half, -side)]
    turned = Affine2D().rotate(at.yaw).translate(at.x, at.y).transform(corners)
    return Polygon(turned, closed=True, **style)


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
