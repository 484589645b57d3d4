"""Starts of the chip other than after a reset: what a bootloader leaves (docs/boards.md), what a board lacks, and the
way into the chip's own bootloader.
"""

import math
import pathlib
import struct
from collections.abc import Callable
from dataclasses import dataclass

from boards import Board
from chip import POWER, SOFTWARE
from flight import Flight
from nvic import FIRST_INTERRUPT
from outcome import Expected, Outcome
from schedule import NS_PER_US
from station import mavlink
from timers import ARR, CCR1, CR1, DIER, PSC

_H743_BOARDS = ("micoair", "matek")
# Registers of the core, from 0xE000E000.
_SYSTICK, _SYSTICK_RELOAD, _CCR, _MPU_CTRL, _ITCMCR, _DTCMCR, _FPCCR = 0x010, 0x014, 0xD14, 0xD94, 0xF90, 0xF94, 0xF34
_TIM5_INTERRUPT = 50
_CACHES_ON = 0b11 << 16
# Interrupts of streams that a bootloader may have at work.
_ARMED = (11, 37, 38, 50)


def _arm_interrupts(board: Board, priority: int) -> None:
    """Interrupts on, some of them pending, all at a priority; SysTick runs. A bootloader masks them all before it
    hands over: its own handlers are gone."""
    system = board.core.system
    board.core.mask()
    system.enabled |= {FIRST_INTERRUPT + interrupt for interrupt in _ARMED}
    system.pending |= {FIRST_INTERRUPT + interrupt for interrupt in _ARMED}
    system.priorities = [priority] * len(system.priorities)
    system.values[_SYSTICK_RELOAD], system.values[_SYSTICK] = 9999, 0b111


def _time_base_ticks(board: Board) -> None:
    """TIM5 counts microseconds with its interrupts on, as a scheduler's."""
    timer = board.chip.time_base
    timer.values.update({PSC: timer.kernel_hz // 1_000_000 - 1, ARR: 0xFFFF_FFFF, DIER: 0b11, CCR1: 500})
    timer.write(CR1, 1)


def _clocks_run(board: Board) -> None:
    """The core by a PLL."""
    clocks = board.chip.clocks
    pll = sum(1 << on for on, _ in clocks.READY)
    clocks.values[0x00] = clocks.values.get(0x00, 0) | pll
    switch = 0x10 if board.chip.name == "STM32H743" else 0x08
    clocks.values[switch] = 3 if board.chip.name == "STM32H743" else 2


def _dma_writes(board: Board) -> None:
    """A stream goes on writing what arrives to where this image has its data, until its controller is reset."""
    controller = board.chip.dma[0]
    place = 0x2400_0100 if board.chip.name == "STM32H743" else 0x2000_0100
    # Stream 7: to memory, circular, on.
    controller.values.update({0x10 + 0x18 * 7: 1 | 1 << 8 | 1 << 10, 0x14 + 0x18 * 7: 64, 0x1C + 0x18 * 7: place})

    def write() -> None:
        if controller.streams[7].enabled and controller.streams[7].memory_address == place:
            board.core.uc.mem_write(place, b"\x5a" * 64)
            board.schedule.after(100 * NS_PER_US, write)
    write()


def _usb_works(board: Board) -> None:
    """The port is enumerated, its interrupt on."""
    board.chip.usb.values.update({0x08: 1, 0x18: 0x8000_3C00})
    board.core.system.enabled.add(FIRST_INTERRUPT + (101 if board.chip.name == "STM32H743" else 67))


def _nuttx(board: Board) -> None:
    values = board.core.system.values
    values[_DTCMCR], values[_FPCCR] = 0, 0
    _arm_interrupts(board, 0x80)
    _clocks_run(board)
    board.core.set_control(float_in_use=True)


def _chibios(board: Board) -> None:
    values = board.core.system.values
    values[_CCR] |= _CACHES_ON
    values[_MPU_CTRL] = 0b101
    _arm_interrupts(board, 0x20)
    _time_base_ticks(board)
    _clocks_run(board)
    _dma_writes(board)
    board.core.set_control(process_stack=True)


def _system_bootloader(board: Board) -> None:
    _usb_works(board)
    _clocks_run(board)
    _arm_interrupts(board, 0x40)
    _dma_writes(board)


def _watchdog_runs(board: Board) -> None:
    """A watchdog that a bootloader has started, with half a minute of patience: nothing stops it."""
    board.chip.watchdog.values.update({0x04: 6, 0x08: 0xFFF})
    board.chip.watchdog.start()


def _no_crystal(board: Board) -> None:
    board.chip.clocks.crystal_runs = False


def _brown_out_set(board: Board) -> None:
    """The option that holds the chip in reset while its supply is too low: level 2."""
    flash = board.chip.flash
    offset, bits = (0x1C, 2 << 2) if board.chip.name == "STM32H743" else (0x14, 1 << 2)
    flash.values[offset] = flash.values[offset] & ~0xC | bits


def _no_usb_supply(board: Board) -> None:
    board.chip.power.has_usb_supply = False


def _check_core(board: Board) -> None:
    """What the firmware promises to have restored (docs/boards.md)."""
    values, system = board.core.system.values, board.core.system
    if board.chip.name == "STM32H743":
        assert values[_ITCMCR] & 1 and values[_DTCMCR] & 1, "tightly coupled memories are off"
        assert values[_CCR] & _CACHES_ON == 1 << 17, f"caches: {values[_CCR]:#x}"
    assert values[_FPCCR] >> 30 == 3, f"FPCCR is {values[_FPCCR]:#x}"
    assert not values.get(_SYSTICK, 0) & 1, "SysTick runs"
    strangers = [exception - FIRST_INTERRUPT for exception in system.enabled if system.priorities[exception] == 0x20
                 and exception - FIRST_INTERRUPT in _ARMED]
    assert not strangers, f"interrupts {strangers} have a bootloader's priority"


@dataclass(frozen=True)
class Boot:
    """A start and what must follow."""

    spoil: Callable[[Board], None]
    expected: Expected
    arms: bool = True
    boards: tuple[str, ...] | None = None

    def run(self, name: str, image: str, vehicle: pathlib.Path) -> Outcome:
        """Starts so, and arms on the ground."""
        flight = Flight(name, image, vehicle)
        flight.is_quiet = flight.station.is_quiet = True
        board, station = flight.board, flight.station
        board.on_start = lambda: self.spoil(board)
        flight.boot(POWER)
        _check_core(board)
        flight.make_ready()
        answer = station.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1.0)
        assert (answer == mavlink.MAV_RESULT_ACCEPTED) == self.arms, f"arming was answered by {answer}"
        station.wait(0.3)
        complaints = board.complaints()
        assert not complaints, complaints
        return Outcome(motors_off_ms=0.0 if board.escs.are_still() else None,
                       words=[text for _, text in station.texts], restarts=list(board.restarts))


@dataclass(frozen=True)
class IntoBootloader:
    """Command 246 with parameter 1 = 3."""

    expected: Expected
    boards: tuple[str, ...] | None = None

    def run(self, name: str, image: str, vehicle: pathlib.Path) -> Outcome:
        """Asks for it, and looks where the core is then."""
        flight = Flight(name, image, vehicle)
        flight.is_quiet = flight.station.is_quiet = True
        board, station = flight.board, flight.station
        flight.boot(POWER)
        chip, uc = board.chip, board.core.uc
        # In place of ST's bootloader: its vectors, and a loop.
        loop, stack = chip.BOOTLOADER + 0x400, chip.VOLATILE[0][0] + 0x2000
        uc.mem_write(chip.BOOTLOADER, struct.pack("<II", stack, loop | 1))
        uc.mem_write(loop, b"\xfe\xe7")
        station.order(mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 3.0)
        begun = board.schedule.now
        while not chip.BOOTLOADER <= board.core.pc < chip.BOOTLOADER + 0x1000:
            board.run(1_000_000)
            assert board.schedule.now - begun < 2_000_000_000, f"at {board.core.pc:#x}"
        assert not chip.watchdog.is_running, "the watchdog runs in the bootloader"
        took = (board.schedule.now - begun) / 1e6
        assert math.isfinite(took)
        return Outcome(motors_off_ms=0.0, words=[f"in the chip's bootloader {took:.0f} ms after the answer"],
                       restarts=list(board.restarts))


_FLIES = Expected(unsaid=("Restarted", "crystal"))

BOOTS: dict[str, Boot | IntoBootloader] = {
    "after-nuttx": Boot(_nuttx, _FLIES, boards=_H743_BOARDS),
    "after-chibios": Boot(_chibios, _FLIES, boards=_H743_BOARDS),
    "after-st-bootloader": Boot(_system_bootloader, _FLIES),
    "bootloaders-watchdog-runs": Boot(_watchdog_runs, _FLIES),
    "no-crystal": Boot(_no_crystal, Expected(0.0, ("The clock's crystal does not run: no arming",)), arms=False),
    "no-brown-out-option": Boot(lambda board: None, Expected(words=("Brown-out reset is off (BOR_LEV)",))),
    "brown-out-option": Boot(_brown_out_set, Expected(unsaid=("BOR_LEV",))),
    "no-usb-supply": Boot(
        _no_usb_supply, Expected(words=("USB has no supply: the port stays off",)), boards=_H743_BOARDS),
    "into-bootloader": IntoBootloader(Expected(0.0, restarts=(SOFTWARE,))),
}
