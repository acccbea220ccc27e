"""All benchmarks in one run: ``python tests/benchmarks/kernel.py [--quick] [--figure FILE] [--json FILE] [--only KIND]...``

One suite of stances, one thread, sides interleaved; medians and ratios within the run, worst cases beside them, and the error of
every answer against the exact one. Nothing is asserted. Peers that are not installed are named and left out:
``pip install socp-statics[peers]``.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from typing import Any

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS")
KINDS = ("region", "direction", "verdict", "minimax", "torque", "growth", "threads")
VERSIONS = ("socp-statics", "numpy", "numba", "clarabel", "cvxpy-base", "klampt", "hpp-centroidal-dynamics", "moreau", "highspy")


def machine() -> dict[str, Any]:
    """What the numbers were measured on."""
    versions = {}
    for name in VERSIONS:
        try:
            versions[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return {
        "processor": names[0] if names else platform.processor(),
        "processors": os.cpu_count(),
        "python": platform.python_version(),
        "versions": versions,
        "load": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
    }


def survey(effort: Any, kinds: tuple[str, ...] = KINDS, write: Callable[[str], None] = print) -> dict[str, Any]:
    """Ask, time and print everything.

    Args:
        effort: How much.
        kinds: Which kinds of work.
        write: Takes the lines of the tables.

    Returns:
        "record", the numbers as they go into JSON; "curves" and "sharing" for the figure.
    """
    # Imported here: the number of threads has to be set before NumPy is imported.
    from benchmarks import curves, own, questions, tables, targets
    from benchmarks.peers import all_ways
    from benchmarks.timing import Clock, interleaved

    def show(lines: list[str]) -> None:
        for line in lines:
            write(line)

    clock = Clock()
    sizes = [len(s.point_contacts()[0]) for s in effort.stances]
    eight = f"{len(effort.eight)} stances of 8 points"
    asked = {
        "region": (
            f"exact support region to a relative gap of {questions.GAP:g}, {len(sizes)} stances of {min(sizes)} to {max(sizes)} points",
            lambda: questions.region_cases(effort.stances), questions.area_errors,
        ),
        "direction": (
            f"one support direction, {eight}, {effort.directions} directions each",
            lambda: questions.direction_cases(effort.eight, effort.directions), questions.height_errors,
        ),
        "verdict": (
            f"verdict, margin and forces, {eight}, {effort.coms} random centres of mass each",
            lambda: questions.verdict_cases(effort.eight, effort.coms), questions.verdict_errors,
        ),
        "minimax": (
            f"least possible largest force at a point, {eight}, {effort.forces} centres of mass each",
            lambda: questions.minimax_cases(effort.eight, effort.forces), questions.force_errors,
        ),
        "torque": (
            f"torque-limited support region to {questions.GAP:g}, HOAP-2 half squat, 12 leg joints, {len(effort.torque_problems)} limits",
            lambda: questions.torque_cases(effort.torque_problems), questions.area_errors,
        ),
    }  # fmt: skip
    by_question, record = {}, {"machine": machine(), "questions": {}}
    write(f"{record['machine']['processor']}, {record['machine']['processors']} processors, load {record['machine']['load']}")
    write(", ".join(f"{name} {version}" for name, version in record["machine"]["versions"].items()))
    for kind, (title, make, errors) in asked.items():
        if kind not in kinds:
            continue
        cases = make()
        ways = own.ways(kind) + (all_ways(kind) if effort.peers else [])
        found = interleaved(ways, cases, effort.repetitions, effort.seconds, clock)
        show(tables.question_table(title, found, lambda m, cases=cases, errors=errors: errors(cases, m)))
        by_question[kind] = found
        record["questions"][kind] = {
            m.way.name: {"solver": m.way.solver, "cone": m.way.cone, "side": m.way.side, "missing": m.way.missing,
                         "seconds": {case: m.median(case) for case in m.times}, "failures": m.failures,
                         "error": errors(cases, m) if m.times else None}
            for m in found
        }  # fmt: skip
    reached = targets.all_judged(by_question)
    result = {"record": record, "curves": [], "sharing": curves.Sharing(0, {}, missing="not asked")}
    if "growth" in kinds:
        record["growth"] = []
        for table in curves.grow(effort, clock):
            show(["", f"time [us] of a {table[0].question} against the number of contact points, family '{table[0].family}'"])
            show(tables.growth_table(table))
            result["curves"].append(table)
            record["growth"] += [{"question": c.question, "family": c.family, "way": c.way.name, "points": c.points, "seconds": c.seconds,
                                  "exponent": c.exponent, "note": c.note} for c in table]  # fmt: skip
            reached += targets.growth_judged(table)
    if "threads" in kinds:
        result["sharing"] = curves.share(effort)
        show(["", f"threads over a batch of {result['sharing'].regions} regions"])
        show(tables.threads_table(result["sharing"]))
        shared = result["sharing"]
        record["threads"] = {"regions": shared.regions, "seconds": shared.seconds, "processors": shared.busy, "same": shared.same}
        reached.append(targets.threads_judged(result["sharing"]))
    show(["", "targets"])
    show(tables.targets_table(reached))
    record["targets"] = [vars(r) for r in reached]
    record["processor_over_clock"] = clock.share
    note = "" if clock.share > 0.9 else ": the machine was busy, times are longer than on an idle one and ratios less certain"
    write(f"\nprocessor time over time on the clock {clock.share:.2f}{note}")
    return result


def main(arguments: list[str]) -> int:
    """The command."""
    parser = argparse.ArgumentParser(description="Times and errors of the kernel, of Clarabel and of the peers, from one run.")
    parser.add_argument("--quick", action="store_true", help="fewer stances and repetitions, under a minute")
    parser.add_argument("--figure", metavar="FILE", help="draw time against contact points and threads")
    parser.add_argument("--json", metavar="FILE", help="write every number")
    parser.add_argument("--only", action="append", choices=KINDS, help="only this kind of work; may be repeated")
    chosen = parser.parse_args(arguments)

    from benchmarks import effort, figure

    result = survey(effort.quick() if chosen.quick else effort.full(), tuple(chosen.only or KINDS))
    if chosen.json:
        Path(chosen.json).write_text(json.dumps(result["record"], indent=1) + "\n")
    if chosen.figure:
        if result["curves"]:
            figure.draw(result["curves"][0], result["sharing"], chosen.figure)
        else:
            print("no figure: --only leaves out growth")
    return 0


if __name__ == "__main__":
    for variable in THREADS:
        os.environ[variable] = "1"
    sys.path[0] = str(Path(__file__).resolve().parents[1])
    sys.exit(main(sys.argv[1:]))
