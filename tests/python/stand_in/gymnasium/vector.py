"""Of the stand-in."""

import enum

import numpy as np


class AutoresetMode(enum.Enum):
    NEXT_STEP = "NextStep"
    SAME_STEP = "SameStep"
    DISABLED = "Disabled"


class VectorEnv:
    metadata = {}
    spec = None
    render_mode = None
    closed = False
    _np_random = None

    def reset(self, *, seed=None, options=None):
        if seed is not None:
            self._np_random = np.random.default_rng(seed)

    def close(self, **kwargs):
        if not self.closed:
            self.close_extras(**kwargs)
            self.closed = True

    def close_extras(self, **kwargs):
        pass

    @property
    def unwrapped(self):
        return self


class RecordEpisodeStatistics(VectorEnv):
    """A wrapper that sums up: it asks for the enum, and for arrays that numpy adds."""

    def __init__(self, env):
        assert isinstance(env, VectorEnv), f"expected a gymnasium.vector.VectorEnv, found {type(env)}"
        assert isinstance(env.metadata["autoreset_mode"], AutoresetMode)
        self.env, self.num_envs = env, env.num_envs

    def reset(self, *, seed=None, options=None):
        self._returns, self._lengths = np.zeros(self.num_envs), np.zeros(self.num_envs, int)
        return self.env.reset(seed=seed, options=options)

    def step(self, actions):
        observations, rewards, terminated, truncated, info = self.env.step(actions)
        self._returns += rewards
        self._lengths += 1
        is_over = np.logical_or(terminated, truncated)
        if is_over.any():
            assert "episode" not in info and (info["_final_obs"] == is_over).all()
            info["episode"] = {"r": np.where(is_over, self._returns, 0.0), "l": np.where(is_over, self._lengths, 0)}
            self._returns[is_over] = 0.0
            self._lengths[is_over] = 0
        return observations, rewards, terminated, truncated, info
