"""Positions of one frame in another, from the transforms that a robot publishes on `/tf`.

The answers are those of tf2's `lookupTransform(target, source, TimePointZero)`: at the latest stamp
at which each frame between the two is known. Between two stamps, positions are interpolated
linearly and rotations by slerp; nothing is extrapolated. tf2's `buffer_core.cpp` and
`time_cache.cpp` (Open Robotics, BSD) define the behaviour. `fretc.logs.signals.frames` reads the
same samples from a recording. The text of this module is copied into emitted nodes: it needs the
standard library only.
"""

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from monitors.kernel.readings import Reading

KEPT_TRANSFORMS = 10 * 10**9
"""Nanoseconds before the latest transform of a frame that tf2 keeps by default."""
_MOST_FRAMES = 1000
"""The longest chain of frames; a longer one is a loop."""
_POLE = 0.99999
"""The sine of the pitch from which on roll and yaw are the same rotation."""


class FrameTransform(NamedTuple):
    """The pose of frame `child` in frame `parent`, at a stamp in nanoseconds."""

    stamp: int
    parent: str
    child: str
    translation: "tuple[float, ...]"
    rotation: "tuple[float, ...]"


class Pose(NamedTuple):
    """A position, x, y, z in metres, and a rotation, a quaternion x, y, z, w."""

    vector: "tuple[float, ...]"
    rotation: "tuple[float, ...]"


class FrameQuery(NamedTuple):
    """A number of the pose of frame `source` in frame `target`."""

    name: str
    """The name of the signal."""
    topic: str
    """The topic of the transforms; that of static ones has `_static` behind it."""
    source: str
    target: str
    number: str
    """`x`, `y`, `z`, `distance`, `yaw`, `pitch` or `roll`: metres and radians."""


def transforms_of(
    message: Any, field: "Callable[[Any, str], Any]" = getattr
) -> "Iterator[FrameTransform]":
    """The transforms in a message of type tf2_msgs/TFMessage; `field` reads a field by its name.

    Raises:
        AttributeError, TypeError, ValueError: the message has another type.
    """
    for each in field(message, "transforms"):
        header, pose = field(each, "header"), field(each, "transform")
        vector, rotation = field(pose, "translation"), field(pose, "rotation")
        yield FrameTransform(
            _nanoseconds(field(header, "stamp"), field),
            str(field(header, "frame_id")).lstrip("/"),
            str(field(each, "child_frame_id")).lstrip("/"),
            tuple(float(field(vector, name)) for name in "xyz"),
            tuple(float(field(rotation, name)) for name in "xyzw"),
        )


def _nanoseconds(stamp: Any, field: "Callable[[Any, str], Any]") -> int:
    try:
        return int(field(stamp, "sec")) * 10**9 + int(field(stamp, "nanosec"))
    except (AttributeError, KeyError):  # ROS 1
        return int(field(stamp, "secs")) * 10**9 + int(field(stamp, "nsecs"))


class _Frame:
    """The transforms of one frame to its parents, in order of their stamps.

    A static frame has one transform, which holds at any time.
    """

    def __init__(self, *, static: bool) -> None:
        self.static = static
        self.stamps: list[int] = []
        self._transforms: list[FrameTransform] = []

    def put(self, transform: FrameTransform) -> None:
        if self.static:
            self.stamps, self._transforms = [0], [transform]
            return
        stamp, oldest = transform.stamp, self.latest - KEPT_TRANSFORMS
        count = bisect_left(self.stamps, oldest) if self.stamps else 0
        del self.stamps[:count], self._transforms[:count]
        if self.stamps and stamp < oldest:
            return
        begin, end = bisect_left(self.stamps, stamp), bisect_right(self.stamps, stamp)
        if transform not in self._transforms[begin:end]:
            self.stamps.insert(end, stamp)
            self._transforms.insert(end, transform)

    @property
    def latest(self) -> int:
        return self.stamps[-1] if self.stamps else 0

    @property
    def parent(self) -> str:
        return self._transforms[-1].parent

    def at(self, time: int) -> "FrameTransform | None":
        """The transform at a time, 0 for the latest; None if it would be extrapolated."""
        if self.static or not time or time == self.latest:
            return self._transforms[-1]
        if not self.stamps[0] <= time <= self.latest:
            return None
        if time == self.stamps[0]:
            return self._transforms[0]
        index = bisect_right(self.stamps, time)
        before, after = self._transforms[index - 1], self._transforms[index]
        if before.parent != after.parent:
            return before
        share = (time - before.stamp) / (after.stamp - before.stamp)
        vector = tuple(
            (1.0 - share) * a + share * b for a, b in zip(before.translation, after.translation)
        )
        return before._replace(
            translation=vector, rotation=_slerp(before.rotation, after.rotation, share)
        )


_ORIGIN = Pose((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))


class TransformBuffer:
    """The transforms of the last ten seconds, as tf2 keeps them."""

    def __init__(self) -> None:
        """Start without transforms."""
        self._frames: dict[str, _Frame] = {}

    def put(self, transform: FrameTransform, *, static: bool) -> None:
        """Add a transform; one that tf2 refuses is ignored, and a quaternion is normalized."""
        parent, child = transform.parent, transform.child
        numbers = (*transform.translation, *transform.rotation)
        square = sum(part * part for part in transform.rotation)
        if parent == child or not parent or not child or any(map(math.isnan, numbers)):
            return
        if not 0.0 < square < math.inf:
            return
        rotation = tuple(part / math.sqrt(square) for part in transform.rotation)
        transform = transform._replace(rotation=rotation)
        frame = self._frames.get(child)
        if frame is None or frame.static is not static:
            frame = self._frames[child] = _Frame(static=static)
        frame.put(transform)

    def forget(self) -> None:
        """Drop the transforms that are not static, because messages were lost."""
        self._frames = {name: frame for name, frame in self._frames.items() if frame.static}

    def latest_common_time(self, target: str, source: str) -> "int | None":
        """The latest stamp at which each frame between the two is known.

        0: only static transforms are between them; None: they are not connected.
        """
        own = self._latest_chain(source, target)
        if own is None:
            return None
        if own and own[-1][1] == target:
            return _least(own)
        others = self._latest_chain(target, source)
        if others is None:
            return None
        if others and others[-1][1] == source:
            return _least(others)
        # The first frame of the one chain that is in the other: their common parent.
        places = {name: place for place, (_, name) in reversed([*enumerate(own)])}
        for place, (_, name) in enumerate(others):
            if name in places:
                return _least([*others[: place + 1], *own[: places[name] + 1]])
        return None

    def _latest_chain(self, start: str, end: str) -> "list[tuple[int, str]] | None":
        """Latest stamp and parent of each frame from `start` to the root, or to `end`."""
        chain: list[tuple[int, str]] = []
        frame = self._frames.get(start)
        while frame is not None:
            if len(chain) > _MOST_FRAMES:
                return None
            chain.append((0 if frame.static else frame.latest, frame.parent))
            if frame.parent == end:
                break
            frame = self._frames.get(frame.parent)
        return chain

    def lookup(self, target: str, source: str, time: int) -> "Pose | None":
        """The pose of frame `source` in frame `target` at a stamp; None: unknown."""
        own = self._poses(source, {target}, time)
        if own is None or target in own:
            return None if own is None else own[target]
        *_, root = own
        others = self._poses(target, {root, source}, time)
        if others is None:
            return None
        *_, end = others
        if end not in own:
            return None
        back = _inverse(others[end].rotation)
        away = _rotated(back, tuple(-part for part in others[end].vector))
        return _moved(Pose(away, back), own[end])

    def _poses(self, start: str, ends: "Collection[str]", time: int) -> "dict[str, Pose] | None":
        """The pose of frame `start` in each frame from itself to the root, or to one of `ends`.

        The root is the last frame whose transform at that time is not known. None: a loop.
        """
        poses = {start: _ORIGIN}
        frame = start
        while frame not in ends:
            known = self._frames.get(frame)
            transform = None if known is None else known.at(time)
            if transform is None:
                return poses
            if transform.parent in poses or len(poses) > _MOST_FRAMES:
                return None
            pose = Pose(transform.translation, transform.rotation)
            poses[transform.parent] = _moved(pose, poses[frame])
            frame = transform.parent
        return poses


def _least(chain: "Iterable[tuple[int, str]]") -> int:
    return min((stamp for stamp, _ in chain if stamp), default=0)


# Rotations: the formulas of tf2, in their order of operations --------------------------------


def _product(a: "tuple[float, ...]", b: "tuple[float, ...]") -> "tuple[float, ...]":
    return (
        a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
        a[3] * b[1] + a[1] * b[3] + a[2] * b[0] - a[0] * b[2],
        a[3] * b[2] + a[2] * b[3] + a[0] * b[1] - a[1] * b[0],
        a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
    )


def _inverse(q: "tuple[float, ...]") -> "tuple[float, ...]":
    return -q[0], -q[1], -q[2], q[3]


def _rotated(q: "tuple[float, ...]", v: "tuple[float, ...]") -> "tuple[float, ...]":
    turned = (
        q[3] * v[0] + q[1] * v[2] - q[2] * v[1],
        q[3] * v[1] + q[2] * v[0] - q[0] * v[2],
        q[3] * v[2] + q[0] * v[1] - q[1] * v[0],
        -q[0] * v[0] - q[1] * v[1] - q[2] * v[2],
    )
    return _product(turned, _inverse(q))[:3]


def _moved(by: Pose, pose: Pose) -> Pose:
    """A pose in a frame, in the frame in which `by` is the pose of that frame."""
    turned = _rotated(by.rotation, pose.vector)
    vector = tuple(a + b for a, b in zip(turned, by.vector))
    return Pose(vector, _product(by.rotation, pose.rotation))


def _slerp(a: "tuple[float, ...]", b: "tuple[float, ...]", share: float) -> "tuple[float, ...]":
    dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
    squares = [q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] for q in (a, b)]
    cosine = abs(dot) / math.sqrt(squares[0] * squares[1])
    theta = math.acos(max(-1.0, min(1.0, cosine)))
    if theta == 0.0:
        return a
    over = 1.0 / math.sin(theta)
    first, second = math.sin((1.0 - share) * theta), math.sin(share * theta)
    sign = -1.0 if dot < 0 else 1.0
    return tuple((p * first + sign * q * second) * over for p, q in zip(a, b))


def pose_number(number: str, pose: Pose) -> Reading:
    """A number of a pose; None where it is not finite."""
    if number in ("x", "y", "z"):
        value = pose.vector["xyz".index(number)]
    elif number == "distance":
        value = math.sqrt(sum(part * part for part in pose.vector))
    else:
        value = _angles(pose.rotation)[("yaw", "pitch", "roll").index(number)]
    return value if math.isfinite(value) else None


def _angles(rotation: "tuple[float, ...]") -> "tuple[float, float, float]":
    """Yaw, pitch and roll, as tf2's `getEulerYPR` defines them."""
    x, y, z, w = rotation
    sine = -2 * (x * z - w * y) / (x * x + y * y + z * z + w * w)
    if sine <= -_POLE:
        return -2 * math.atan2(y, x), -0.5 * math.pi, 0.0
    if sine >= _POLE:
        return 2 * math.atan2(y, x), 0.5 * math.pi, 0.0
    return (
        math.atan2(2 * (x * y + w * z), w * w + x * x - y * y - z * z),
        math.asin(sine),
        math.atan2(2 * (y * z + w * x), w * w - x * x - y * y + z * z),
    )


# From messages to samples --------------------------------------------------------------------


class FrameSignals:
    """The samples of all signals of frames, from messages in the order of their arrival.

    A message of a topic of transforms gives a signal a sample if it changes the answer of tf2, or
    the stamp for which the answer holds. Static transforms count from the next such message on.
    """

    def __init__(self, queries: "Sequence[FrameQuery]") -> None:
        """Start before the first message."""
        self._queries = queries
        self._buffers = {query.topic: TransformBuffer() for query in queries}
        self._answers: dict[str, tuple[int | None, Reading]] = {}

    @property
    def static_topics(self) -> "Mapping[str, str]":
        """The topics of static transforms, each with the topic of the others."""
        return {f"{topic}_static": topic for topic in self._buffers}

    def reads(self, topic: str) -> bool:
        """Whether messages of a topic are of use."""
        return topic in self._buffers or topic in self.static_topics

    def take(self, topic: str, transforms: "Iterable[FrameTransform]") -> "Mapping[str, Reading]":
        """Add the transforms of a message.

        Returns:
            The new sample of each signal that has one; None: unknown.
        """
        static = self.static_topics.get(topic)
        buffer = self._buffers[topic if static is None else static]
        for transform in transforms:
            buffer.put(transform, static=static is not None)
        return self._changes(topic) if static is None else {}

    def read(self, topic: str, message: Any) -> "Mapping[str, Reading]":
        """Add the transforms of a message; None: a message that cannot be read.

        Raises:
            AttributeError, TypeError, ValueError: the message has another type.
        """
        if message is None:
            return self.lose(topic)
        return self.take(topic, tuple(transforms_of(message)))

    def forget(self) -> None:
        """Forget all transforms that are not static, because messages were lost."""
        for topic in self._buffers:
            self.lose(topic)

    def lose(self, topic: str) -> "Mapping[str, Reading]":
        """Forget what has been received: messages of the topic were lost, or cannot be read.

        Returns:
            Unknown samples of the signals of the topic.
        """
        topic = self.static_topics.get(topic, topic)
        self._buffers[topic].forget()
        lost = [query.name for query in self._queries if query.topic == topic]
        for name in lost:
            self._answers.pop(name, None)
        return dict.fromkeys(lost)

    def _changes(self, topic: str) -> "Mapping[str, Reading]":
        """The samples of the signals of a topic whose answers have changed."""
        buffer = self._buffers[topic]
        poses: dict[tuple[str, str], tuple[int | None, Pose | None]] = {}
        samples: dict[str, Reading] = {}
        for query in self._queries:
            if query.topic != topic:
                continue
            pair = query.target, query.source
            if pair not in poses:
                time = buffer.latest_common_time(*pair)
                poses[pair] = time, None if time is None else buffer.lookup(*pair, time)
            time, pose = poses[pair]
            answer = time, None if pose is None else pose_number(query.number, pose)
            if self._answers.get(query.name) != answer:
                self._answers[query.name] = answer
                samples[query.name] = answer[1]
        return samples
