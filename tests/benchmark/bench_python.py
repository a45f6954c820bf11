"""What Python adds to a step and to whole arrays, and what threads bring to the vector environment.

    PYTHONPATH=build/python SPINALTAP_PYTHON_TEST_DATA=FOLDER /usr/bin/python3 tests/benchmark/bench_python.py

FOLDER is what `spinaltap phantom FOLDER` made; build/bin/bench_session has C++'s figures of the same drilling. Medians.
"""

import os
import statistics
import time
from pathlib import Path as FilePath

import numpy as np

import spinaltap
from spinaltap.env import VectorDrillEnv

ROUNDS = 9
folder = FilePath(os.environ["SPINALTAP_PYTHON_TEST_DATA"])
bone = spinaltap.Bone.load(folder / "truth.vdb")
path = spinaltap.read_plan(folder / "plan.json")[0]
session = spinaltap.Session(bone, path)
poses = spinaltap.PlannedMotion(path, feed_mm_s=10.0).poses()
tips, axes = list(poses[:, :3].copy()), list(poses[:, 3:].copy())


def microseconds(work, count):
    """By the process's own clock, as a busy machine's tells nothing."""
    begin = time.process_time()
    work()
    return (time.process_time() - begin) / count * 1e6


def in_steps():
    for tip, axis in zip(tips, axes):
        session.step(tip, axis)


def in_steps_with_forces():
    for tip, axis in zip(tips, axes):
        session.step(tip, axis).force_n


figures = {"one step": [], "one step, force read": [], "a step of run()": []}
spinaltap.set_threads(1)
for _ in range(ROUNDS):
    for name, work in zip(figures, (in_steps, in_steps_with_forces, lambda: session.run(poses))):
        figures[name].append(microseconds(work, len(poses)))
        session.undo()
for name, values in figures.items():
    print(f"{name:24} {statistics.median(values):8.3f} us, {min(values):8.3f} to {max(values):8.3f}")

spinaltap.set_threads(0)

COUNT, STEPS = 8, 200
environments = {
    threads: VectorDrillEnv([(bone, path)], COUNT, threads=threads) for threads in sorted({1, 2, os.cpu_count() or 1})
}
actions = np.random.default_rng(1).uniform(-0.2, 0.2, (STEPS, COUNT, 5)).astype(np.float32)
actions[:, :, 0] = 1.0
rates = {threads: [] for threads in environments}
for _ in range(ROUNDS):
    for threads, environment in environments.items():
        environment.reset(seed=1)
        begin = time.perf_counter()
        for action in actions:
            environment.step(action)
        rates[threads].append(COUNT * STEPS / (time.perf_counter() - begin))
for threads, values in rates.items():
    share = statistics.median(a / b for a, b in zip(values, rates[1]))
    print(f"{threads} threads: {statistics.median(values):8.0f} steps of 20 cycles a second, {share:.2f} of one's")
