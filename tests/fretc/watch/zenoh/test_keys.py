"""The forms of rmw_zenoh: what its design page shows is read, and nothing else."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.watch.source_choice import chosen
from fretc.watch.zenoh.keys import (
    Attachment,
    Kind,
    Token,
    attachment,
    has_key,
    is_locator,
    keys_of_messages,
    keys_of_tokens,
    kind_of_message,
    token,
)
from fretc.watch.zenoh.zenoh import Zenoh
from fretish.diagnostics.diagnostic import Code, Diagnostic

HASH = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
GID = bytes(range(16))
NOW = 1_700_000_000_000_000_000
PUBLISHER = (
    f"@ros2_lv/2/aac3178e146ba6f1fc6e6a4085e77f21/0/10/MP/%/%/talker/%chatter/"
    f"std_msgs::msg::dds_::String_/{HASH}/::,10:,:,:,,"
)
"""As the design page shows it, for domain 2."""


def little(number: int) -> bytes:
    return number.to_bytes(8, "little", signed=True)


PLAIN = little(5) + little(NOW) + b"\x10" + GID
NAMED = b"".join([
    b"\x0fsequence_number", little(5), b"\x10source_timestamp", little(NOW),
    b"\x0asource_gid\x10", GID,
])  # fmt: skip


def test_keys_have_the_form_of_the_design_page() -> None:
    assert keys_of_messages(2, "/chatter") == "2/chatter/*/*"
    assert keys_of_messages(0, "chatter") == "0/chatter/*/*"
    assert keys_of_messages(0, "/robot1/scan") == "0/robot1/scan/*/*"
    assert keys_of_tokens(2, "/robot1/scan") == "@ros2_lv/2/*/*/*/MP/*/*/*/%robot1%scan/*/*/*"
    assert keys_of_tokens(2, "scan") == keys_of_tokens(2, "/scan")


def test_the_key_of_a_message_states_its_type() -> None:
    key = f"0/chatter/std_msgs::msg::dds_::String_/{HASH}"
    assert kind_of_message(key) == Kind("std_msgs/msg/String", HASH)
    key = "0/robot1/scan/sensor_msgs::msg::dds_::LaserScan_/TypeHashNotSupported"
    assert kind_of_message(key) == Kind("sensor_msgs/msg/LaserScan", None)
    assert kind_of_message("0/x/a.proto/7") == Kind("a.proto", "7")


@pytest.mark.parametrize(
    "key", ["", "0", "0/x/y", "**", "0/**", "0/x/*/*", "0/x/$*/y", "0/x//y", "0/x/T?/h", "0/x/y/h#"]
)
def test_what_is_no_key_of_a_message_states_nothing(key: str) -> None:
    assert kind_of_message(key) is None


def test_a_token_states_the_node_and_the_key() -> None:
    key = f"2/chatter/std_msgs::msg::dds_::String_/{HASH}"
    assert token(PUBLISHER) == Token("/talker", key)
    inner = PUBLISHER.replace("/%/%/talker/%chatter/", "/%/%arm%left/talker/%arm%left%chatter/")
    assert token(inner) == Token("/arm/left/talker", key.replace("2/chatter", "2/arm/left/chatter"))


@pytest.mark.parametrize(
    "text",
    [
        "",
        "@ros2_lv/2/aac3178e/0/0/NN/%/%/talker",
        PUBLISHER.replace("/MP/", "/MS/"),
        PUBLISHER.replace("/10/", "/"),
        PUBLISHER + "/more",
        PUBLISHER.replace("talker", ""),
        PUBLISHER.replace("%chatter", "*"),
        PUBLISHER.replace("talker", "x" * 256),
    ],
)
def test_other_tokens_are_none_of_a_publisher(text: str) -> None:
    assert token(text) is None


@given(st.text(alphabet="/%@*$#?:,aMP0", max_size=60))
def test_tokens_and_keys_of_strangers_are_read_or_not(text: str) -> None:
    parts = text.split("/")
    if any(each in text for each in "*$#?") or "" in parts or len(parts) < 4:
        assert kind_of_message(text) is None
    assert token(text) is None or len(parts) == 13


@pytest.mark.parametrize("data", [PLAIN, NAMED])
def test_an_attachment_has_three_fields(data: bytes) -> None:
    """Jazzy's first releases wrote their names, too."""
    assert attachment(data) == Attachment(5, NOW, GID)


@pytest.mark.parametrize("data", [PLAIN, NAMED])
def test_an_attachment_of_another_length_says_nothing(data: bytes) -> None:
    for length in range(len(data)):
        assert attachment(data[:length]) is None
    assert attachment(data + b"\0") is None


def test_impossible_numbers_say_nothing() -> None:
    assert attachment(little(-1) + PLAIN[8:]) is None
    assert attachment(PLAIN.replace(b"\x10" + GID, b"\x0f" + GID)) is None
    for unset in (0, -5):
        assert attachment(little(5) + little(unset) + PLAIN[16:]) == Attachment(5, None, GID)


@given(st.binary(max_size=90))
def test_an_attachment_of_a_stranger_is_read_or_not(data: bytes) -> None:
    found = attachment(data)
    assert found is None or len(data) in (33, 77)


@given(st.binary(min_size=33, max_size=33).map(lambda data: data[:16] + b"\x10" + data[17:]))
def test_a_number_is_that_of_the_bytes(data: bytes) -> None:
    found = attachment(data)
    number = int.from_bytes(data[:8], "little", signed=True)
    assert (found.number if found else None) == (number if number >= 0 else None)


@given(st.text(alphabet="/ab_0*$#?@%. ", max_size=12))
def test_only_a_name_of_ros_has_a_key(topic: str) -> None:
    parts = topic.removeprefix("/").split("/")
    assert has_key(topic) == all(re.fullmatch("[ab_0]+", part) for part in parts)


def test_a_locator_has_protocol_host_and_port() -> None:
    for text in ("tcp/localhost:7447", "tcp/10.0.0.2:1", "tls/robot.local:7447", "tcp/[::1]:7447"):
        assert is_locator(text)
        source = chosen(["zenoh", text], follow=False)
        assert isinstance(source, Zenoh)
        assert source.name == text
    for text in (
        "",
        "robot",
        "robot:7447",
        "tcp/robot",
        "ws://robot:1",
        "tcp/a:1#x=y",
        "tcp/a:1\n",
    ):
        assert not is_locator(text)
        problem = chosen(["zenoh", text], follow=False)
        assert isinstance(problem, Diagnostic)
        assert problem.code is Code.BAD_USAGE


def test_the_locator_may_be_left_out() -> None:
    source = chosen(["zenoh"], follow=False)
    assert isinstance(source, Zenoh)
    assert source.name == "tcp/localhost:7447"
    assert isinstance(chosen(["zenoh", "tcp/a:1", "tcp/b:1"], follow=False), Diagnostic)
    assert isinstance(chosen(["zenoh"], follow=True), Diagnostic)
