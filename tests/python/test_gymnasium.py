"""The environments as Gymnasium has them: with the package where it is there, else with a stand-in for it (stand_in/)."""

import copy
import importlib.util
import os
import subprocess
import sys
import unittest
import warnings
from pathlib import Path as FilePath

if importlib.util.find_spec("gymnasium") is None:
    sys.path.insert(0, str(FilePath(__file__).parent / "stand_in"))

import gymnasium
import numpy as np

import made_bone
import spinaltap
import spinaltap.env
from spinaltap.env import DrillEnv, VectorDrillEnv

IS_STAND_IN = gymnasium.__version__.endswith("stand-in")
NAME = "spinaltap/DrillPedicle-v0"
AHEAD = np.array([1.0, 0.0, 0.0, 0.0, 0.0], np.float32)


def options(**more):
    return {"bone": made_bone.bone(), "path": made_bone.path(), "spacing_mm": 0.3, **more}


def check_env(env):
    """What Gymnasium's own check asks, in words of ours: the real one where it is there."""
    if not IS_STAND_IN:
        from gymnasium.utils.env_checker import check_env as check

        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # that observations have no bounds, and that there is nothing to render
            return check(env, skip_render_check=True)
    assert isinstance(env, gymnasium.Env) and env.unwrapped is env
    assert isinstance(env.action_space, gymnasium.spaces.Box) and not hasattr(env, "seed")
    assert isinstance(env.observation_space, gymnasium.spaces.Box)
    first, info = env.reset()
    assert first in env.observation_space and isinstance(info, dict)
    seen, states = [], []
    for seed in (123, 123, 456):
        observation, _ = env.reset(seed=seed)
        assert observation in env.observation_space
        seen.append(observation)
        states.append(copy.deepcopy(env.unwrapped._np_random.bit_generator.state))
    assert np.array_equal(seen[0], seen[1]) and not np.array_equal(seen[0], seen[2])
    assert states[0] == states[1] != states[2]
    env.reset(options={})
    observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
    assert observation in env.observation_space and isinstance(info, dict)
    assert isinstance(reward, (float, np.floating)) and not np.isnan(reward)
    assert isinstance(terminated, (bool, np.bool_)) and isinstance(truncated, (bool, np.bool_))
    env.close()
    env.close()


class Gymnasium(unittest.TestCase):
    def test_takes_a_drilling_for_an_environment(self):
        check_env(DrillEnv(**options()))

    def test_makes_one_by_its_name(self):
        env = gymnasium.make(NAME, max_episode_steps=5, **options())
        self.assertIsInstance(env.unwrapped, DrillEnv)
        self.assertEqual(env.unwrapped.spec.id, NAME)
        first, _ = env.reset(seed=7)
        again = env.unwrapped.spec.make()
        np.testing.assert_array_equal(again.reset(seed=7)[0], first)
        for n in range(5):
            step, same = env.step(AHEAD), again.step(AHEAD)
            np.testing.assert_array_equal(step[0], same[0])
            self.assertEqual(step[1], same[1])
            self.assertEqual(step[3], n == 4)  # TimeLimit's

    def test_takes_files_for_bones_and_paths(self):
        files = {"bone": str(made_bone.FOLDER / "ground_truth.vdb"), "path": made_bone.FOLDER / "plan.json"}
        bone, path = spinaltap.env._hole(**files)
        self.assertEqual(bone.hash, made_bone.bone().hash)
        np.testing.assert_array_equal(path.target_mm, made_bone.path().target_mm)
        with self.assertRaisesRegex(ValueError, "expected a bone"):
            gymnasium.make(NAME, path=made_bone.path())
        with self.assertRaisesRegex(ValueError, "expected a path"):
            gymnasium.make(NAME, bone=made_bone.bone())

    def test_makes_many_at_once(self):
        envs = gymnasium.make_vec(NAME, num_envs=3, vectorization_mode="vector_entry_point", **options(max_steps=4))
        self.assertIsInstance(envs.unwrapped, VectorDrillEnv)
        self.assertIsInstance(envs.unwrapped, gymnasium.vector.VectorEnv)
        self.assertIs(envs.metadata["autoreset_mode"], gymnasium.vector.AutoresetMode.SAME_STEP)
        if IS_STAND_IN:
            from gymnasium.vector import RecordEpisodeStatistics
        else:
            from gymnasium.wrappers.vector import RecordEpisodeStatistics
        told = RecordEpisodeStatistics(envs)
        observations, _ = told.reset(seed=5)
        self.assertIn(observations, envs.observation_space)
        for _ in range(4):
            *_, truncated, info = told.step(np.tile(AHEAD, (3, 1)))
        self.assertTrue(truncated.all())
        np.testing.assert_array_equal(info["episode"]["l"], [4, 4, 4])
        np.testing.assert_array_equal(info["_final_info"], [True] * 3)
        self.assertIn("clearance_mm", info["final_info"])
        envs.close()
        self.assertTrue(envs.unwrapped.closed)

    def test_is_not_needed(self):
        # Nor a bone: this is the phantom.
        code = "import sys; sys.modules['gymnasium'] = None\nfrom spinaltap.env import Box, DrillEnv\n" \
               "env = DrillEnv(spacing_mm=0.4)\nassert isinstance(env.action_space, Box)\nenv.reset(seed=1)\n" \
               "assert env.metadata == {'render_modes': []} and env.unwrapped is env\nenv.close()\nprint('done')"
        said = subprocess.run([sys.executable, "-B", "-c", code], capture_output=True, text=True, env=os.environ)
        self.assertEqual(said.stdout, "done\n", said.stderr)


class Copies(unittest.TestCase):
    def test_of_bones_and_paths_are_the_same(self):
        bone, path = copy.deepcopy((made_bone.bone(), made_bone.path()))
        self.assertEqual(bone.hash, made_bone.bone().hash)
        np.testing.assert_array_equal(path.entry_mm, made_bone.path().entry_mm)
        self.assertIsInstance(path, spinaltap.Path)


if __name__ == "__main__":
    unittest.main()
