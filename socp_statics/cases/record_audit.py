"""Is a record what it says it is? Its case is the one that was hashed, its numbers belong together; the first that does not is named."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from socp_statics.cases.dotted import key_text
from socp_statics.cases.hashing import case_hash, plain
from socp_statics.cases.problem import Problem, problem_from_tables
from socp_statics.cases.solve import shown_stance
from socp_statics.certificates import Motion, motion_certificate
from socp_statics.certificates.contact_motion import contact_motion, least_work
from socp_statics.certificates.force_repair import force_slacks
from socp_statics.certificates.scaled_forces import scaled_forces
from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import ContactSet, Stance
from socp_statics.exceptions import InputError, StaticsError
from socp_statics.spatial import Array
from socp_statics.statics import StaticsData, assemble

SAME = 1e-9
HELD = 1e-6
NEEDED = ("problem", "model", "hash", "case", "verdict", "cone", "margin", "forces", "wrenches", "certificate")
VERDICTS = ("stable", "unstable", "undecided")


def refute(where: str, what: str) -> StaticsError:
    """The error of a record that does not hold, naming where."""
    return StaticsError(f"{where}: {what}", name=where, field=where)


def stated_problem(record: Mapping[str, Any]) -> Problem:
    """The problem that a record answers.

    Args:
        record: A record.

    Raises:
        InputError: It is no whole record, or its case is no problem.
        StaticsError: Its case is not the one that was hashed.
    """
    missing = [key for key in NEEDED if key not in record]
    if missing:
        raise InputError(f"a record is expected, {missing[0]!r} is missing", name="record", field=missing[0])
    case = record["case"]
    if not isinstance(case, Mapping) or not isinstance(case.get("generated"), Mapping) or record["verdict"] not in VERDICTS:
        what = "verdict" if isinstance(case, Mapping) and "generated" in case else "case.generated"
        raise InputError(f"a record is expected, its {what} is not one of a record", name="record", field=what)
    problem = problem_from_tables({key: value for key, value in case.items() if key != "generated"}, str(record["problem"]), label="case")
    from socp_statics.engines import ENGINES

    digest = None if problem.robot_posture is None else problem.robot_posture.robot.digest
    if record["hash"] not in {case_hash(problem.stated(), engine, digest) for engine in ENGINES.names()}:
        raise refute("hash", "the case, or the robot, is not the one that was hashed")
    if record["model"] != problem.model:
        raise refute("model", f"the case asks for {problem.model!r}, the record says {record['model']!r}")
    if record["cone"] != plain(problem.cone.as_record()):
        raise refute("cone", f"the case asks for {problem.cone.as_record()}, the record says {record['cone']}")
    return problem


def recorded_stance(problem: Problem, record: Mapping[str, Any]) -> Stance:
    """The stance of a record with the very numbers of the record.

    Args:
        problem: Its problem.
        record: The record.

    Raises:
        StaticsError: Its generated contacts, centre of mass or mass are not those of the case.
    """
    stance, generated = shown_stance(problem, record), record["case"]["generated"]
    made = plain({"contacts": [c.statement() for c in stance.contacts], "com": stance.com, "mass": stance.mass})
    scale = max(1.0, stance.contacts.size, float(np.abs(stance.contacts.points_W).max()))
    for key, value in made.items():
        _same(generated.get(key), value, ("case", "generated", key), SAME * scale)
    contacts = [
        contact.placed(np.array(entry["position"]), np.array(entry["rotation"]), float(entry.get("friction", 0.0)))
        for contact, entry in zip(stance.contacts, generated["contacts"], strict=True)
    ]
    return replace(stance, contacts=ContactSet(contacts), com=generated["com"], mass=generated["mass"])


def _same(given: Any, made: Any, path: tuple[str | int, ...], tolerance: float) -> None:
    """Compare nested values, numbers within a tolerance; the first difference is named by its path."""
    where = key_text(path)
    if isinstance(made, Mapping) and isinstance(given, Mapping):
        for key in {**made, **given}:
            _same(given.get(key), made.get(key), (*path, key), tolerance)
    elif isinstance(made, list) and isinstance(given, list) and len(made) == len(given):
        for i, (a, b) in enumerate(zip(given, made, strict=True)):
            _same(a, b, (*path, i), tolerance)
    elif isinstance(made, float | int) and isinstance(given, float | int) and not isinstance(given, bool):
        if not abs(given - made) <= tolerance * max(1.0, abs(made)):
            raise refute(where, f"{made!r} follows from the case, the record says {given!r}")
    elif given != made:
        raise refute(where, f"{made!r} follows from the case, the record says {given!r}")


def recorded_forces(record: Mapping[str, Any], stance: Stance, cone: ConeChoice, data: StaticsData) -> Array | None:
    """Scaled forces of a record, after a look at whether they are what the record says they are.

    Args:
        record: The record.
        stance: Its stance.
        cone: Its cones.
        data: Its arrays.

    Returns:
        Scaled unknowns, shape (nx,), or None where there are no forces.

    Raises:
        StaticsError: They act elsewhere, do not balance, leave their cones, or their sums are not the wrenches.
    """
    entries = record["forces"]
    if not entries:
        return None
    points = [(c.name, p) for c in stance.contacts for p in (c.points_W if c.unilateral else c.position[None])]
    if [e.get("contact") for e in entries] != [name for name, _ in points]:
        raise refute("forces", "one for each contact point, in their order, is expected")
    size = stance.contacts.size
    for i, (entry, (_, point)) in enumerate(zip(entries, points, strict=True)):
        if not np.allclose(entry["point"], point, rtol=SAME, atol=SAME * size):
            raise refute(f"forces[{i}].point", "the force does not act at its contact point")
    force, moment = (np.array([e.get(key) or [0.0] * 3 for e in entries], dtype=float) for key in ("force", "moment"))
    names = [name for name, _ in points]
    x = scaled_forces(data, names, force, moment)
    # forces that show how far torque limits fall short do not respect them
    held = data if record["verdict"] == "stable" else assemble(replace(stance, torque_limits=None))
    check_held(held, cone, x, "forces")
    _check_sums(record, stance, data, names, force, moment)
    return x


def check_held(data: StaticsData, cone: ConeChoice, x: Array, where: str) -> None:
    """Refute forces that miss the balance or leave a cone, bound or limit by more than 1e-6 W."""
    missing = float(np.linalg.norm(data.wrench_map @ x + data.load))
    size = max(1.0, float(np.abs(x).max(initial=0.0)))
    if not missing <= HELD * size:
        raise refute(where, f"the forces miss the balance by {missing * data.units.force:.3g} N")
    slacks = force_slacks(data, cone, x)
    if len(slacks.values) and float(slacks.values.min()) < -HELD * size:
        worst = int(np.argmin(slacks.values))
        over = -float(slacks.values[worst]) * data.units.force
        raise refute(where, f"the forces of {slacks.owners[worst]} are outside what they may be by {over:.3g} N")


def _check_sums(record: Mapping[str, Any], stance: Stance, data: StaticsData, names: Sequence[str], force: Array, moment: Array) -> None:
    points = np.array([entry["point"] for entry in record["forces"]], dtype=float)
    limit = HELD * data.units.force * max(1.0, float(np.abs(force).max(initial=0.0)) / data.units.force)
    for i, entry in enumerate(record["wrenches"]):
        mine = np.array([name == entry["contact"] for name in names])
        if not mine.any():
            raise refute(f"wrenches[{i}].contact", f"there is no contact {entry['contact']!r}")
        arms = points[mine] - stance.contacts[entry["contact"]].position
        sums = {"force": force[mine].sum(axis=0), "moment": (np.cross(arms, force[mine]) + moment[mine]).sum(axis=0)}
        for key, scale in (("force", 1.0), ("moment", data.units.length)):
            if not np.abs(np.array(entry[key]) - sums[key]).max() <= limit * scale:
                raise refute(f"wrenches[{i}].{key}", "it is not the sum of the point forces")


def recorded_motion(record: Mapping[str, Any], cone: ConeChoice, data: StaticsData, motion: Motion) -> Motion:
    """The motion of a record's certificate, after a look at whether it is one.

    Raises:
        StaticsError: Admissible forces can prevent it, or its power is another.
    """
    if motion_certificate(data, cone, motion) is None:
        raise refute("certificate", "admissible forces and torques can prevent the motion, or the load does not drive it")
    found = float(least_work(data, motion, contact_motion(data, cone, motion)).power) * data.units.force
    power = record["certificate"]["power"]
    # what drives a motion is a difference of larger numbers
    if not abs(power - found) <= HELD * (data.units.force + abs(found)):
        raise refute("certificate.power", f"it is {found:.6g} W, the record says {power!r}")
    return motion


def check_edge(data: StaticsData, cone: ConeChoice, motion: Motion, where: str) -> None:
    """Refute a motion behind an outer edge that admissible forces can prevent.

    Args:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        motion: The motion, scaled.
        where: What to call it.

    Raises:
        StaticsError: They can, by more than rounding.
    """
    size = max(float(np.abs(motion.twist).max()), float(np.abs(motion.joints).max(initial=0.0)))
    if not least_work(data, motion, contact_motion(data, cone, motion)).violation <= HELD * size:
        raise refute(where, "admissible forces and torques can prevent the motion")


def check_polygons(region: Mapping[str, Any]) -> None:
    """Refute areas that are not those of the polygons.

    Args:
        region: The entry of a record.

    Raises:
        StaticsError: An area, or the gap between them, is another.
    """
    if region["kind"] not in ("polygon", "unbounded") or len(region["inner"]) < 3:
        return
    areas = {}
    for key in ("inner", "outer"):
        x, y = (np.array(region[key], dtype=float) - region[key][0]).T
        areas[key] = 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
        if not abs(region[f"{key}_area"] - areas[key]) <= SAME * max(abs(areas[key]), float(np.ptp(x) * np.ptp(y))):
            raise refute(f"region.{key}_area", f"it is {areas[key]:.9g} m^2, the record says {region[f'{key}_area']!r}")
    gap = (areas["outer"] - areas["inner"]) / areas["outer"] if areas["outer"] else 0.0
    if not abs(region["relative_gap"] - max(gap, 0.0)) <= HELD:
        raise refute("region.relative_gap", f"it is {gap:.3g}, the record says {region['relative_gap']!r}")
