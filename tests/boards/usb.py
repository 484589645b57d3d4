"""A USB port that nobody has plugged a cable into: RM0433 chapter 57, RM0090 chapter 34."""

from peripheral import Peripheral

_RESET, _IDENTITY = 0x10, 0x3C


class UnpluggedPort(Peripheral):
    """Registers keep what is written; resets of the core and of its buffers are over at once."""

    KNOWN = frozenset(range(0, 0x1000, 4))

    def __init__(self, base: int, identity: int) -> None:
        """`identity`: the controller's version, by which the driver knows it."""
        self.RESET = {_IDENTITY: identity}
        super().__init__("OTG_FS", base, size=0x1000)

    def read(self, offset: int) -> int:
        if offset == _RESET:
            return 1 << 31
        # GINTSTS: the host's mode and every event are absent.
        return 0 if offset == 0x14 else self.values.get(offset, 0)
