"""What a speed controller answers on its own line (bidirectional DShot, as AM32 and Betaflight have it).

    speed -> electrical period, us -> eeem mmmm mmmm -> and an inverted checksum, 16 bits
          -> each 4 bits as 5 (GCR) -> 21 levels of the line: low, then each one changes it

The line rests high. An answer begins `DELAY_NS` after the frame, at 5/4 of its rate.
"""

import math

DELAY_NS = 30_000
LEVEL_NS = 1e9 / 375_000
LEVELS = 21
DURATION_NS = LEVELS * LEVEL_NS
POLES = 14
AT_REST = 0xFFF
_PERIOD_MAX_US = 511 << 7
_GCR = (0x19, 0x1B, 0x12, 0x13, 0x1D, 0x15, 0x16, 0x17, 0x1A, 0x09, 0x0A, 0x0B, 0x1E, 0x0D, 0x0E, 0x0F)


def of_speed(rad_s: float) -> int:
    """The 12 bits for a rotor that turns so fast."""
    if rad_s <= 0.0:
        return AT_REST
    period = int(1e6 * 2.0 * math.pi / (rad_s * POLES / 2))
    if period >= _PERIOD_MAX_US:
        return AT_REST
    shift = max(0, period.bit_length() - 9)
    return shift << 9 | max(1, period) >> shift


def levels(value: int) -> list[int]:
    """The line's levels for 12 bits, the first to leave first."""
    word = value << 4 | ~(value ^ value >> 4 ^ value >> 8) & 0xF
    line = [0]
    for shift in (12, 8, 4, 0):
        quintet = _GCR[word >> shift & 0xF]
        for bit in (4, 3, 2, 1, 0):
            line.append(line[-1] ^ quintet >> bit & 1)
    return line
