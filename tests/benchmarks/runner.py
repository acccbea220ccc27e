"""What thousands of cases cost end to end, and where the time goes: one run prints it all, nothing is asserted.

    .venv/bin/python tests/benchmarks/runner.py [--cases 10000] [--workers 2]

The cases are HOAP-2 postures of random joint angles, every contact set another, nothing reused between them: posed, assembled, verdict
with its proof, region to 1e-3 with the forces at its corners and the motions at its edges, record on disk. Rates are also given as if
the processors had nothing else to do: processes over processor time a case, that of this process included.
"""

from __future__ import annotations

import argparse
import gc
import os
import resource
import shutil
import tempfile
import time
from pathlib import Path

from socp_statics import run
from socp_statics.cases.answers import ANSWERS
from socp_statics.cases.solve import record_of
from socp_statics.cases.sweep_cases import Cases
from socp_statics.runner.work import TOGETHER, Part, answer_chunk

POSTURE = {"generator": "random_joint_angles", "robot": "hoap2", "friction": 0.6}
LIMITS = {"default": float("inf"), "?LEG_JOINT*": 4.0}
FREE = {"model": "support_region", "posture": POSTURE, "parameters": {"prices": False}}
LIMITED = {
    "model": "support_region",
    "posture": POSTURE | {"torque_limits": LIMITS},
    "parameters": {"prices": False, "torque_limits": True},
}
PROBLEM = """\
model = "support_region"
[posture]
generator = "random_joint_angles"
robot = "hoap2"
friction = 0.6
{limits}
[parameters]
prices = false
torque_limits = {limited}
[sweep]
"posture.seed" = {{ from = 0, to = {last} }}
"""
STEPS = ("statement read and posed", "verdict and region", "record", "line of JSON")


def breakdown(tables: dict, count: int) -> dict[str, float]:
    """Processor time of the steps of a worker, milliseconds a case, by the functions it calls."""
    cases = Cases(tables, {"posture.seed": range(10**6)}, "population", "population", None)
    spent = dict.fromkeys(STEPS, 0.0)
    gc.disable()  # as a worker does
    for first in range(0, count + TOGETHER, TOGETHER):
        at = [time.process_time()]
        problems = [cases.case(number) for number in range(first, first + TOGETHER)]
        stances = [problem.stance() for problem in problems]
        at.append(time.process_time())
        answer = ANSWERS.load(problems[0].model)
        if answer.many is not None and answer.many.kind(problems[0], "auto") is not None:
            keys = answer.many.compute(problems, stances, "auto")
        else:
            keys = [answer.compute(problem, stance, "auto") for problem, stance in zip(problems, stances, strict=True)]
        at.append(time.process_time())
        records = [record_of(*one, "kernel") for one in zip(problems, stances, keys, strict=True)]
        at.append(time.process_time())
        lines = [record.line() for record in records]
        at.append(time.process_time())
        if first:  # the first batch loads the kernel
            for step, begin, end in zip(STEPS, at[:-1], at[1:], strict=True):
                spent[step] += end - begin
        del problems, stances, keys, records, lines
    gc.enable()
    rounds = count // TOGETHER + (count % TOGETHER > 0)
    return {step: 1e3 * seconds / (rounds * TOGETHER) for step, seconds in spent.items()}


def chunk(tables: dict, count: int) -> float:
    """Processor time of a whole chunk in this process, milliseconds a case: the steps of `breakdown` and what a worker adds to them."""
    part = Part("population", "population", Path("population.toml"), tables, {"posture.seed": range(10**6)}, range(count), {})
    return 1e3 * answer_chunk([part], "auto").processor / count


def end_to_end(limited: bool, count: int, workers: int) -> float:
    """Run the cases and print what it took; returns the processor time of this process, milliseconds a case."""
    place = Path(tempfile.mkdtemp(prefix="runner_"))
    try:
        limits = "torque_limits = { default = inf, '?LEG_JOINT*' = 4.0 }" if limited else ""
        problem = place / "population.toml"
        problem.write_text(PROBLEM.format(limits=limits, limited=str(limited).lower(), last=count - 1))
        # What this process imports, and the server that processes are forked from, are paid for once.
        run([str(problem)], place / "warm", values={"posture.seed": 0}, workers=1)
        before = time.process_time()
        done = run([str(problem)], place / "runs", workers=workers)
        parent = time.process_time() - before
        size = sum(file.stat().st_size for file in (place / "runs").rglob("*") if file.is_file())
    finally:
        shutil.rmtree(place)
    each = (done.processor + parent) / count
    print(f"  on the clock {done.seconds:.1f} s, {count / done.seconds:.0f} a second (load of the machine {os.getloadavg()[0]:.1f})")
    print(f"  processor: workers {1e3 * done.processor / count:.3f} ms a case, this process {1e3 * parent / count:.3f} ms a case:"
          f" {workers / each:.0f} a second with {workers} processors to itself")  # fmt: skip
    print(f"  {size / count / 1e3:.1f} kB a case on disk; largest memory of this process"
          f" {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3:.0f} MB")  # fmt: skip
    return 1e3 * parent / count


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cases", type=int, default=10_000)
    parser.add_argument("--workers", type=int, default=2)
    asked = parser.parse_args()
    for title, tables, limited, count in (
        ("only friction limits", FREE, False, asked.cases),
        ("torque limits of 4 N m at the legs", LIMITED, True, max(asked.cases // 5, 1)),
    ):
        print(f"{count} random HOAP-2 postures, {title}, {asked.workers} workers")
        parent = end_to_end(limited, count, asked.workers)
        # Side by side in one process: two that work at the same time take from each other what memory and caches they share.
        steps, worker = breakdown(tables, min(count, 1000)), chunk(tables, min(count, 1000))
        for step, spent in steps.items():
            print(f"  {step:<28}{spent:>8.3f} ms")
        solving = steps["statement read and posed"] + steps["verdict and region"]
        print(f"  {'solving: the first two':<28}{solving:>8.3f} ms")
        records = steps["record"] + steps["line of JSON"]
        over = 100 * ((worker + parent) / solving - 1)
        print(f"  runner and records over solving {over:.0f} %, of that records {100 * records / solving:.0f} %")
