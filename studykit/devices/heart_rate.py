"""Heart-rate belts: what a Bluetooth notification says, without any radio."""

from __future__ import annotations

import struct
from dataclasses import dataclass

RR_UNIT_S = 1.0 / 1024.0
"""The unit in which belts send the time between beats, s."""

_WIDE, _CONTACT, _CONTACT_KNOWN, _ENERGY, _RR = 1, 2, 4, 8, 16


@dataclass(frozen=True, kw_only=True, slots=True)
class HeartRateSample:
    """One message of a heart-rate belt.

    Parameters
    ----------
    time_s : float
        When it arrived, s from the start of the recording.
    heart_rate_bpm : int or None
        Beats a minute; None while the belt has no reading.
    rr_intervals_s : tuple of float
        Times between the beats since the last message, oldest first, exact multiples of 1/1024 s.
    contact : bool or None
        Whether the belt touches the skin; None if it cannot tell.
    energy_expended_kj : int or None
        Energy since the belt was reset, if it counts it.
    """

    time_s: float
    heart_rate_bpm: int | None
    rr_intervals_s: tuple[float, ...] = ()
    contact: bool | None = None
    energy_expended_kj: int | None = None


def parse(packet: bytes, time_s: float) -> HeartRateSample:
    """Read one message of a heart-rate belt.

    Parameters
    ----------
    packet : bytes
        The value of the characteristic 0x2A37 (Heart Rate Measurement).
    time_s : float
        When it arrived, s.

    Raises
    ------
    ValueError
        If the message is shorter than its first byte says.

    Notes
    -----
    Flags, heart rate (one byte or two), energy (kJ), RR intervals (1/1024 s); little endian. A heart rate of
    0 is what a belt sends before it has found a beat: no reading.

    Examples
    --------
    >>> parse(bytes.fromhex("105000030003"), 0.0)
    HeartRateSample(time_s=0.0, heart_rate_bpm=80, rr_intervals_s=(0.75, 0.75), contact=None,
    energy_expended_kj=None)
    """
    try:
        flags = packet[0]
        bpm, at = (struct.unpack_from("<H", packet, 1)[0], 3) if flags & _WIDE else (packet[1], 2)
        energy = None
        if flags & _ENERGY:
            energy, at = struct.unpack_from("<H", packet, at)[0], at + 2
    except (IndexError, struct.error) as error:
        raise ValueError(f"the heart-rate message {packet.hex() or '(empty)'} is cut off") from error
    count = (len(packet) - at) // 2 if flags & _RR else 0
    return HeartRateSample(
        time_s=time_s,
        heart_rate_bpm=bpm or None,
        rr_intervals_s=tuple(units * RR_UNIT_S for units in struct.unpack_from(f"<{count}H", packet, at)),
        contact=bool(flags & _CONTACT) if flags & _CONTACT_KNOWN else None,
        energy_expended_kj=energy,
    )


def encode(
    heart_rate_bpm: int,
    *,
    rr_intervals_s: tuple[float, ...] = (),
    contact: bool | None = None,
    energy_expended_kj: int | None = None,
) -> bytes:
    """Write a message as a heart-rate belt sends it, the inverse of `parse`.

    Raises
    ------
    ValueError
        If a number does not fit into two bytes.
    """
    flags = _WIDE if heart_rate_bpm > 255 else 0
    if contact is not None:
        flags |= _CONTACT_KNOWN | (_CONTACT if contact else 0)
    units = [round(interval / RR_UNIT_S) for interval in rr_intervals_s]
    energy = [] if energy_expended_kj is None else [energy_expended_kj]
    flags |= (_ENERGY if energy else 0) | (_RR if units else 0)
    tail = energy + units
    try:
        return struct.pack(f"<B{'H' if flags & _WIDE else 'B'}{len(tail)}H", flags, heart_rate_bpm, *tail)
    except struct.error as error:
        raise ValueError("a heart rate, an energy or an interval does not fit into the message") from error
