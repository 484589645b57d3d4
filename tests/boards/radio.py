"""The Bolt's radio chip, an nRF51822 with Bitcraze's firmware, at its end of the serial line ("syslink").

It says nothing before it has understood a frame, confirms what it is told, and reports the battery a hundred times a
second once it is asked to. Nobody sends it packets over the radio. Its pin never stops the line.
"""

import struct
from collections import Counter

from schedule import NS_PER_MS, Schedule
from uart import Uart

_START = b"\xbc\xcf"
_CHANNEL, _RATE, _CARRIER, _STRENGTH, _ADDRESS, _READY, _BATTERY, _REPORTS = 1, 2, 3, 4, 5, 0x0B, 0x13, 0x14
_CONFIRMED = (_CHANNEL, _RATE, _CARRIER, _ADDRESS, _READY)
VOLTAGE = 16.0
# What it must have been told, with the parameters as they are by default.
_TOLD = {_CARRIER: b"\0", _CHANNEL: b"\x50", _RATE: b"\x02", _ADDRESS: b"\xe7" * 5, _READY: b"", _REPORTS: b""}


def frame(kind: int, data: bytes) -> bytes:
    """A frame."""
    body = bytes((kind, len(data))) + data
    first = second = 0
    for byte in body:
        first = (first + byte) & 0xFF
        second = (second + first) & 0xFF
    return _START + body + bytes((first, second))


class RadioChip:
    """The chip, which has power from the first moment on and does not start again with the other one."""

    def __init__(self, line: Uart, schedule: Schedule) -> None:
        self._line, self._schedule = line, schedule
        self.told: dict[int, bytes] = {}
        self.wrong: Counter[str] = Counter()
        schedule.after(10 * NS_PER_MS, self._turn)

    def _turn(self) -> None:
        self._schedule.after(10 * NS_PER_MS, self._turn)
        answer = b""
        heard = self._line.sent
        while len(heard) >= 6 and len(heard) >= heard[3] + 6:
            kind, length = heard[2], heard[3]
            data = bytes(heard[4:4 + length])
            if bytes(heard[:length + 6]) != frame(kind, data):
                self.wrong[f"no frame: {bytes(heard[:length + 6]).hex(' ')}"] += 1
                heard.clear()
                break
            del heard[:length + 6]
            if kind not in _TOLD:
                self.wrong[f"kind {kind:#x}, and no packet came"] += 1
            self.told[kind] = data
            if kind in _CONFIRMED:
                answer += frame(kind, data)
        if _REPORTS in self.told:
            answer += frame(_BATTERY, struct.pack("<Bff", 0, VOLTAGE, 0.0)) + frame(_STRENGTH, b"\x28")
        if answer:
            self._line.receive(answer)

    def complaints(self) -> list[str]:
        """What is wrong once the board has flown."""
        wrong = [f"radio chip: {what}, {count} times" for what, count in self.wrong.items()]
        if self.told != _TOLD:
            wrong.append(f"radio chip: was told {self.told}")
        if abs(self._line.baud / 1_000_000 - 1) > 0.02:
            wrong.append(f"radio chip: {self._line.baud:.0f} baud")
        return wrong
