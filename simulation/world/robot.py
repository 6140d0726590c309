"""The simulated robot: a force-limited planar base with a lidar among obstacles, in MuJoCo.

The only module that imports mujoco.
"""

import math

import numpy as np
from numpy.typing import NDArray

from simulation.world.lidar import Lidar
from simulation.world.motion import BodyVelocity, Pose
from simulation.world.scene import ROBOT, Barrel, Box, Scene

PHYSICS_STEP = 0.002
"""Seconds."""

_ROBOT_GROUP = 3
_LIDAR_HEIGHT = 0.28  # Inside the chassis, which the beams pass through.
_OBSTACLE_HEIGHT = 1.0
_SEARCH_RADIUS = 1.0  # Metres; a clearance beyond it is reported as this much.


class Robot:
    """A Scout Mini in a scene, at rest on the scene's start pose.

    Three joints (x, y, yaw) with velocity actuators carry it: 23 kg and at most 60 N, so it
    brakes with 2.6 m/s2.
    """

    def __init__(self, scene: Scene, lidar: Lidar, seed: int, walker: Barrel | None = None) -> None:
        import mujoco  # here: it takes half a second, and few who read scenarios have a robot

        self._physics = mujoco
        self._model = mujoco.MjModel.from_xml_string(_mjcf(scene, walker))
        self._data = mujoco.MjData(self._model)
        self._data.qpos[:] = scene.start.x, scene.start.y, scene.start.yaw
        self._lidar = lidar
        self._noise = np.random.default_rng([seed, 1])
        self._chassis = self._model.geom(ROBOT.name).id
        standing = (*scene.obstacles, walker) if walker else scene.obstacles
        self._obstacles = [self._model.geom(obstacle.name).id for obstacle in standing]
        self._seen_groups = np.array([group != _ROBOT_GROUP for group in range(6)], np.uint8)
        mujoco.mj_forward(self._model, self._data)

    @property
    def pose(self) -> Pose:
        """The true pose; yaw within -pi..pi."""
        x, y, yaw = map(float, self._data.qpos)
        return Pose(x, y, math.remainder(yaw, 2 * math.pi))

    @property
    def velocity(self) -> BodyVelocity:
        """The true velocity in the body frame."""
        east, north, turn = map(float, self._data.qvel)
        yaw = float(self._data.qpos[2])
        return BodyVelocity(east * math.cos(yaw) + north * math.sin(yaw), turn)

    def place_walker(self, x: float, y: float) -> None:
        """Put the one obstacle that moves somewhere else; metres."""
        self._data.mocap_pos[0, :2] = x, y

    def drive(self, command: BodyVelocity, steps: int) -> None:
        """Hold a command for a number of physics steps, at least one; then the truth is new."""
        for _ in range(steps):
            yaw = float(self._data.qpos[2])
            forward = command.forward
            self._data.ctrl[:] = forward * math.cos(yaw), forward * math.sin(yaw), command.turn
            self._physics.mj_step(self._model, self._data)
        self._physics.mj_forward(self._model, self._data)  # Distances need the new positions.

    def scan(self) -> NDArray[np.float32]:
        """One scan, noise included: shape (beams,), as `Lidar.report` gives it."""
        noise = self._noise.normal(0.0, self._lidar.noise, self._lidar.beams)
        return self._lidar.report(self._distances(), noise)

    def clearance(self) -> float:
        """True metres between chassis and nearest obstacle, at most 1; negative when in contact."""
        model, data, chassis = self._model, self._data, self._chassis
        distances = (
            float(
                self._physics.mj_geomDistance(model, data, chassis, obstacle, _SEARCH_RADIUS, None)
            )
            for obstacle in self._obstacles
        )
        return min(distances, default=_SEARCH_RADIUS)

    def touching(self) -> bool:
        """True while the chassis is in contact with an obstacle."""
        return bool(self._data.ncon > 0)

    def _distances(self) -> NDArray[np.float64]:
        """Shape (beams,): exact distances along the beams, +inf where there is nothing."""
        beams, pose = self._lidar.beams, self.pose
        angles = self._lidar.angles + pose.yaw
        directions = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(beams)])
        distances = np.empty(beams)
        # By keyword: releases differ in the order and number of arguments.
        self._physics.mj_multiRay(
            m=self._model,
            d=self._data,
            pnt=np.array([pose.x, pose.y, _LIDAR_HEIGHT]),
            vec=directions.ravel(),
            geomgroup=self._seen_groups,
            flg_static=1,
            bodyexclude=-1,
            geomid=np.empty(beams, np.int32),
            dist=distances,
            normal=None,
            nray=beams,
            cutoff=2 * self._lidar.range_max,
        )
        distances[distances < 0] = np.inf
        return distances


def _mjcf(scene: Scene, walker: Barrel | None) -> str:
    """The scene and the robot as MuJoCo's model text."""
    obstacles = "\n    ".join(_geom(obstacle) for obstacle in scene.obstacles)
    if walker is not None:
        body = _geom(Barrel(walker.name, 0.0, 0.0, walker.radius))
        where = f'pos="{walker.x} {walker.y} 0"'
        obstacles += f'\n    <body name="walks" mocap="true" {where}>{body}</body>'
    return f"""<mujoco model="store">
  <compiler angle="radian"/>
  <option timestep="{PHYSICS_STEP}" integrator="implicitfast"/>
  <worldbody>
    {obstacles}
    <body name="base" pos="0 0 0.17">
      <joint name="x" type="slide" axis="1 0 0"/>
      <joint name="y" type="slide" axis="0 1 0"/>
      <joint name="yaw" type="hinge" axis="0 0 1"/>
      <geom name="{ROBOT.name}" type="box" size="{ROBOT.length / 2} {ROBOT.width / 2} 0.12"
            mass="23" friction="0.4" group="{_ROBOT_GROUP}"/>
    </body>
  </worldbody>
  <actuator>
    <velocity joint="x" kv="600" forcerange="-60 60"/>
    <velocity joint="y" kv="600" forcerange="-60 60"/>
    <velocity joint="yaw" kv="60" forcerange="-6 6"/>
  </actuator>
</mujoco>"""


def _geom(obstacle: Box | Barrel) -> str:
    """One obstacle, standing on the floor."""
    half = _OBSTACLE_HEIGHT / 2
    where = f'name="{obstacle.name}" pos="{obstacle.x} {obstacle.y} {half}"'
    match obstacle:
        case Box(length=length, width=width, yaw=yaw):
            size = f"{length / 2} {width / 2} {half}"
            return f'<geom {where} type="box" size="{size}" euler="0 0 {yaw}"/>'
        case Barrel(radius=radius):
            return f'<geom {where} type="cylinder" size="{radius} {half}"/>'
