"""Readings of plain English: which sentences are offered, and that no word is lost."""

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretish.diagnostics.source import Source
from fretish.english.readings import MOST, demands, readings
from fretish.english.vocabulary import Vocabulary
from fretish.parser import parse
from fretish.printer import sentence
from fretish.syntax import Sentence
from tests.each import each
from tests.effort import examples

NEW = Vocabulary()
OFFERED = {
    # EARS
    "The kettle shall have a mass of less than 200 grams": [
        "the system shall always satisfy kettle_mass < 200 g"
    ],
    "While docked, the ATM shall display help": [
        "in docked mode, the ATM shall always satisfy display_help",
        "in docked mode, the ATM shall eventually satisfy display_help",
    ],
    "When mute is selected, the laptop shall suppress sound": [
        "when mute_selected the laptop shall immediately satisfy suppress_sound",
        "whenever mute_selected the laptop shall immediately satisfy suppress_sound",
        "when mute_selected the laptop shall eventually satisfy suppress_sound",
        "when mute_selected the laptop shall at the next timepoint satisfy suppress_sound",
        "when mute_selected the laptop shall always satisfy suppress_sound",
    ],
    "If the card is invalid, then the site shall reject it": [
        "when card_invalid the site shall immediately satisfy reject",
    ],
    "While on the ground, when thrust is commanded, the engine shall enable reverse": [
        "in on_ground mode, when thrust_commanded the engine shall immediately satisfy "
        "enable_reverse",
    ],
    # Demands and signs
    "The robot must never enter the zone": ["the robot shall never satisfy enter_zone"],
    "The robot cannot enter the zone": ["the robot shall never satisfy enter_zone"],
    "No robot shall enter the zone": ["the robot shall never satisfy enter_zone"],
    "The temperature must never exceed 80 degrees": [
        "the system shall never satisfy temperature > 80 deg"
    ],
    "If the door is not closed the motor shall not run": [
        "whenever !door_closed the motor shall immediately satisfy !run",
        "when !door_closed the motor shall never satisfy run",
    ],
    # Timing
    "if the battery is low, the drone must return within 5 seconds": [
        "when battery_low the drone shall within 5 seconds satisfy return",
        "whenever battery_low the drone shall within 5 seconds satisfy return",
    ],
    "If it rains, then within 1.5 minutes the roof should be closed": [
        "whenever rains the system shall within 90 seconds satisfy roof_closed"
    ],
    "The valve shall close at most 3 seconds after the pressure exceeds 5 bar": [
        "when pressure > 5 bar the valve shall within 3 seconds satisfy close"
    ],
    "The brake shall be applied for at least 3 seconds after the button is pressed": [
        "when button_pressed the system shall for 3 seconds satisfy brake_applied"
    ],
    "The pump shall not be on for more than 10 seconds": [
        "the system shall never satisfy persisted(10 s, pump_on)"
    ],
    "The node must publish a heartbeat every 10 ticks": [
        "whenever true the node shall within 10 ticks satisfy publish_heartbeat"
    ],
    "The vehicle shall stop immediately when the button is pressed": [
        "whenever button_pressed the vehicle shall immediately satisfy stop"
    ],
    "The system shall eventually reach the goal": [
        "the system shall eventually satisfy reach_goal"
    ],
    "The lamp shall be on for more than 10 seconds": [
        "the system shall for 10 seconds satisfy lamp_on"
    ],
    "The pump shall run for at most 10 seconds": [
        "the pump shall never satisfy persisted(10 s, run)"
    ],
    "It shall stop when the button is pressed for 5 seconds": [
        "when button_pressed the system shall for 5 seconds satisfy stop",
        "whenever persisted(5 s, button_pressed) the system shall immediately satisfy stop",
    ],
    # until, unless, before, after, only
    "The gripper must remain closed until the object is placed": [
        "the system shall until object_placed satisfy gripper_closed"
    ],
    "The robot may not move unless the operator has enabled it": [
        "whenever !operator_enabled the robot shall immediately satisfy !move",
        "the robot shall until operator_enabled satisfy !move",
    ],
    "The arm must stop before the gate opens": [
        "the arm shall before gate_opens satisfy stop",
    ],
    "The arm must not start before the gate opens": [
        "the arm shall until gate_opens satisfy !start",
    ],
    "After the mission starts, the robot must never leave": [
        "when mission_starts the robot shall never satisfy leave",
        "after mission_starts mode, the robot shall never satisfy leave",
    ],
    "The fan may only run if the temperature is above 50": [
        "whenever temperature <= 50 the fan shall immediately satisfy !run"
    ],
    "The valve is open if and only if the tank is full": [
        "the system shall always satisfy tank_full <-> valve_open"
    ],
    # Expressions
    "The speed must be between 1 m/s and 3 m/s at all times": [
        "the system shall always satisfy speed >= 1 m/s & speed <= 3 m/s"
    ],
    "When the tank is low or empty, the pump shall stop": [
        "when tank_low | tank_empty the pump shall immediately satisfy stop"
    ],
    "When the pump and the valve are open, it shall beep": [
        "when pump_open & valve_open the system shall immediately satisfy beep"
    ],
    "When a1 is on or a2 is on and a3 is on, it shall beep": [
        "when a1_on | a2_on & a3_on the system shall immediately satisfy beep",
        "when (a1_on | a2_on) & a3_on the system shall immediately satisfy beep",
    ],
    "If neither a1 nor b1 is open, it shall beep": [
        "when !a1_open & !b1_open the system shall immediately satisfy beep"
    ],
    "Neither a1 nor b1 shall be open": ["the system shall never satisfy a1_open | b1_open"],
    "The lamp must not be red and green": [
        "the system shall never satisfy lamp_red & lamp_green",
        "the system shall never satisfy lamp_red | lamp_green",
    ],
    "At least one of the pump and the valve must always be open": [
        "the system shall always satisfy pump_open | valve_open"
    ],
    "If the speed exceeds 5 or falls below 2, it shall beep": [
        "when speed > 5 | speed < 2 the system shall immediately satisfy beep"
    ],
    "The unit shall change states from IDLE to BUSY when the job is ready (ready)": [
        "whenever in_IDLE & ready the unit shall immediately satisfy in_BUSY"
    ],
    "A request must be followed by a grant within 3 ticks": [
        "whenever request the system shall within 3 ticks satisfy grant"
    ],
    "The light shall be red if the door is open at the time of departure": [
        "when door_open & departure the system shall immediately satisfy light_red",
        "when departure the system shall immediately satisfy door_open -> light_red",
    ],
}  # fmt: skip


@each("text", OFFERED)
def test_the_sentences_are_among_the_readings(text: str) -> None:
    offered = [reading.text for reading in readings(text, NEW)]
    assert {*OFFERED[text]} <= {*offered}
    assert offered[0] in OFFERED[text] or OFFERED[text][0] in offered


@each("text", OFFERED)
def test_all_words_of_a_text_without_asides_are_read(text: str) -> None:
    assert all(reading.left_out == () for reading in readings(text, NEW))


def test_a_sentence_of_fretish_is_its_own_reading() -> None:
    (reading,) = readings("whenever p the robot shall within 3 ticks satisfy q", NEW)
    assert reading.text == "whenever p the robot shall within 3 ticks satisfy q"


def test_the_names_of_a_project_are_recognized() -> None:
    names = Vocabulary(
        ("battery_low", "valve_0", "arm_stopped"),
        ("speedLimit",),
        {"mode": ("docking", "driving")},
        ("drone",),
    )

    def first(text: str) -> str:
        return readings(text, names)[0].text

    assert first("if the battery is low, it must beep") == (
        "when battery_low the drone shall immediately satisfy beep"
    )
    assert first("when pressed, the drone shall close valve 0").endswith("satisfy !valve_0")
    assert first("when pressed, the drone shall open valve 0").endswith("satisfy valve_0")
    assert first("the arm must always be moving").endswith("always satisfy !arm_stopped")
    assert first("the speed limit must never exceed 3").endswith("never satisfy speedLimit > 3")
    assert first("in docking mode the drone must never beep") == (
        'while "mode" = docking, the drone shall never satisfy beep'
    )


def test_a_name_of_the_project_that_lacks_words_says_so() -> None:
    reading, *_ = readings("the left arm must be stopped", Vocabulary(("stopped",)))
    assert reading.names == {"stopped": "the left arm be stopped"}
    assert reading.lacking == {"stopped": ("left", "arm")}


def test_words_that_demand_nothing_are_named() -> None:
    text = "the drone must brake within 2 s, whatever the pilot says (1 s @ 9 Hz)"
    for reading in readings(text, NEW):
        assert "pilot" in " ".join(reading.left_out)
    (reading,) = readings("the robot must immediately stop within 5 s", NEW)
    assert reading.left_out == ("immediately",)
    text = "the error shall never exceed a tolerance of 0.01"
    assert readings(text, NEW)[0].left_out == ("a tolerance of",)


def test_a_text_has_a_demand_for_each_sentence_and_each_verb_with_a_condition() -> None:
    text = "It shall start when a is on and stop when a is off. The lamp is red."
    assert demands(text) == (
        "It shall start when a is on",
        "It shall stop when a is off",
        "The lamp is red",
    )
    assert demands("The limit is 1.5 m") == ("The limit is 1.5 m",)


@pytest.mark.parametrize("text", ["", "the", "...", "(,)"])
def test_a_text_without_content_has_no_reading(text: str) -> None:
    assert readings(text, NEW) == ()


def test_no_reading_says_the_opposite_of_the_text() -> None:
    """Each of these words once had an effect that a reading lost."""
    for text in (
        "The pump shall not run every 5 seconds",
        "The pump shall not run after 5 seconds",
        "It may rain if and only if a1 is on when b1 is on",
    ):
        assert readings(text, NEW) == ()
    only = [r.text for r in readings("The robot may only start after the gate opens", NEW)]
    assert only == [
        "the robot shall until gate_opens satisfy !start",
        "only after gate_opens mode, the robot shall eventually satisfy start",
    ]


def test_a_long_text_is_not_read_and_many_clauses_are_tried_up_to_a_limit() -> None:
    assert readings("the robot must stop when " + "a is on and " * 2000 + "b is on", NEW) == ()
    many = "the robot must stop" + " when a is on" * 30
    assert len(readings(many, NEW)) <= MOST


# Any text ----------------------------------------------------------------------------------------

MADE_UP = ("blorp", "zind", "quarv", "Fleem", "GRONK", "tweb_9", "no-snarf", "plonked")
RULES = (
    "the a if when whenever while unless until before after only not never no always must shall "
    "will may cannot is are be remain and or but between within for more than least most 5 3.5 "
    "seconds ticks % m/s every once in mode state exceed exceeds below above equals to from change "
    "cause followed by , , ( ) then it as soon at all times immediately eventually next"
).split()
TEXTS = st.lists(st.sampled_from((*MADE_UP, *RULES)), min_size=1, max_size=18).map(" ".join)


def parts_of(text: str) -> set[str]:
    return {part.lower() for part in re.findall(r"[A-Za-z0-9]+", text)}


@pytest.mark.slow
@given(TEXTS)
@examples(150)
def test_each_made_up_word_is_in_each_reading_or_named(text: str) -> None:
    said = parts_of(" ".join(word for word in text.split() if word in MADE_UP))
    for reading in readings(text, NEW):
        named = " ".join([reading.text, *reading.left_out])
        assert said <= parts_of(named), (text, reading)


@pytest.mark.slow
@given(TEXTS | st.text(max_size=60))
@examples(40)
def test_each_reading_is_fretish_as_fmt_writes_it(text: str) -> None:
    for demand in demands(text):
        for reading in readings(demand, NEW):
            tree = parse(Source("reading", reading.text).span())
            assert isinstance(tree, Sentence)
            assert sentence(tree) == reading.text
            assert tree == reading.sentence
