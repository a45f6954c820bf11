"""Drilling a pedicle as a task to learn, with the signatures of Gymnasium, whose package is not needed.

An action holds for some cycles: how fast the bit is fed along its axis, moved aside along the path's own x and y, and
turned towards them, each from -1 to 1. Observations are named in OBSERVATIONS, in coordinates of the path. A step is
worth the depth that is new (1 a mm), less what a clearance below the margin costs; the target is worth `target_reward`
and ends the episode, and so does a breach, which costs `breach_penalty`.

The same seeds and actions bring the same bits, on any number of threads, alone or among others.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._core import Bone, Error, Path

__all__ = ["ACTIONS", "OBSERVATIONS", "Box", "DrillEnv", "VectorDrillEnv"]

ACTIONS: tuple[str, ...] = ("feed", "aside_x", "aside_y", "turn_x", "turn_y")
OBSERVATIONS: tuple[str, ...] = _core.DrillTask.OBSERVATIONS

_Progress = Callable[[str, float], object]


class Box:
    """The numbers that an action or an observation may be, as gymnasium.spaces.Box has them."""

    def __init__(self, low: float, high: float, shape: tuple[int, ...]) -> None:
        self.low = np.full(shape, low, np.float32)
        self.high = np.full(shape, high, np.float32)
        self.shape = shape
        self.dtype = np.dtype(np.float32)
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

    def __repr__(self) -> str:
        return f"Box({self.low.min()}, {self.high.max()}, {self.shape}, float32)"


def _checked_actions(actions: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float32]:
    values = np.asarray(actions, np.float32)
    if values.shape != shape:
        raise Error(f"expected actions of shape {shape}, found {values.shape}")
    return values


class DrillEnv:
    """One drilling of one path. Options, all of them by name: see VectorDrillEnv."""

    metadata: dict[str, Any] = {"render_modes": []}
    render_mode: str | None = None
    spec: Any = None

    def __init__(self, bone: Bone, path: Path, *, progress: _Progress | None = None, **options: float) -> None:
        self.path = path
        self._task = _core.DrillTask([(bone, path)], 1, 0, options, progress)
        self.observation_space = Box(-np.inf, np.inf, (len(OBSERVATIONS),))
        self.action_space = Box(-1.0, 1.0, (len(ACTIONS),))

    @property
    def unwrapped(self) -> DrillEnv:
        """Itself."""
        return self

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins an episode: the first of `seed`, or without one the next. Gives an observation and no information."""
        return self._task.reset([seed])[0], {}

    def step(self, action: ArrayLike) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """An observation, the reward, whether the episode has ended, whether it was cut off, and information: of the
        step, `is_breach`, the least `clearance_mm` and `max_thrust_n`. Raises Error before the first reset(), after
        an episode's end, and on actions that are not numbers."""
        actions = _checked_actions(action, self.action_space.shape)
        observations, rewards, terminated, truncated, breached, clearances, thrusts, _ = self._task.step(actions, False)
        info = {
            "is_breach": bool(breached[0]),
            "clearance_mm": float(clearances[0]),
            "max_thrust_n": float(thrusts[0]),
        }
        return observations[0], float(rewards[0]), bool(terminated[0]), bool(truncated[0]), info

    def render(self) -> None:
        """Shows nothing."""

    def close(self) -> None:
        """Nothing is left open."""


class VectorDrillEnv:
    """Many drillings at once, in C++ on all cores. An episode that ends begins again in the same step: the observation
    is the new episode's first, and `final_obs` has the old one's last.

    holes: a bone and a path, or several; the n-th drilling has holes[n % len(holes)]. threads: 0 for one a core.
    Options, by name: cycles_per_step (20), dt_s (0.001), max_steps (3000); of an action of 1: max_feed_mm_s (3),
    max_aside_mm_s (2), max_turn_deg_s (5); how an episode begins: start_mm (2) before the entry, at random by up to
    start_offset_mm (0.5) off the path and start_tilt_deg (3); rewards: margin_mm (1), margin_cost (2, a second without
    any clearance), target_reward (10), breach_penalty (20); of the points: radius_mm (5), spacing_mm (0.2).
    """

    metadata: dict[str, Any] = {"render_modes": [], "autoreset_mode": "SameStep"}
    render_mode: str | None = None
    spec: Any = None

    def __init__(
        self,
        holes: Sequence[tuple[Bone, Path]],
        num_envs: int,
        *,
        threads: int = 0,
        progress: _Progress | None = None,
        **options: float,
    ) -> None:
        self.num_envs = num_envs
        self._task = _core.DrillTask(list(holes), num_envs, threads, options, progress)
        self.single_observation_space = Box(-np.inf, np.inf, (len(OBSERVATIONS),))
        self.single_action_space = Box(-1.0, 1.0, (len(ACTIONS),))
        self.observation_space = Box(-np.inf, np.inf, (num_envs, len(OBSERVATIONS)))
        self.action_space = Box(-1.0, 1.0, (num_envs, len(ACTIONS)))

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins an episode of each. A seed s gives the n-th s + n; several give each its own."""
        seeds: Sequence[int | None]
        if seed is None:
            seeds = [None] * self.num_envs
        elif isinstance(seed, (int, np.integer)):
            seeds = [int(seed) + n for n in range(self.num_envs)]
        else:
            seeds = seed
        return self._task.reset(seeds), {}

    def step(
        self, actions: ArrayLike
    ) -> tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """As DrillEnv.step(), a row each. Where an episode ended, `final_obs` has its last observation, and
        `_final_obs` says where."""
        given = _checked_actions(actions, self.action_space.shape)
        observations, rewards, terminated, truncated, breached, clearances, thrusts, last = self._task.step(given, True)
        info: dict[str, Any] = {"is_breach": breached, "clearance_mm": clearances, "max_thrust_n": thrusts}
        is_over = terminated | truncated
        if is_over.any():
            info["final_obs"] = last
            info["_final_obs"] = is_over
        return observations, rewards, terminated, truncated, info

    def render(self) -> None:
        """Shows nothing."""

    def close(self) -> None:
        """Nothing is left open."""
