"""What Unicorn's Python package leaves slow or out: registers in one call, peripherals without its detours, and how
many instructions have run.

Unicorn counts instructions to stop after so many, and does not say how many there were when something else stopped it.
The count is a word of its own memory, which is found by two runs of known length.
"""

import ctypes
from collections.abc import Callable

import unicorn
from unicorn import arm_const as arm
from unicorn.unicorn_py3.unicorn import uclib

# Words of Unicorn's own structure among which the count is.
_SEARCHED = 512
# Instructions of the runs by which it is found: numbers that are nothing else there.
_LENGTHS = (12_347, 54_323)


class Registers:
    """Some of the core's registers, read and written together."""

    def __init__(self, uc: unicorn.Uc, names: list[int]) -> None:
        count = len(names)
        self._handle, self._count = uc._uch, count
        self._names = (ctypes.c_int * count)(*names)
        self.values = (ctypes.c_uint64 * count)()
        size = ctypes.sizeof(ctypes.c_uint64)
        places = [ctypes.addressof(self.values) + size * place for place in range(count)]
        self._places = (ctypes.c_void_p * count)(*places)

    def read(self) -> "ctypes.Array[ctypes.c_uint64]":
        """Their values, in `values` too. A register of 32 bits may leave anything above them."""
        uclib.uc_reg_read_batch(self._handle, self._names, self._places, self._count)
        return self.values

    def write(self) -> None:
        """Takes them from `values`."""
        uclib.uc_reg_write_batch(self._handle, self._names, self._places, self._count)


def _found(model: int) -> int:
    """Where the count is, bytes from the structure's beginning; the limit follows it."""
    uc = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS)
    uc.ctl_set_cpu_model(model)
    uc.mem_map(0x1000, 0x1000)
    # b .
    uc.mem_write(0x1000, b"\xfe\xe7")
    size = ctypes.sizeof(ctypes.c_size_t)
    candidates = set(range(_SEARCHED))
    for length in _LENGTHS:
        uc.emu_start(0x1001, 0, count=length)
        words = (ctypes.c_size_t * _SEARCHED).from_address(uc._uch.value)
        candidates = {place for place in candidates if place + 1 < _SEARCHED and words[place] == length + 1
                      and words[place + 1] == length}
    assert len(candidates) == 1, f"Unicorn {unicorn.__version__} keeps its count of instructions elsewhere"
    return candidates.pop() * size


class Instructions:
    """The instructions of the run that is under way, and after how many it stops."""

    def __init__(self, uc: unicorn.Uc, model: int) -> None:
        place = uc._uch.value + _found(model)
        self._count = ctypes.c_size_t.from_address(place)
        self._limit = ctypes.c_size_t.from_address(place + ctypes.sizeof(ctypes.c_size_t))

    def run(self) -> int:
        """How many have run since it began."""
        return min(self._count.value, self._limit.value)

    def stop(self) -> None:
        """Has the run end with this instruction."""
        self._limit.value = self._count.value


_READ = ctypes.CFUNCTYPE(ctypes.c_uint64, ctypes.c_void_p, ctypes.c_uint64, ctypes.c_uint, ctypes.c_void_p)
_WRITE = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_uint64, ctypes.c_uint, ctypes.c_uint64, ctypes.c_void_p)


def map_callbacks(uc: unicorn.Uc, address: int, size: int, read: Callable[[int, int], int],
                  write: Callable[[int, int, int], None],
                  failed: Callable[[BaseException], None]) -> tuple[object, object]:
    """Sends accesses to these addresses to `read` (address, bytes) and `write` (address, bytes, value); what they raise
    to `failed`, as nothing can be raised through Unicorn. The result has to be kept for as long as `uc` runs."""
    def reading(_uc: int, offset: int, count: int, _user: int) -> int:
        try:
            return read(address + offset, count)
        except BaseException as error:  # whatever it is, it is raised where the run began
            failed(error)
            return 0

    def writing(_uc: int, offset: int, count: int, value: int, _user: int) -> None:
        try:
            write(address + offset, count, value)
        except BaseException as error:  # as above
            failed(error)

    kept = _READ(reading), _WRITE(writing)
    status = uclib.uc_mmio_map(uc._uch, address, size, ctypes.cast(kept[0], ctypes.c_void_p), None,
                               ctypes.cast(kept[1], ctypes.c_void_p), None)
    assert status == unicorn.UC_ERR_OK, f"{address:#x} cannot be mapped, {status}"
    return kept


PLAIN = [arm.UC_ARM_REG_R0, arm.UC_ARM_REG_R1, arm.UC_ARM_REG_R2, arm.UC_ARM_REG_R3, arm.UC_ARM_REG_R12,
         arm.UC_ARM_REG_LR]
FLOATS = [getattr(arm, f"UC_ARM_REG_D{number}") for number in range(8)]
