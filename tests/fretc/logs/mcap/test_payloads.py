import struct

import numpy as np
import pytest

from fretc.logs.mcap.payloads import SPARE, Payloads

THREE = [b"abcdefgh" + struct.pack("<d", 1.5), b"", b"x" * 3 + struct.pack("<d", -0.25)]


def test_payloads_stand_one_behind_the_other_with_spare_bytes_behind_them() -> None:
    payloads = Payloads.of(THREE)
    assert (payloads.starts.tolist(), payloads.sizes.tolist()) == ([0, 16, 16], [16, 0, 11])
    assert [bytes(payloads.payload(i)) for i in range(3)] == payloads.copies() == THREE
    assert len(payloads.data) == 27 + SPARE


def test_copies_stay_when_the_memory_is_used_again() -> None:
    data = np.arange(40, dtype=np.uint8)
    payloads = Payloads(data, np.array([4, 0]), np.array([2, 3]))
    copies = payloads.copies()
    data[:] = 0
    assert copies == [b"\4\5", b"\0\1\2"]


def test_numbers_are_gathered_at_any_alignment() -> None:
    payloads = Payloads.of(THREE)
    rows = np.array([0])
    assert payloads.gathered(rows, 8, "<f8", None).tolist() == [1.5]
    assert payloads.gathered(np.array([2]), 3, "<f8", None).tolist() == [-0.25]
    assert payloads.gathered(rows, 0, "u1", 3).tolist() == [[97, 98, 99]]
    assert payloads.gathered(rows, 1, "<u2", 2).tolist() == [[0x6362, 0x6564]]


def test_an_array_of_no_numbers_has_a_place_at_the_very_end() -> None:
    payloads = Payloads.of([b"ab", b"cd"])
    assert payloads.gathered(np.array([0, 1]), 2, "<f8", 0).shape == (2, 0)


@pytest.mark.parametrize("byte", [0, 1, 2, 255])
def test_any_byte_but_zero_is_true(byte: int) -> None:
    payloads = Payloads.of([bytes([byte])])
    assert payloads.gathered(np.array([0]), 0, "?", None).tolist() == [byte != 0]
