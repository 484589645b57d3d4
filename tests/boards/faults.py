"""What fails in a hover."""

import math
from collections.abc import Callable
from dataclasses import dataclass

from chip import BROWN_OUT, SOFTWARE, WATCHDOG
from dma import Stream
from flight import Flight, HEIGHT
from outcome import Expected, Outcome
from schedule import NS_PER_MS, NS_PER_S
from vehicle import START

# How long a run goes on after its fault, s: where the flight must go on, the same with a fault that takes long to
# emulate, and where words come after a restart.
_FLIES_ON_S, _STORM_S, _RESTART_S = 1.0, 0.3, 9.0
# Interrupts that control's task runs in: SAI1 on the H743, UART4 on the F405.
_CONTROL = {"STM32H743": ("SAI1", 87), "STM32F405": ("UART4", 52)}
_UNEXPECTED_INTERRUPT = 5
_H743_BOARDS = ("micoair", "matek")


def _driven_until(flight: Flight, since_ns: int) -> int | None:
    """The last moment from `since_ns` on at which a motor was driven, or none where they still are."""
    escs = flight.board.escs
    if not escs.are_still():
        return None
    return max(flight.vehicle.last_driven_ns, since_ns)


@dataclass(frozen=True)
class Fault:
    """A fault and what must follow."""

    strike: Callable[[Flight], None]
    expected: Expected
    seconds: float = _FLIES_ON_S
    boards: tuple[str, ...] | None = None

    def run(self, flight: Flight) -> Outcome:
        """Strikes, and looks at what follows."""
        board, station = flight.board, flight.station
        begun = board.schedule.now
        station.texts.clear()
        self.strike(flight)
        place = (START[0], START[1], HEIGHT)
        strayed, end = 0.0, begun + round(self.seconds * NS_PER_S)
        while board.schedule.now < end:
            board.run(5 * NS_PER_MS)
            station.look()
            strayed = max(strayed, math.dist(flight.vehicle.position, place))
            if board.restarts and station.said("Restarted") and board.escs.are_still():
                break
        off = _driven_until(flight, begun)
        return Outcome(motors_off_ms=None if off is None else (off - begun) / NS_PER_MS,
                       words=[text for _, text in station.texts], restarts=list(board.restarts), strayed_m=strayed)


def _mask_everything(flight: Flight) -> None:
    """The core runs a loop with its interrupts masked."""
    flight.board.core.hang()


def _control_hangs(flight: Flight) -> None:
    """Control's task never comes back: its interrupt's handler is a loop."""
    name, _ = _CONTROL[flight.board.chip.name]
    flight.board.core.hang_in(name)


def _control_sleeps(flight: Flight) -> None:
    """Control's task is never woken: its interrupt is off."""
    _, interrupt = _CONTROL[flight.board.chip.name]
    flight.board.core.system.enabled.discard(16 + interrupt)


def _hard_fault(flight: Flight) -> None:
    flight.board.core.fail()


def _unexpected_interrupt(flight: Flight) -> None:
    system = flight.board.core.system
    system.enabled.add(16 + _UNEXPECTED_INTERRUPT)
    system.raise_interrupt(_UNEXPECTED_INTERRUPT)


def _brown_out(flight: Flight) -> None:
    flight.board.chip.request_restart(BROWN_OUT)


def _first_bus(flight: Flight) -> object:
    return flight.board.chip.spis[flight.board.wires.sensors[0].bus]


def _stuck(flight: Flight) -> None:
    """Exchanges with the first sensor begin and never end."""
    _first_bus(flight).is_stuck = True


def _answers(byte: int) -> Callable[[Flight], None]:
    """The first sensor's bus reads as nothing but that byte."""
    def strike(flight: Flight) -> None:
        _first_bus(flight).spoil = lambda answer: bytes([byte]) * len(answer)
    return strike


def _silent(flight: Flight) -> None:
    """No data-ready edges any more."""
    flight.board.sensors[0].is_silent = True


def _storm(period_ns: int) -> Callable[[Flight], None]:
    """Edges on the data-ready pin, one every `period_ns`."""
    def strike(flight: Flight) -> None:
        board = flight.board
        pin = board.wires.sensors[0].data_ready

        def edge() -> None:
            board.chip.edges.rise(pin)
            board.schedule.after(period_ns, edge)
        edge()
    return strike


def _stream_of(flight: Flight, request: str) -> Stream:
    """The stream that serves a request, whether it waits now or not."""
    for controller in flight.board.chip.dma:
        if request in controller.served_by:
            return controller.served_by[request]
    raise AssertionError(f"no stream for {request}")


def _requests(flight: Flight) -> dict[str, str]:
    wires = flight.board.wires
    return {"sensor": wires.sensors[0].bus, "link": wires.link, "motors": wires.motors[0].timer}


def _transfer_errors(what: str, kind: str, times_ms: int) -> Callable[[Flight], None]:
    """For so long every transfer of a stream ends by a bus error."""
    def strike(flight: Flight) -> None:
        stream = _stream_of(flight, f"{_requests(flight)[what]}_{kind}")
        stream.fails = True
        flight.board.schedule.after(times_ms * NS_PER_MS, setattr, stream, "fails", False)
    return strike


def _card_pulled(flight: Flight) -> None:
    """The card that logs the flight is pulled out."""
    flight.board.chip.slot.card = None


_TAKES_OVER = ("IMU: the second takes over",)
_NO_IMU = Expected(off_within_ms=30.0, words=("Stopped: no IMU",))
_BRIEF_MS = 5

FAULTS: dict[str, Fault] = {
    "nothing": Fault(lambda flight: None, Expected(unsaid=("Restarted", "lost", "IMU"))),
    "control-hangs": Fault(_control_hangs, Expected(
        260.0, ("Restarted: watchdog, control did not come back",), restarts=(WATCHDOG,)), _RESTART_S),
    "control-never-woken": Fault(_control_sleeps, Expected(
        260.0, ("Restarted: watchdog, control did not come back",), restarts=(WATCHDOG,)), _RESTART_S),
    "interrupts-masked": Fault(_mask_everything, Expected(
        260.0, ("Restarted: watchdog, control did not come back",), restarts=(WATCHDOG,)), _RESTART_S),
    "hard-fault": Fault(_hard_fault, Expected(2.0, ("Restarted: fault at",), restarts=(SOFTWARE,)), _RESTART_S),
    "unexpected-interrupt": Fault(_unexpected_interrupt, Expected(
        2.0, (f"Restarted: unexpected interrupt {_UNEXPECTED_INTERRUPT}",), restarts=(SOFTWARE,)), _RESTART_S),
    "brown-out": Fault(_brown_out, Expected(
        260.0, ("Restarted: brown-out, supply too low",), restarts=(BROWN_OUT,)), _RESTART_S),
    "spi-stuck": Fault(_stuck, Expected(words=_TAKES_OVER), boards=_H743_BOARDS),
    "imu-reads-ones": Fault(_answers(0xFF), Expected(words=_TAKES_OVER), boards=_H743_BOARDS),
    "imu-reads-zeros": Fault(_answers(0x00), Expected(words=_TAKES_OVER), boards=_H743_BOARDS),
    "only-spi-stuck": Fault(_stuck, _NO_IMU, boards=("bolt",)),
    "only-imu-reads-ones": Fault(_answers(0xFF), _NO_IMU, boards=("bolt",)),
    "only-imu-reads-zeros": Fault(_answers(0x00), _NO_IMU, boards=("bolt",)),
    "no-data-ready-edges": Fault(_silent, Expected(words=("IMU: no data-ready edges, polled",))),
    "edges-every-100-us": Fault(_storm(100_000), Expected(unsaid=("Restarted",)), _STORM_S),
    "edges-every-20-us": Fault(_storm(20_000), Expected(unsaid=("Restarted",)), _STORM_S),
    "card-pulled": Fault(_card_pulled, Expected(unsaid=("Restarted",)), boards=("micoair",)),
    "dma-error-sensor-rx": Fault(_transfer_errors("sensor", "RX", _BRIEF_MS), Expected()),
    "dma-error-sensor-tx": Fault(_transfer_errors("sensor", "TX", _BRIEF_MS), Expected()),
    "dma-error-link-rx": Fault(_transfer_errors("link", "RX", 100), Expected(unsaid=("Pose lost",))),
    "dma-error-link-tx": Fault(_transfer_errors("link", "TX", 100), Expected()),
    "dma-error-motors": Fault(_transfer_errors("motors", "UP", _BRIEF_MS), Expected()),
    "dma-error-motors-for-good": Fault(_transfer_errors("motors", "UP", 60_000), Expected(
        260.0, ("motors: a frame did not go out", "Restarted: watchdog"), restarts=(WATCHDOG,)), _RESTART_S),
}
