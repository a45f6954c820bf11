"""Of the stand-in."""

import numpy as np


class Space:
    pass


class Box(Space):
    def __init__(self, low, high, shape=None, dtype=np.float32, seed=None):
        self.low, self.high = np.full(shape, low, dtype), np.full(shape, high, dtype)
        self.shape, self.dtype = tuple(shape), np.dtype(dtype)
        self.seed(seed)

    def seed(self, seed=None):
        self._random = np.random.default_rng(seed)

    def sample(self):
        if np.isfinite(self.low).all():
            return self._random.uniform(self.low, self.high).astype(self.dtype)
        return self._random.standard_normal(self.shape).astype(self.dtype)

    def contains(self, x):
        return (
            isinstance(x, np.ndarray)
            and np.can_cast(x.dtype, self.dtype)
            and x.shape == self.shape
            and bool((x >= self.low).all() and (x <= self.high).all())
        )

    __contains__ = contains
