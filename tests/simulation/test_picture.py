from dataclasses import replace
from io import BytesIO
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from PIL import Image
from PIL.GifImagePlugin import GifImageFile

from simulation.mission import Contact
from simulation.world.motion import Pose
from simulation.world.scenario import load
from tests.simulation.missions import Missions, cut_off, record

pytestmark = pytest.mark.slow  # Matplotlib takes a second to import


@pytest.fixture(scope="module")
def drawing() -> ModuleType:
    """No worker that collects this waits for it."""
    from simulation import picture

    return picture


def test_the_picture_shows_what_was_moved_and_where_the_robot_was_stopped(
    drawing: ModuleType, missions: Missions
) -> None:
    from matplotlib.image import imread

    shares = {}
    for name in ("nominal", "obstacle-moved"):
        image = imread(BytesIO(drawing.draw(missions(cut_off(name)))))[..., :3]
        assert image.shape[0] > 600
        shares[name] = {
            colour: float((np.abs(image - np.array(rgb) / 255).max(axis=2) < 0.02).mean())
            for colour, rgb in {"moved": (232, 135, 30), "stop": (192, 24, 42)}.items()
        }
    assert shares["nominal"] == {"moved": 0.0, "stop": 0.0}
    assert shares["obstacle-moved"]["moved"] > 0.001
    assert shares["obstacle-moved"]["stop"] > 0.0001


def test_the_picture_and_the_film_show_where_the_robot_touched_something(
    drawing: ModuleType, tmp_path: Path
) -> None:
    mission = record(tmp_path / "a.mcap", load("nominal"), max_seconds=4)
    assert mission.touched == ()
    counts = []
    for touched in ((), (Contact(Pose(5.0, 3.0, 0.0), 1.0),)):
        shown = replace(mission, touched=touched)
        for image in (
            Image.open(BytesIO(drawing.draw(shown))),
            Image.open(BytesIO(drawing.animate(shown))),
        ):
            image.seek(getattr(image, "n_frames", 1) - 1)
            seen = np.asarray(image.convert("RGB")).astype(int) - (138, 26, 155)
            counts.append(int((np.abs(seen).max(axis=2) < 60).sum()))
    assert counts[0] == counts[1] == 0
    assert counts[2] > 0 < counts[3]


def test_the_film_shows_the_whole_mission(drawing: ModuleType, missions: Missions) -> None:
    film = Image.open(BytesIO(drawing.animate(missions(cut_off("obstacle-moved")))))
    assert isinstance(film, GifImageFile)
    assert film.n_frames == 12
    red = []
    for frame in (0, 11):
        film.seek(frame)
        seen = np.asarray(film.convert("RGB")).astype(int) - (192, 24, 42)
        red.append(int((np.abs(seen).max(axis=2) < 40).sum()))
    assert red[0] == 0 < red[1]


def test_the_last_frame_has_all_of_the_way(drawing: ModuleType) -> None:
    assert drawing._counts(0) == []
    assert drawing._counts(1) == [1]
    assert drawing._counts(41) == [1, 21, 41]
    assert drawing._counts(45) == [1, 21, 41, 45]


def test_the_robot_looks_where_its_yaw_says(drawing: ModuleType) -> None:
    (x, ahead), (y, up) = drawing._nose(Pose(2.0, 1.0, np.pi / 2))
    assert (x, y) == (2.0, 1.0)
    assert ahead == pytest.approx(2.0)
    assert up > 1.2


def test_every_contact_is_in_one_name(drawing: ModuleType) -> None:
    places = [(1.0, 1.0, 3.0), (1.1, 1.0, 4.5), (5.0, 1.0, 9.0)]
    contacts = [Contact(Pose(x, y), seconds) for x, y, seconds in places]
    clusters = drawing._clusters(contacts)
    assert [contact for cluster in clusters for contact in cluster] == contacts
    assert [drawing._contact_times(cluster) for cluster in clusters] == [
        "2 contacts: 3.0, 4.5 s",
        "9.0 s",
    ]
    assert drawing._contact_times(contacts * 2) == "6 contacts: 3.0, 4.5, 9.0 s, ..."


def test_the_film_says_what_the_safety_function_wants(drawing: ModuleType, tmp_path: Path) -> None:
    mission = record(tmp_path / "a.mcap", load("nominal"), max_seconds=2)
    shown = replace(mission, requests=((0.5, False), (1.0, True), (1.5, False)))
    texts = [drawing._state(shown, now)[0] for now in (0.1, 0.6, 1.0, 1.4, 1.6)]
    assert texts == [
        "the safety function is silent",
        "free to drive",
        "stop requested",
        "stop requested",
        "free to drive",
    ]
    off = replace(shown, scenario=load("safety-off"))
    assert drawing._state(off, 1.0)[0] == "no safety function"
    assert drawing.animate(shown) == drawing.animate(shown)
