"""Figures as cells, cells as an aligned Markdown table. Units are in the rows' own text."""


def number(value):
    return "<1e-6" if 0 < abs(value) < 1e-6 else f"{value:.3g}"


def arrival(figures, duration):
    return f"not in {duration:.0f} s" if figures["arrival"] is None else number(figures["arrival"])


def drifts(figures, distance):
    """Whether a mean position still moves: in 10 s by more than 1 mm and by 5 % of the distance that is asked about."""
    return 10.0 * figures["drift"] > max(1e-3, 0.05 * distance)


def cell(figures, duration):
    """What the table says of the figures of one flight of so many seconds."""
    if figures is None:
        return "-"
    if figures["lost"]:
        return "lost"
    if "height_lost" in figures:
        return f"{number(figures['height_lost'])}, {number(figures['risen'])}, {arrival(figures, duration)}"
    if "arrival" in figures:
        return arrival(figures, duration)
    if "rotor_change" in figures:
        return f"{number(figures['rms'])}, {number(figures['rotor_change'])}"
    distance = next(figures[name] for name in ("offset", "deepest", "rms") if name in figures)
    if not drifts(figures, distance):
        return number(distance)
    return f"drifts, {number(figures['drift'])} m/s"


def markdown(header, lines):
    """Rows of text, each column as wide as its widest cell."""
    widths = [max(len(line[column]) for line in [header, *lines]) for column in range(len(header))]
    ruled = [header, ["-" * width for width in widths], *lines]
    return "\n".join("| " + " | ".join(text.ljust(width) for text, width in zip(line, widths)) + " |" for line in ruled)
