"""The environments: Gymnasium's signatures, rewards, and the same bits on any number of threads."""

import time
import unittest

import numpy as np

import made_bone
import spinaltap
from spinaltap.env import OBSERVATIONS, DrillEnv, VectorDrillEnv

AHEAD = [1.0, 0.0, 0.0, 0.0, 0.0]


def env(**options):
    return DrillEnv(made_bone.bone(), made_bone.path(), **{"spacing_mm": 0.3, **options})


def seen(observation, name):
    return observation[OBSERVATIONS.index(name)]


def episode(one, actions):
    """Everything that step() gave, until the end."""
    steps = []
    for action in actions:
        steps.append(one.step(action))
        if steps[-1][2] or steps[-1][3]:
            break
    return steps


class OneDrilling(unittest.TestCase):
    def test_reaches_the_target_straight_ahead(self):
        one = env(start_offset_mm=0.0, start_tilt_deg=0.0)
        first, info = one.reset(seed=1)
        self.assertEqual(info, {})
        self.assertTrue(one.observation_space.contains(first))
        self.assertAlmostEqual(seen(first, "depth_mm"), -2.0, places=5)
        steps = episode(one, [AHEAD] * 3000)
        observation, reward, terminated, truncated, info = steps[-1]
        self.assertTrue(terminated)
        self.assertFalse(truncated or info["is_breach"])
        self.assertAlmostEqual(seen(observation, "to_target_mm"), 0.0, delta=0.01)
        # A mm is worth 1, from 2 mm before the entry to the target; the pedicle's middle has a margin all the way.
        # Less the margin's cost, for the surface is near where the entry's rim ends.
        total = sum(step[1] for step in steps)
        self.assertLessEqual(total, made_bone.path().length_mm + 2.0 + 10.0 + 1e-6)
        self.assertGreater(total, made_bone.path().length_mm + 2.0 + 10.0 - 1.0)

    def test_ends_at_a_breach(self):
        one = env(start_tilt_deg=0.0)
        one.reset(seed=1)
        episode(one, [AHEAD] * 250)
        steps = episode(one, [[0.0, -1.0, 0.0, 0.0, 0.0]] * 400)
        _, reward, terminated, _, info = steps[-1]
        self.assertTrue(terminated and info["is_breach"])
        self.assertLess(info["clearance_mm"], 0.0)
        self.assertLess(reward, -19.0)
        with self.assertRaisesRegex(spinaltap.Error, "reset"):
            one.step(AHEAD)

    def test_is_cut_off_after_too_many_steps(self):
        one = env(max_steps=5)
        one.reset(seed=1)
        steps = episode(one, [[0.0] * 5] * 9)
        self.assertEqual(len(steps), 5)
        self.assertFalse(steps[-1][2])
        self.assertTrue(steps[-1][3])

    def test_is_the_same_for_the_same_seed(self):
        actions = np.random.default_rng(7).uniform(-1, 1, (60, 5))
        actions[:, 0] = 1.0
        runs = []
        for _ in range(2):
            one = env()
            first, _ = one.reset(seed=42)
            second = [one.step(action) for action in actions]
            again, _ = one.reset()
            runs.append((first, [step[0] for step in second], [step[1] for step in second], again))
        for a, b in zip(*runs):
            np.testing.assert_array_equal(a, b)
        self.assertFalse(np.array_equal(runs[0][0], runs[0][3]))

    def test_begins_within_its_bounds(self):
        one = env(start_offset_mm=0.5)
        offsets = []
        for seed in range(50):
            observation, _ = one.reset(seed=seed)
            offsets.append(np.hypot(seen(observation, "aside_x_mm"), seen(observation, "aside_y_mm")))
        self.assertLessEqual(max(offsets), 0.5 + 1e-6)
        self.assertGreater(max(offsets), 0.4)

    def test_rejects_what_is_no_action(self):
        one = env()
        with self.assertRaisesRegex(spinaltap.Error, "reset"):
            one.step(AHEAD)
        one.reset(seed=1)
        with self.assertRaisesRegex(spinaltap.Error, r"shape \(5,\)"):
            one.step([1.0])
        with self.assertRaisesRegex(spinaltap.Error, "not a number"):
            one.step([np.nan] * 5)
        with self.assertRaisesRegex(TypeError, "no_such_option"):
            env(no_such_option=1.0)
        with self.assertRaisesRegex(spinaltap.Error, "max_feed_mm_s"):
            env(max_feed_mm_s=-1.0)

    def test_fits_gymnasium_where_that_is_there(self):
        try:
            from gymnasium import spaces
        except ImportError:
            self.skipTest("gymnasium is not here")
        self.assertIsInstance(env().action_space, spaces.Box)


class ManyDrillings(unittest.TestCase):
    def rollout(self, threads, count=6, steps=120):
        many = VectorDrillEnv([(made_bone.bone(), made_bone.path())], count, threads=threads, spacing_mm=0.3,
                              max_steps=50)
        observations, _ = many.reset(seed=5)
        actions = np.random.default_rng(1).uniform(-1, 1, (steps, count, 5))
        actions[:, :, 0] = 1.0
        heard = [observations]
        ended = 0
        for action in actions:
            observations, rewards, terminated, truncated, info = many.step(action)
            heard += [observations, rewards, terminated, truncated]
            ended += int("final_obs" in info)
        self.assertGreater(ended, 0)
        return heard

    def test_are_the_same_on_any_number_of_threads(self):
        one, two, three = (self.rollout(threads) for threads in (1, 2, 3))
        for a, b, c in zip(one, two, three):
            np.testing.assert_array_equal(a, b)
            np.testing.assert_array_equal(a, c)

    def test_are_each_as_if_alone(self):
        many = VectorDrillEnv([(made_bone.bone(), made_bone.path())], 3, spacing_mm=0.3)
        first, _ = many.reset(seed=10)
        together = [many.step([AHEAD] * 3) for _ in range(40)]
        for n in range(3):
            one = env()
            alone, _ = one.reset(seed=10 + n)
            np.testing.assert_array_equal(alone, first[n])
            for step in together:
                observation, reward, *_ = one.step(AHEAD)
                np.testing.assert_array_equal(observation, step[0][n])
                self.assertEqual(reward, step[1][n])

    def test_take_a_seed_each(self):
        many = VectorDrillEnv([(made_bone.bone(), made_bone.path())], 3, spacing_mm=0.3)
        observations, _ = many.reset(seed=[7, 9, 7])
        np.testing.assert_array_equal(observations[0], observations[2])
        self.assertFalse(np.array_equal(observations[0], observations[1]))
        with self.assertRaisesRegex(spinaltap.Error, "seed for each of 3"):
            many.reset(seed=[1, 2])

    def test_tell_what_each_took_of_processor_time(self):
        many = VectorDrillEnv([(made_bone.bone(), made_bone.path())], 2, threads=1, spacing_mm=0.3)
        many.reset(seed=1)
        took_s = many._task.time_drillings()
        begin = time.process_time()
        many.step([AHEAD] * 2)
        self.assertTrue((took_s > 0).all())
        self.assertLess(took_s.sum(), time.process_time() - begin)

    def test_begin_again_by_themselves(self):
        many = VectorDrillEnv([(made_bone.bone(), made_bone.path())], 2, spacing_mm=0.3, max_steps=3)
        many.reset(seed=1)
        for _ in range(2):
            *_, truncated, info = many.step([AHEAD] * 2)
            self.assertNotIn("final_obs", info)
        observations, _, _, truncated, info = many.step([AHEAD] * 2)
        self.assertTrue(truncated.all() and info["_final_obs"].all())
        self.assertAlmostEqual(seen(observations[0], "depth_mm"), -2.0, places=5)
        self.assertGreater(seen(info["final_obs"][0], "depth_mm"), -2.0)


if __name__ == "__main__":
    unittest.main()
