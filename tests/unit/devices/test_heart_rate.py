from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from studykit.devices.heart_rate import encode, parse


def test_every_known_message_is_read_as_its_source_states(shared_data: Callable[[str], Path]) -> None:
    vectors = json.loads(shared_data("heart_rate/hr_measurement_vectors.json").read_text())["vectors"]
    assert len(vectors) == 63
    for vector in vectors:
        expected = vector["expected"]
        sample = parse(bytes.fromhex(vector["hex"]), 3.5)
        assert sample.time_s == 3.5
        assert sample.heart_rate_bpm == (expected["hr_bpm"] or None), vector
        assert sample.rr_intervals_s == tuple(units / 1024 for units in expected["rr_1024"]), vector
        assert [1000 * rr for rr in sample.rr_intervals_s] == pytest.approx(expected["rr_ms"], abs=1e-4)
        assert sample.contact is (expected["contact_detected"] if expected["contact_supported"] else None)
        assert sample.energy_expended_kj == expected["energy_expended_kj"], vector


def test_every_message_that_is_cut_off_is_refused(shared_data: Callable[[str], Path]) -> None:
    malformed = json.loads(shared_data("heart_rate/hr_measurement_vectors.json").read_text())["malformed"]
    assert len(malformed) == 5
    for vector in malformed:
        with pytest.raises(ValueError, match="is cut off"):
            parse(bytes.fromhex(vector["hex"]), 0.0)


@given(
    bpm=st.integers(0, 65535),
    rr=st.lists(st.integers(0, 65535), max_size=9),
    contact=st.sampled_from([None, True, False]),
    energy=st.none() | st.integers(0, 65535),
)
def test_what_is_written_is_read_again(
    *,
    bpm: int,
    rr: list[int],
    contact: bool | None,
    energy: int | None,
) -> None:
    intervals = tuple(units / 1024 for units in rr)
    packet = encode(bpm, rr_intervals_s=intervals, contact=contact, energy_expended_kj=energy)
    sample = parse(packet, 0.0)
    assert sample.heart_rate_bpm == (bpm or None)
    assert (sample.rr_intervals_s, sample.contact, sample.energy_expended_kj) == (intervals, contact, energy)


def test_bytes_of_the_specification_by_hand() -> None:
    assert encode(60, rr_intervals_s=(1041 / 1024,), contact=True) == bytes.fromhex("163c1104")
    assert encode(300) == bytes.fromhex("012c01")


def test_a_number_too_large_is_refused() -> None:
    with pytest.raises(ValueError, match="does not fit"):
        encode(70_000)
