"""Drilling a pedicle as a task to learn. Where the package gymnasium is there, DrillEnv is a gymnasium.Env and
VectorDrillEnv a gymnasium.vector.VectorEnv, with its spaces, and gymnasium.make("spinaltap/DrillPedicle-v0") makes one;
where it is not, they have the same signatures.

An action holds for some cycles: how fast the bit is fed along its axis, moved aside along the path's own x and y, and
turned towards them, each from -1 to 1. Observations are named in OBSERVATIONS, in coordinates of the path. A step is
worth the depth that is new (1 a mm), less what a clearance below the margin costs; the target is worth `target_reward`
and ends the episode, and so does a breach, which costs `breach_penalty`.

The same seeds and actions bring the same bits, on any number of threads, alone or among others.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._core import Bone, InputError, Path
from ._gymnasium import Box, Env, VectorEnv, make_box, register, same_step

__all__ = ["ACTIONS", "OBSERVATIONS", "Box", "DrillEnv", "VectorDrillEnv", "make_vector"]

ACTIONS: tuple[str, ...] = ("feed", "aside_x", "aside_y", "turn_x", "turn_y")
OBSERVATIONS: tuple[str, ...] = _core.DrillTask.OBSERVATIONS

_Progress = Callable[[str, float], object]


@functools.cache
def _phantom() -> tuple[Bone, list[Path]]:
    return Bone.phantom()


def _hole(bone: Bone | str | PathLike[str] | None, path: Path | str | PathLike[str] | None) -> tuple[Bone, Path]:
    """Of what a name or a file stands for: the first path of a plan, the phantom's left one without either."""
    if bone is None:
        if path is not None:
            raise InputError("expected a bone for the path, found none")
        made, paths = _phantom()
        return made, paths[0]
    if not isinstance(bone, Bone):
        bone = Bone.load(bone)
    if path is None:
        raise InputError("expected a path through the bone, found none")
    if not isinstance(path, Path):
        path = _core.read_plan(path)[0]
    return bone, path


def _checked_actions(actions: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float32]:
    values = np.asarray(actions, np.float32)
    if values.shape != shape:
        raise InputError(f"expected actions of shape {shape}, found {values.shape}")
    return values


class DrillEnv(Env):
    """One drilling of one path. Options, all of them by name: see VectorDrillEnv.

    bone, path: or the files that hold them, of a plan its first path; neither: the phantom and the path through its left
    pedicle.
    """

    metadata: dict[str, Any] = {"render_modes": []}
    render_mode: str | None = None

    def __init__(
        self,
        bone: Bone | str | PathLike[str] | None = None,
        path: Path | str | PathLike[str] | None = None,
        *,
        progress: _Progress | None = None,
        **options: float,
    ) -> None:
        hole = _hole(bone, path)
        self.path = hole[1]
        self._task = _core.DrillTask([hole], 1, 0, options, progress)
        self.observation_space = make_box(-np.inf, np.inf, (len(OBSERVATIONS),))
        self.action_space = make_box(-1.0, 1.0, (len(ACTIONS),))

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins an episode: the first of `seed`, or without one the next. Gives an observation and no information."""
        super().reset(seed=seed)
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


class VectorDrillEnv(VectorEnv):
    """Many drillings at once, in C++ on all cores. An episode that ends begins again in the same step: the observation
    is the new episode's first, and `final_obs` has the old one's last.

    holes: a bone and a path, or several; the n-th drilling has holes[n % len(holes)]. threads: 0 for one a core.
    Options, by name: cycles_per_step (20), dt_s (0.001), max_steps (3000); of an action of 1: max_feed_mm_s (3),
    max_aside_mm_s (2), max_turn_deg_s (5); how an episode begins: start_mm (2) before the entry, at random by up to
    start_offset_mm (0.5) off the path and start_tilt_deg (3); rewards: margin_mm (1), margin_cost (2, a second without
    any clearance), target_reward (10), breach_penalty (20); of the points: radius_mm (5), spacing_mm (0.2).
    """

    metadata: dict[str, Any] = {"render_modes": [], "autoreset_mode": same_step()}
    render_mode: str | None = None

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
        self.single_observation_space = make_box(-np.inf, np.inf, (len(OBSERVATIONS),))
        self.single_action_space = make_box(-1.0, 1.0, (len(ACTIONS),))
        self.observation_space = make_box(-np.inf, np.inf, (num_envs, len(OBSERVATIONS)))
        self.action_space = make_box(-1.0, 1.0, (num_envs, len(ACTIONS)))

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
        super().reset(seed=seed if isinstance(seed, (int, np.integer)) else None)
        return self._task.reset(seeds), {}

    def step(
        self, actions: ArrayLike
    ) -> tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """As DrillEnv.step(), a row each. Where an episode ended, `final_obs` has its last observation and
        `final_info` its last information; `_final_obs` and `_final_info` say where."""
        given = _checked_actions(actions, self.action_space.shape)
        observations, rewards, terminated, truncated, breached, clearances, thrusts, last = self._task.step(given, True)
        info: dict[str, Any] = {"is_breach": breached, "clearance_mm": clearances, "max_thrust_n": thrusts}
        is_over = terminated | truncated
        if is_over.any():
            info["final_obs"] = last
            info["_final_obs"] = is_over
            info["final_info"] = {name: info[name] for name in ("is_breach", "clearance_mm", "max_thrust_n")}
            info["_final_info"] = is_over
        return observations, rewards, terminated, truncated, info

    def render(self) -> None:
        """Shows nothing."""


def make_vector(
    num_envs: int = 1,
    bone: Bone | str | PathLike[str] | None = None,
    path: Path | str | PathLike[str] | None = None,
    **options: Any,
) -> VectorDrillEnv:
    """What gymnasium.make_vec() calls: many drillings of one hole, named as DrillEnv's."""
    return VectorDrillEnv([_hole(bone, path)], num_envs, **options)


register("spinaltap/DrillPedicle-v0", "spinaltap.env:DrillEnv", "spinaltap.env:make_vector")
