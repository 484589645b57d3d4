"""Vehicle time and what is to happen at it.

Time is integer nanoseconds since power came. Nothing here waits: whoever runs the core moves the time on.
"""

import heapq
from collections.abc import Callable
from typing import Any

NS_PER_US = 1_000
NS_PER_MS = 1_000_000
NS_PER_S = 1_000_000_000


class Schedule:
    """Actions by the time at which they are due; those of one time in the order in which they were scheduled."""

    def __init__(self) -> None:
        self.now = 0
        self._queue: list[tuple[int, int, Callable[..., None], tuple[Any, ...]]] = []
        self._count = 0
        self.next_due = 1 << 62

    def at(self, time_ns: int, action: Callable[..., None], *arguments: Any) -> None:
        """Has `action` called at `time_ns`, or at once where that is over."""
        self._count += 1
        heapq.heappush(self._queue, (time_ns, self._count, action, arguments))
        self.next_due = self._queue[0][0]

    def after(self, delay_ns: int, action: Callable[..., None], *arguments: Any) -> None:
        """Has `action` called `delay_ns` from now."""
        self.at(self.now + delay_ns, action, *arguments)

    def run_due(self) -> None:
        """Does everything that is due."""
        queue = self._queue
        while queue and queue[0][0] <= self.now:
            _, _, action, arguments = heapq.heappop(queue)
            action(*arguments)
        self.next_due = queue[0][0] if queue else 1 << 62
