"""What Python adds to a step and to whole arrays, and what a second thread brings to the vector environment.

    PYTHONPATH=build/python SPINALTAP_PYTHON_TEST_DATA=FOLDER /usr/bin/python3 tests/benchmark/bench_python.py

FOLDER is what `spinaltap phantom FOLDER` made; build/bin/bench_session has C++'s figures of the same drilling. Medians.

Two threads are worth twice one only where two cores are free. `--priority` asks for SCHED_RR while it measures,
some seconds, where the user's rights allow: then other work does not count. Without it, look at the figures
of processor time: what of a step no thread can share, and how evenly the rest lies on two.
"""

import os
import statistics
import sys
import time
from pathlib import Path as FilePath

import numpy as np

import spinaltap
from spinaltap.env import VectorDrillEnv

ROUNDS = 9
folder = FilePath(os.environ["SPINALTAP_PYTHON_TEST_DATA"])
bone = spinaltap.Bone.load(folder / "ground_truth.vdb")
path = spinaltap.read_plan(folder / "plan.json")[0]


def set_priority(is_high):
    """Of all threads of this process. False where it is not allowed."""
    kind, level = (os.SCHED_RR, 1) if is_high else (os.SCHED_OTHER, 0)
    try:
        for task in os.listdir("/proc/self/task"):
            os.sched_setscheduler(int(task), kind, os.sched_param(level))
    except OSError:
        return False
    return True


def measure_steps():
    """By the process's own clock, as a busy machine's tells nothing."""
    session = spinaltap.Session(bone, path)
    poses = spinaltap.PlannedMotion(path, feed_mm_s=10.0).poses()
    tips, axes = list(poses[:, :3].copy()), list(poses[:, 3:].copy())
    nowhere = [np.full(3, np.nan)] * len(tips)  # rejected at once: what is left is the way there and back

    def in_steps(tips):
        for tip, axis in zip(tips, axes):
            session.step(tip, axis)

    def in_steps_with_forces():
        for tip, axis in zip(tips, axes):
            session.step(tip, axis).force_n

    works = {
        "one step": lambda: in_steps(tips),
        "one step, force read": in_steps_with_forces,
        "one step, rejected": lambda: in_steps(nowhere),
        "a step of run()": lambda: session.run(poses),
    }
    figures = {name: [] for name in works}
    spinaltap.set_threads(1)
    for _ in range(ROUNDS):
        for name, work in works.items():
            begin = time.process_time()
            work()
            figures[name].append((time.process_time() - begin) / len(poses) * 1e6)
            session.undo()
    spinaltap.set_threads(0)
    for name, values in figures.items():
        print(f"{name:24} {statistics.median(values):8.3f} us, {min(values):8.3f} to {max(values):8.3f}")


def on_two(took_s):
    """When both of two threads are done, each taking the next drilling when it is free. took_s: steps by drillings."""
    ends = np.zeros((len(took_s), 2))
    for drilling in took_s.T:
        first = ends.argmin(axis=1)
        ends[np.arange(len(ends)), first] += drilling
    return ends.max(axis=1)


def cpu_of_threads():
    """Seconds on a core, by thread."""
    tasks = FilePath("/proc/self/task")
    return {task.name: int((task / "schedstat").read_text().split()[0]) * 1e-9 for task in tasks.iterdir()}


def measure_environments(count, steps, wants_priority):
    """Straight ahead, shaking a little; alternately on one thread and on two."""
    actions = np.random.default_rng(1).uniform(-0.2, 0.2, (steps, count, 5)).astype(np.float32)
    actions[:, :, 0] = 1.0
    environments = {threads: VectorDrillEnv([(bone, path)], count, threads=threads) for threads in (1, 2)}
    took = {threads: environment._task.time_drillings() for threads, environment in environments.items()}
    for environment in environments.values():
        environment.reset(seed=1)
        environment.step(actions[0])  # the second thread is there now
    has_priority = wants_priority and set_priority(True)
    wall_s = {threads: [] for threads in environments}
    drilling_s = {threads: [] for threads in environments}
    own_s = {threads: [] for threads in environments}
    shares = []
    for _ in range(ROUNDS):
        for threads, environment in environments.items():
            environment.reset(seed=1)
            kept = np.empty((steps, count))
            before, own, begin = cpu_of_threads(), time.thread_time(), time.perf_counter()
            for n, action in enumerate(actions):
                environment.step(action)
                kept[n] = took[threads]
            wall_s[threads].append(time.perf_counter() - begin)
            own_s[threads].append(time.thread_time() - own)
            drilling_s[threads].append(kept)
            after = cpu_of_threads()
        spent = sorted((after[task] - before.get(task, 0.0) for task in after), reverse=True)
        shares.append([1e6 * s / steps for s in spent[:2]])
    if has_priority:
        set_priority(False)

    print(f"\n{count} drillings, steps of 20 cycles{', SCHED_RR' if has_priority else ''}")
    for threads, values in wall_s.items():
        print(f"  {threads} threads: {count * steps / statistics.median(values):8.0f} steps a second by the clock")
    ratios = [one / two for one, two in zip(wall_s[1], wall_s[2])]
    print(f"  ratio by the clock: {statistics.median(ratios):.2f}, {min(ratios):.2f} to {max(ratios):.2f}")
    # Round by round: what else the processor did meanwhile is in both.
    serial_s = statistics.median(own - kept.sum() for own, kept in zip(own_s[1], drilling_s[1]))
    alone_s = np.median(drilling_s[1], axis=0)
    beside_s = np.median(drilling_s[2], axis=0)
    whole_s = serial_s + alone_s.sum()
    print("  processor time of a step of all, medians; the clocks' own counts as all else:")
    print(f"    one thread: drilling {1e6 * alone_s.sum() / steps:.0f} us, all else {1e6 * serial_s / steps:.0f} us: a "
          f"serial share of {serial_s / whole_s:.1%}, so at most {whole_s / (serial_s + alone_s.sum() / 2):.2f} times")
    caller, worker = np.median(shares, axis=0)
    print(f"    two threads: {caller:.0f} and {worker:.0f} us, waits for each other included; drilling "
          f"{1e6 * beside_s.sum() / steps:.0f} us, {beside_s.sum() / alone_s.sum():.2f} times one thread's")
    uneven_s = on_two(beside_s).sum()
    print(f"    the longer of two threads drills {2 * uneven_s / beside_s.sum() - 1:.1%} more than half; expected ratio "
          f"{whole_s / (serial_s + uneven_s):.2f}")


if __name__ == "__main__":
    wants_priority = "--priority" in sys.argv[1:]
    if "--environments" not in sys.argv[1:]:
        has_priority = wants_priority and set_priority(True)
        measure_steps()
        if has_priority:
            set_priority(False)
    measure_environments(8, 200, wants_priority)
    measure_environments(64, 60, wants_priority)
