"""What fails while the firmware listens to the motors' controllers: their lines rest high, and the pins are inputs."""

import pathlib
from dataclasses import dataclass

from chip import POWER, SOFTWARE
from flight import Flight
from outcome import Expected, Outcome
from schedule import NS_PER_MS, NS_PER_US

_STOP_FRAMES_MIN = 100
_RESTART_S = 9.0


@dataclass(frozen=True)
class WhileListening:
    """A hard fault in the middle of an answer, motors idling."""

    expected: Expected
    boards: tuple[str, ...] | None = None

    def run(self, name: str, image: str, vehicle: pathlib.Path) -> Outcome:
        """Arms, waits for an answer, strikes: stop frames must be whole, inverted, and from pins that are driven."""
        flight = Flight(name, image, vehicle)
        flight.is_quiet = flight.station.is_quiet = True
        board, station, escs = flight.board, flight.station, flight.board.escs
        flight.boot(POWER)
        flight.speak_both_ways()
        flight.make_ready()
        flight.arm()
        station.wait(0.5)
        assert not escs.are_still(), "motors do not idle"
        ports = {port.name: (port, pin) for port, pin in escs.pins}
        while not all(port.is_input(pin) for port, pin in ports.values()):
            board.run(5 * NS_PER_US)
        board.run(40 * NS_PER_US)
        assert all(port.is_input(pin) for port, pin in ports.values()), "listening was over"
        begun, frames, inverted = board.schedule.now, escs.frames, escs.inverted_frames
        sent: list[int] = []
        board.on_start = lambda: sent.extend([escs.frames - frames, escs.inverted_frames - inverted])
        station.texts.clear()
        board.core.fail()
        station.until("what the restart says", lambda: station.said("Restarted"), _RESTART_S)
        complaints = board.complaints()
        assert not complaints, complaints
        assert sent[0] == sent[1] >= _STOP_FRAMES_MIN, f"{sent[0]} stop frames, {sent[1]} of them inverted"
        off = max(flight.vehicle.last_driven_ns, begun) - begun if escs.are_still() else None
        words = [f"{sent[0]} stop frames, inverted", *(text for _, text in station.texts)]
        return Outcome(motors_off_ms=None if off is None else off / NS_PER_MS, words=words,
                       restarts=list(board.restarts))


LISTENING: dict[str, WhileListening] = {
    "hard-fault-while-listening": WhileListening(Expected(2.0, ("Restarted: fault at",), restarts=(SOFTWARE,))),
}
