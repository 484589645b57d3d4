"""What the environments have of Gymnasium; without it, the little of it that they need."""

import numpy as np

try:
    import gymnasium
    from gymnasium.vector import AutoresetMode
    from gymnasium.vector.utils import batch_space

    One, Many, Box = gymnasium.Env, gymnasium.vector.VectorEnv, gymnasium.spaces.Box
    NEXT_STEP = AutoresetMode.NEXT_STEP
except ImportError:
    gymnasium = None
    One, Many, NEXT_STEP = object, object, "NextStep"

    class Box:
        """What an environment without gymnasium says of its observations and actions: bounds, shape and type."""

        def __init__(self, low, high, shape=None, dtype=np.float32):
            self.dtype = np.dtype(dtype)
            shape = np.shape(low) if shape is None else shape
            self.low = np.broadcast_to(np.asarray(low, dtype), shape).copy()
            self.high = np.broadcast_to(np.asarray(high, dtype), shape).copy()
            self.shape = self.low.shape

        def contains(self, x):
            x = np.asarray(x)
            return x.shape == self.shape and bool(np.all((x >= self.low) & (x <= self.high)))

    def batch_space(space, n):
        return Box(np.repeat(space.low[None], n, 0), np.repeat(space.high[None], n, 0), dtype=space.dtype)
