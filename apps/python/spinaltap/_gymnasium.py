"""What the environments are made of: Gymnasium's classes where its package is there, and else our own that look alike."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["HAS_GYMNASIUM", "Box", "Env", "VectorEnv", "make_box", "register", "same_step"]


class _Box:
    """The numbers that an action or an observation may be, as gymnasium.spaces.Box has them."""

    def __init__(self, low: float, high: float, shape: tuple[int, ...], dtype: type[np.float32] = np.float32) -> None:
        self.low = np.full(shape, low, dtype)
        self.high = np.full(shape, high, dtype)
        self.shape = shape
        self.dtype = np.dtype(dtype)
        self._random = np.random.default_rng(0)

    def seed(self, seed: int | None = None) -> None:
        """Of sample()."""
        self._random = np.random.default_rng(seed)

    def sample(self) -> NDArray[np.float32]:
        """Even between the bounds; a normal number where there are none."""
        if np.isfinite(self.low).all() and np.isfinite(self.high).all():
            return self._random.uniform(self.low, self.high).astype(np.float32)
        return self._random.standard_normal(self.shape).astype(np.float32)

    def contains(self, x: ArrayLike) -> bool:
        """Whether it has the shape, and lies between the bounds."""
        values = np.asarray(x)
        return values.shape == self.shape and bool(((values >= self.low) & (values <= self.high)).all())

    def __contains__(self, x: ArrayLike) -> bool:
        return self.contains(x)

    def __repr__(self) -> str:
        return f"Box({self.low.min()}, {self.high.max()}, {self.shape}, float32)"


class _Env:
    """gymnasium.Env's and gymnasium.vector.VectorEnv's part in ours."""

    metadata: dict[str, Any] = {"render_modes": []}
    render_mode: str | None = None
    spec: Any = None

    @property
    def unwrapped(self) -> Any:
        """Itself."""
        return self

    def reset(self, *, seed: Any = None, options: dict[str, Any] | None = None) -> Any:
        """Seeds nothing: all that is random is in C++."""

    def render(self) -> Any:
        """Shows nothing."""

    def close(self, **_: Any) -> None:
        """Nothing is left open."""


if TYPE_CHECKING:
    HAS_GYMNASIUM: bool
    Box = _Box
    Env = _Env
    VectorEnv = _Env
else:
    try:
        from gymnasium import Env
        from gymnasium.spaces import Box
        from gymnasium.vector import VectorEnv

        HAS_GYMNASIUM = True
    except ImportError:
        Box, Env, VectorEnv = _Box, _Env, _Env
        HAS_GYMNASIUM = False


def make_box(low: float, high: float, shape: tuple[int, ...]) -> Box:
    """Of 32-bit floats."""
    return Box(low, high, shape, np.float32)


def same_step() -> Any:
    """That an episode begins again in the step in which the last one ends: Gymnasium's word for it, from 1.1 on an enum."""
    if HAS_GYMNASIUM:
        modes = getattr(importlib.import_module("gymnasium.vector"), "AutoresetMode", None)
        if modes is not None:
            return modes.SAME_STEP
    return "SameStep"


def register(name: str, entry_point: str, vector_entry_point: str) -> None:
    """So that gymnasium.make() and make_vec() find it. Once, however often the module is loaded."""
    if not HAS_GYMNASIUM:
        return
    gymnasium = importlib.import_module("gymnasium")
    if name not in gymnasium.registry:
        gymnasium.register(id=name, entry_point=entry_point, vector_entry_point=vector_entry_point)
