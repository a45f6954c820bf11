"""Random and greedy actions in the drilling environment: python3 environment.py BONE PLAN [SEED]"""
import sys

import numpy as np

import spinaltap
from spinaltap.env import OBSERVATIONS, DrillEnv, VectorDrillEnv

EPISODES = 4
DEPTH, ASIDE, AXIS = (OBSERVATIONS.index(name) for name in ("depth_mm", "aside_x_mm", "axis_x"))


def greedy(observations):
    """Ahead along the path, back to it where it is off: half the way a step. A row each."""
    actions = np.zeros((*observations.shape[:-1], 5), np.float32)
    aside_mm, axis = observations[..., ASIDE : ASIDE + 2], observations[..., AXIS : AXIS + 2]
    actions[..., 0] = np.where(np.hypot(aside_mm[..., 0], aside_mm[..., 1]) < 0.2, 1.0, 0.2)  # slower beside the path
    actions[..., 1:3] = -0.5 * aside_mm / (2.0 * 0.02)  # an action of 1: 2 mm/s for 20 ms
    actions[..., 3:5] = -0.5 * axis / np.radians(5.0 * 0.02)  # and 5 degrees a second
    return actions.clip(-1.0, 1.0)


def episode(env, policy, seed):
    """What it earned, whether it breached, and how deep it came."""
    observation, _ = env.reset(seed=seed)
    earned, is_over = 0.0, False
    while not is_over:
        observation, reward, terminated, truncated, info = env.step(policy(observation))
        earned += reward
        is_over = terminated or truncated
    return earned, info["is_breach"], observation[DEPTH]


def episodes_at_once(env, policy, seed):
    """The same of the first episode of each drilling."""
    observations, _ = env.reset(seed=seed)
    earned, ends = np.zeros(env.num_envs), {}
    while len(ends) < env.num_envs:
        observations, rewards, terminated, truncated, info = env.step(policy(observations))
        earned += rewards
        for n in np.flatnonzero(terminated | truncated):
            ends.setdefault(int(n), (earned[n], bool(info["is_breach"][n]), info["final_obs"][n, DEPTH]))
    return [ends[n] for n in range(env.num_envs)]


def tell(name, ends):
    rewards, breaches, depths = zip(*ends)
    print(f"{name:24} mean reward {np.mean(rewards):7.2f}  breaches {sum(breaches)} of {len(ends)}  depths",
          *(f"{depth:.2f}" for depth in depths), "mm")


bone = spinaltap.Bone.load(sys.argv[1])
path = spinaltap.read_plan(sys.argv[2])[0]
seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
print(f"path of {path.length_mm:.2f} mm, seeds {seed} to {seed + EPISODES - 1}")
alone = DrillEnv(bone, path, max_steps=2000)
alone.action_space.seed(seed)
tell("random", [episode(alone, lambda _: alone.action_space.sample(), seed + n) for n in range(EPISODES)])
tell("greedy", [episode(alone, greedy, seed + n) for n in range(EPISODES)])
tell("greedy, all at once", episodes_at_once(VectorDrillEnv([(bone, path)], EPISODES, max_steps=2000), greedy, seed))
