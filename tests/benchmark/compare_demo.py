#!/usr/bin/env python3
"""What `spinaltap demo` takes with one program and with another, in turns, and whether both write the same.

compare_demo.py OLD NEW [--rounds N] [-- ARGUMENTS of demo, such as a CT]

Prints each run's processor time (user and system) and wall time, the medians' ratio, and for each file of the last
round whether both programs wrote the same: its bytes, but for what the clock has a part in, and of report.html the
pictures. Figures of --json are compared one by one; those of meshes may differ. No argument: the phantom.
"""

import argparse
import json
import pathlib
import re
import resource
import statistics
import subprocess
import sys
import tempfile
import time

CLOCK = ("times", "seconds", "per_s", "created")


def run(program, arguments, folder):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begin = time.monotonic()
    command = [program, "demo", *arguments, "-o", str(folder / "out"), "--json", str(folder / "figures.json")]
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode not in (0, 1):
        sys.exit(f"{program}: {done.stderr}")
    wall_s = time.monotonic() - begin
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime, wall_s


def figures_of(value, name=""):
    if isinstance(value, dict):
        for key, one in value.items():
            if not any(word in key for word in CLOCK):
                yield from figures_of(one, f"{name}.{key}" if name else key)
    elif isinstance(value, list):
        for n, one in enumerate(value):
            yield from figures_of(one, f"{name}[{n}]")
    else:
        yield name, value


def bytes_of(file):
    """What a file holds, but for what the clock has a part in: the last column of log.csv, what stands
    before the names in files.txt, and of report.html all but its pictures."""
    if file.name == "log.csv":
        return [line.rpartition(",")[0] for line in file.read_text().splitlines()]
    if file.name == "files.txt":
        return [line.split()[-1] for line in file.read_text().splitlines()]
    if file.name == "report.html":
        return re.findall(r"data:image/png;base64,[^\"]*", file.read_text())
    return file.read_bytes()


def compare(old, new):
    for file in sorted(p.relative_to(old) for p in old.rglob("*") if p.is_file()):
        if file.name == "figures.json":
            continue
        same = (new / file).is_file() and bytes_of(old / file) == bytes_of(new / file)
        print(f"  {'same' if same else 'DIFFERS':8} {file}")
    first = dict(figures_of(json.loads((old / "figures.json").read_text())))
    second = dict(figures_of(json.loads((new / "figures.json").read_text())))
    differ = [name for name in first if first[name] != second.get(name)]
    print(f"  {len(first) - len(differ)} of {len(first)} figures are the same; others:", ", ".join(differ) or "none")


def partition(words, at):
    n = words.index(at) if at in words else len(words)
    return words[:n], words[n : n + 1], words[n + 1 :]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("--rounds", type=int, default=3)
    own, _, demo = (list(part) for part in partition(sys.argv[1:], "--"))
    options = parser.parse_args(own)
    processor_s = {"old": [], "new": []}
    for number in range(options.rounds):
        with tempfile.TemporaryDirectory() as folder:
            for which in ("old", "new"):
                place = pathlib.Path(folder) / which
                place.mkdir()
                took_s, wall_s = run(getattr(options, which), demo, place)
                processor_s[which].append(took_s)
                print(f"round {number + 1}, {which}: {took_s:.1f} s of processor time, {wall_s:.1f} s", flush=True)
            if number + 1 == options.rounds:
                compare(pathlib.Path(folder) / "old", pathlib.Path(folder) / "new")
    old_s, new_s = (statistics.median(processor_s[which]) for which in ("old", "new"))
    print(f"median: {old_s:.1f} s and {new_s:.1f} s of processor time: {new_s / old_s:.2f}")


if __name__ == "__main__":
    main()
