"""A stand-in for the package gymnasium, which Debian does not have: not it, and none of its code. It has the rules by
which Gymnasium 1.x takes an environment or rejects it: whose instance an environment and its spaces are, what make() does
to their arguments, how a reset seeds, and what a wrapper asks for. tests/python/test_gymnasium.py takes the real package
where that is there."""

import copy
import importlib

import numpy as np

from . import spaces

__version__ = "0.stand-in"
registry = {}


class Env:
    metadata = {"render_modes": []}
    render_mode = None
    spec = None
    _np_random = None

    def reset(self, *, seed=None, options=None):
        if seed is not None:
            if not (isinstance(seed, (int, np.integer)) and seed >= 0):
                raise ValueError(f"seed must be a whole number of 0 or more, found {seed}")
            self._np_random = np.random.default_rng(seed)

    def close(self):
        pass

    @property
    def unwrapped(self):
        return self


class Wrapper(Env):
    def __init__(self, env):
        assert isinstance(env, Env), f"expected a gymnasium.Env, found {type(env)}"
        self.env = env

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self.env, name)

    @property
    def unwrapped(self):
        return self.env.unwrapped

    def reset(self, *, seed=None, options=None):
        return self.env.reset(seed=seed, options=options)

    def step(self, action):
        return self.env.step(action)


class TimeLimit(Wrapper):
    def __init__(self, env, max_episode_steps):
        super().__init__(env)
        self._left = self._most = max_episode_steps

    def reset(self, *, seed=None, options=None):
        self._left = self._most
        return super().reset(seed=seed, options=options)

    def step(self, action):
        observation, reward, terminated, truncated, info = self.env.step(action)
        self._left -= 1
        return observation, reward, terminated, truncated or self._left <= 0, info


class Spec:
    def __init__(self, id, entry_point, vector_entry_point, kwargs):
        self.id, self.entry_point, self.vector_entry_point, self.kwargs = id, entry_point, vector_entry_point, kwargs

    def make(self, **kwargs):
        return make(self.id, **{**self.kwargs, **kwargs})


def register(id, entry_point=None, vector_entry_point=None, kwargs=None):
    registry[id] = Spec(id, entry_point, vector_entry_point, kwargs or {})


def _load(place):
    module, name = place.split(":")
    return getattr(importlib.import_module(module), name)


def make(id, max_episode_steps=None, **kwargs):
    spec = copy.deepcopy(registry[id])
    spec.kwargs.update(kwargs)
    env = _load(spec.entry_point)(**spec.kwargs)
    assert isinstance(env, Env), f"expected a gymnasium.Env, found {type(env)}"
    env.unwrapped.spec = copy.deepcopy(spec)
    assert isinstance(env.action_space, spaces.Space) and isinstance(env.observation_space, spaces.Space)
    return TimeLimit(env, max_episode_steps) if max_episode_steps else Wrapper(env)


def make_vec(id, num_envs=1, vectorization_mode="vector_entry_point", **kwargs):
    assert vectorization_mode == "vector_entry_point"
    from .vector import VectorEnv

    spec = copy.deepcopy(registry[id])
    spec.kwargs.update(kwargs)
    envs = _load(spec.vector_entry_point)(num_envs=num_envs, **spec.kwargs)
    assert isinstance(envs, VectorEnv), f"expected a gymnasium.vector.VectorEnv, found {type(envs)}"
    envs.unwrapped.spec = copy.deepcopy(spec)
    return envs
