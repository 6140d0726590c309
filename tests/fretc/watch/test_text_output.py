"""What a watch prints."""

from fretc.watch.events import LateMessages
from fretc.watch.text_output import line


def test_late_messages_are_counted_by_the_topics_that_have_some() -> None:
    said = line(LateMessages(3, {"/scan": 2, "/odom": 0, "/tf": 1}), None)
    assert said == ("late messages (2 of /scan, 1 of /tf): 3 judged ticks became unknown")
