"""What became of a spoiled run, and what must have."""

from dataclasses import dataclass, field


@dataclass
class Outcome:
    """Of one run."""

    # From the fault to the last moment at which a motor was driven, ms; none where they fly on.
    motors_off_ms: float | None = None
    words: list[str] = field(default_factory=list)
    restarts: list[str] = field(default_factory=list)
    # How far from where it hovered the vehicle was at most, m, where it flew on.
    strayed_m: float = 0.0
    processor_s: float = 0.0
    error: str | None = None


@dataclass(frozen=True)
class Expected:
    """Of one run: how soon the motors must stand still, or that they fly on; texts that must be among the words, and
    those that must not; why the chip starts again, in this order."""

    off_within_ms: float | None = None
    words: tuple[str, ...] = ()
    unsaid: tuple[str, ...] = ()
    restarts: tuple[str, ...] = ()
    strays_at_most_m: float = 0.15

    def problems(self, outcome: Outcome) -> list[str]:
        """What is not so."""
        if outcome.error is not None:
            return [outcome.error]
        wrong = []
        if self.off_within_ms is None and outcome.motors_off_ms is not None:
            wrong.append("the motors stopped")
        if self.off_within_ms is not None and not (
                outcome.motors_off_ms is not None and outcome.motors_off_ms <= self.off_within_ms):
            wrong.append(f"the motors must be off within {self.off_within_ms} ms")
        if self.off_within_ms is None and outcome.strayed_m > self.strays_at_most_m:
            wrong.append(f"{outcome.strayed_m:.2f} m away")
        wrong += [f"did not say {words!r}" for words in self.words if not any(words in text for text in outcome.words)]
        wrong += [f"said {words!r}" for words in self.unsaid if any(words in text for text in outcome.words)]
        if list(self.restarts) != outcome.restarts:
            wrong.append(f"restarts {outcome.restarts}, not {list(self.restarts)}")
        return wrong
