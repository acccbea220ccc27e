"""Verifies a proof that a robot in contact can, or cannot, stand: exact arithmetic, standard library only, runs alone.

    python verify_proof.py proof.json      exit status 0: verified, 1: refuted, with where, 2: cannot be read

All numbers are rationals, "p/q". The theorem is about the model that the statement of the file spells out, and nothing else of the file
is taken on trust: a contact force is R f, R the matrix of the file (columns t1, t2, n; of floats, so not orthonormal to the last bit) and f
in |(fx, fy)| <= mu fz, or in a pyramid with the face normals and the factor of the slope of the file; it acts at position + R (x, y, 0). A
motion is a twist of the robot, with the rates of the joints whose torque is limited; forces and motions meet in the power, so that
cones and their duals need no square roots. "Stable": forces that balance the load, each in its cone, bound and limit.
"Unstable": a motion on which the load does more work than admissible forces and torques can take up. "Region": forces at every inner corner,
and motions whose half-planes, two at a time, imply every outer edge.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Sequence
from fractions import Fraction
from itertools import combinations, product
from typing import Any, NamedTuple

SCHEMA = 1
SHIFT = Fraction(1, 10**12)
DISPLACED = Fraction(1, 10**8)
RATIONAL = re.compile(r"-?\d{1,4000}(/\d{1,4000})?")
COMPONENTS = ("fx", "fy", "fz", "mx", "my", "mz")
TYPES = ("point", "surface", "line", "soft_finger", "frictionless_point", "frictionless_surface", "handle")
BALANCE = ("forces along x", "forces along y", "forces along z", "moments about x", "moments about y", "moments about z")
CONES = ("exact", "inscribed", "circumscribed")
Vector = Sequence[Fraction]


class Refuted(Exception):
    """A number of the file does not prove what the file says; the message begins with where."""


class Unreadable(Exception):
    """The file is no proof file."""


class Contact(NamedTuple):
    """A contact of the statement; ``units``: the wrenches [force; moment about the position] of its components, point by point."""

    name: str
    position: Vector
    points: list[Vector]
    units: list[list[Vector]]
    friction: Fraction
    torsion: Fraction
    box: bool
    bounds: tuple[Fraction, Fraction | None] | None
    limits: list[tuple[Fraction | None, Fraction | None]] | None


class Joints(NamedTuple):
    """The joints whose torque is limited: ``passive - sum J' F`` stays inside the limits."""

    names: list[str]
    limits: list[tuple[Fraction | None, Fraction | None]]
    passive: Vector
    jacobians: dict[str, list[Vector]]


class Statement(NamedTuple):
    """What the theorem is about: contacts, their cone, the load (moment about the world's origin), the joints."""

    contacts: list[Contact]
    cone: str
    faces: list[Vector]
    slope: Fraction
    com: Vector
    weight: Vector
    force: Vector
    moment: Vector
    joints: Joints

    def load(self, com: Vector) -> list[Fraction]:
        """The impressed wrench about the world's origin with the centre of mass somewhere."""
        return add(add(self.force, self.weight) + add(self.moment, cross(com, self.weight)))

    def size_squared(self) -> Fraction:
        """Square of the largest distance between contact points, 1 if there is none."""
        points = [p for contact in self.contacts for p in contact.points]
        return max((dot(d, d) for a, b in combinations(points, 2) for d in [sub(a, b)]), default=Fraction(0)) or Fraction(1)


class Motion(NamedTuple):
    """A twist (angular velocity, velocity of the point at the world's origin), rates of the joints, least normal velocities of contacts."""

    linear: Vector
    angular: Vector
    joints: Vector
    grips: dict[str, Fraction]


def dot(a: Vector, b: Vector) -> Fraction:
    """Scalar product."""
    return sum((x * y for x, y in zip(a, b, strict=True) if x and y), Fraction(0))


def add(*vectors: Vector) -> list[Fraction]:
    """Sum of vectors."""
    return [sum(parts, Fraction(0)) for parts in zip(*vectors, strict=True)]


def sub(a: Vector, b: Vector) -> list[Fraction]:
    """Difference of two vectors."""
    return [x - y for x, y in zip(a, b, strict=True)]


def cross(a: Vector, b: Vector) -> list[Fraction]:
    """Vector product."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def inside(value: Fraction, low: Fraction | None, high: Fraction | None) -> bool:
    """Whether a number lies between two ends, of which either may be missing."""
    return (low is None or value >= low) and (high is None or value <= high)


def numbers(value: Any, *shape: int | None, at: str, empty: bool = False) -> Any:
    """Rationals, nested as the shape says (None: any length); ``empty`` allows null for a bound that is not there."""
    if not shape:
        if value is None and empty:
            return None
        if not isinstance(value, str) or not RATIONAL.fullmatch(value) or re.search("/0+$", value):
            raise Unreadable(f'{at}: a rational number "p/q" is expected, got {str(value)[:40]!r}')
        return Fraction(value)
    if not isinstance(value, list) or (shape[0] is not None and len(value) != shape[0]):
        raise Unreadable(f"{at}: a list{'' if shape[0] is None else f' of {shape[0]}'} is expected")
    return [numbers(entry, *shape[1:], at=f"{at}[{i}]", empty=empty) for i, entry in enumerate(value)]


def entry(table: Any, key: str, at: str) -> Any:
    """The value of a key that has to be there."""
    if not isinstance(table, dict) or key not in table:
        raise Unreadable(f"{at}: a table with {key!r} is expected")
    return table[key]


def read_contact(table: Any, at: str) -> Contact:
    """A contact with what it transmits: friction, normal and torsional components at its points, or those of a handle."""
    name, kind = entry(table, "name", at), entry(table, "type", at)
    if not isinstance(name, str) or kind not in TYPES:
        raise Unreadable(f"{at}: a name and a type of {', '.join(TYPES)} are expected")
    position = numbers(entry(table, "position", at), 3, at=f"{at}.position")
    R = numbers(entry(table, "rotation", at), 3, 3, at=f"{at}.rotation")
    axes, zero = [[row[i] for row in R] for i in range(3)], [Fraction(0)] * 3
    if kind == "handle":
        words = entry(table, "transmits", at)
        if not isinstance(words, list) or len(set(map(str, words))) < len(words) or any(word not in COMPONENTS for word in words):
            raise Unreadable(f"{at}.transmits: components of {', '.join(COMPONENTS)} are expected")
        ends = numbers(entry(table, "limits", at), len(words), 2, at=f"{at}.limits", empty=True)
        units = [[[*axes[i], *zero] if i < 3 else [*zero, *axes[i - 3]] for i in map(COMPONENTS.index, words)]]
        return Contact(name, position, [position], units, Fraction(0), Fraction(0), False, None, [(lo, hi) for lo, hi in ends])
    places = numbers(entry(table, "points", at), None, 2, at=f"{at}.points")
    arms = [add([x * a for a in axes[0]], [y * a for a in axes[1]]) for x, y in places]
    friction = Fraction(0) if kind.startswith("frictionless") else numbers(entry(table, "friction", at), at=f"{at}.friction")
    torsion, box = Fraction(0), table.get("shape") == "box"
    if kind == "soft_finger" and friction:
        torsion = numbers(entry(table, "torsional_friction", at), at=f"{at}.torsional_friction")
    if friction < 0 or torsion < 0 or not arms:
        raise Unreadable(f"{at}: points and coefficients of friction >= 0 are expected")
    units = [[[*a, *cross(arm, a)] for a in (axes if friction else axes[2:])] + ([[*zero, *axes[2]]] if torsion else []) for arm in arms]
    bounds = None
    if table.get("normal_force") is not None:
        lo, hi = numbers(table["normal_force"], 2, at=f"{at}.normal_force", empty=True)
        if lo is None or lo < 0 or (hi is not None and hi < lo):
            raise Unreadable(f"{at}.normal_force: 0 <= lo <= hi is expected")
        bounds = (lo, hi)
    return Contact(name, position, [add(position, arm) for arm in arms], units, friction, torsion, box, bounds, None)


def read_statement(table: Any) -> Statement:
    """The statement of a proof file."""
    at = "statement"
    contacts = [read_contact(one, f"{at}.contacts[{i}]") for i, one in enumerate(entry(table, "contacts", at))]
    if len({contact.name for contact in contacts}) < len(contacts):
        raise Unreadable(f"{at}.contacts: names must be unique")
    cone = entry(table, "cone", at)
    kind = entry(cone, "kind", f"{at}.cone")
    if kind not in CONES:
        raise Unreadable(f"{at}.cone.kind: one of {', '.join(CONES)} is expected")
    faces = [] if kind == "exact" else numbers(entry(cone, "faces", f"{at}.cone"), None, 2, at=f"{at}.cone.faces")
    slope = Fraction(1) if kind == "exact" else numbers(entry(cone, "slope", f"{at}.cone"), at=f"{at}.cone.slope")
    mass, gravity = numbers(entry(table, "mass", at), at=f"{at}.mass"), numbers(entry(table, "gravity", at), 3, at=f"{at}.gravity")
    force, moment = [Fraction(0)] * 3, [Fraction(0)] * 3
    for i, wrench in enumerate(entry(table, "external_wrenches", at)):
        here = f"{at}.external_wrenches[{i}]"
        f, m, p = (numbers(entry(wrench, key, here), 3, at=f"{here}.{key}") for key in ("force", "moment", "point"))
        force, moment = add(force, f), add(moment, m, cross(p, f))
    joints = Joints([], [], [], {})
    if table.get("joints") is not None:
        stated, here = table["joints"], f"{at}.joints"
        names = entry(stated, "names", here)
        n = len(names)
        limits = [(lo, hi) for lo, hi in numbers(entry(stated, "limits", here), n, 2, at=f"{here}.limits", empty=True)]
        table_of = entry(stated, "jacobians", here)
        jacobians = {c.name: numbers(entry(table_of, c.name, f"{here}.jacobians"), 6, n, at=f"{here}.jacobians.{c.name}") for c in contacts}
        joints = Joints(names, limits, numbers(entry(stated, "passive", here), n, at=f"{here}.passive"), jacobians)
    com = numbers(entry(table, "com", at), 3, at=f"{at}.com")
    return Statement(contacts, kind, faces, slope, com, [mass * g for g in gravity], force, moment, joints)


def read_forces(statement: Statement, table: Any, at: str) -> dict[str, list[Vector]]:
    """Components of the forces in contact frames, by contact and point."""
    out = {}
    for c in statement.contacts:
        points = entry(table, c.name, at)
        if not isinstance(points, list) or len(points) != len(c.units):
            raise Unreadable(f"{at}.{c.name}: forces at {len(c.units)} points are expected")
        out[c.name] = [numbers(f, len(u), at=f"{at}.{c.name}[{i}]") for i, (f, u) in enumerate(zip(points, c.units, strict=True))]
    return out


def read_motion(statement: Statement, table: Any, at: str) -> Motion:
    """A motion of the file."""
    linear, angular, point = (numbers(entry(table, key, at), 3, at=f"{at}.{key}") for key in ("linear", "angular", "point"))
    joints = numbers(entry(table, "joints", at), len(statement.joints.names), at=f"{at}.joints")
    grips = entry(table, "grips", at)
    return Motion(sub(linear, cross(angular, point)), angular, joints, {name: numbers(entry(grips, name, at), at=f"{at}.grips.{name}") for name in grips})


def slide(statement: Statement, friction: Fraction, v: Vector) -> Fraction | None:
    """Largest ``v . f`` over the polygon ``n_j . f <= friction slope``: v as a combination >= 0 of two neighbouring face normals."""
    if not any(v):
        return Fraction(0)
    for a, b in zip(statement.faces, [*statement.faces[1:], statement.faces[0]], strict=True):
        area = a[0] * b[1] - a[1] * b[0]
        if area > 0:
            first, second = (v[0] * b[1] - v[1] * b[0]) / area, (a[0] * v[1] - a[1] * v[0]) / area
            if first >= 0 and second >= 0:
                return friction * statement.slope * (first + second)
    return None


def in_cone(statement: Statement, contact: Contact, f: Vector) -> bool:
    """Whether the components of a force at a point lie in its cone."""
    if not contact.friction:
        return f[0] >= 0
    mu, spin = contact.friction, abs(f[3]) if contact.torsion else Fraction(0)
    boxed = contact.box or statement.cone == "circumscribed"
    if f[2] < 0 or (boxed and spin > contact.torsion * f[2]):
        return False
    ratio = Fraction(0) if boxed or not contact.torsion else spin / contact.torsion
    if statement.cone == "exact":
        return f[0] ** 2 + f[1] ** 2 + (mu * ratio) ** 2 <= (mu * f[2]) ** 2
    slope = mu * statement.slope
    return all(dot(n, f[:2]) + slope * ratio <= slope * f[2] for n in statement.faces)


def in_dual(statement: Statement, contact: Contact, u: Vector, grip: Fraction) -> bool:
    """Whether no force of the cone at a point can do less work on the velocity u than its normal component times ``grip``."""
    if not contact.friction:
        return u[0] >= grip
    mu, normal = contact.friction, u[2] - grip
    twist = contact.torsion * abs(u[3]) if contact.torsion else Fraction(0)
    boxed = contact.box or statement.cone == "circumscribed"
    if statement.cone == "exact":
        rest, more = (normal - twist, Fraction(0)) if boxed else (normal, twist)
        return rest >= 0 and mu**2 * (u[0] ** 2 + u[1] ** 2) + more**2 <= rest**2
    most = slide(statement, mu, [-u[0], -u[1]])
    return most is not None and normal >= (most + twist if boxed else max(most, twist))


def check_forces(statement: Statement, forces: dict[str, list[Vector]], com: Vector, at: str) -> None:
    """Forces balance the load with the centre of mass at ``com``, and each is admissible."""
    force, moment = (statement.load(com)[i : i + 3] for i in (0, 3))
    torques = list(statement.joints.passive)
    for contact in statement.contacts:
        wrench, here = [Fraction(0)] * 6, f"{at}.{contact.name}"
        for i, (f, units) in enumerate(zip(forces[contact.name], contact.units, strict=True)):
            wrench = add(wrench, *([value * x for x in unit] for value, unit in zip(f, units, strict=True)))
            if contact.limits is None and not in_cone(statement, contact, f):
                raise Refuted(f"{here}[{i}]: the force is outside its cone")
        if contact.bounds is not None:
            lo, hi = contact.bounds
            total = sum((f[2 if contact.friction else 0] for f in forces[contact.name]), Fraction(0))
            if not inside(total, lo, hi):
                raise Refuted(f"{here}: the normal force is outside its bounds")
        for i, (low, high) in enumerate(contact.limits or ()):
            if not inside(forces[contact.name][0][i], low, high):
                raise Refuted(f"{here}[0][{i}]: the component is outside its limits")
        force, moment = add(force, wrench[:3]), add(moment, wrench[3:], cross(contact.position, wrench[:3]))
        if torques:
            torques = sub(torques, [dot(column, wrench) for column in zip(*statement.joints.jacobians[contact.name], strict=True)])
    for row, rest in zip(BALANCE, force + moment, strict=True):
        if rest:
            raise Refuted(f"{at}: {row} do not balance, {float(rest):.3g} is left")
    for name, torque, (low, high) in zip(statement.joints.names, torques, statement.joints.limits, strict=True):
        if not inside(torque, low, high):
            raise Refuted(f"{at}: the torque of {name} is outside its limits")


def least_work(statement: Statement, motion: Motion, at: str) -> Fraction:
    """Least power on a motion of everything but the load: of contacts, handles, and the passive torques that limited joints carry."""
    work = -dot(statement.joints.passive, motion.joints)
    ends = list(zip(statement.joints.names, motion.joints, statement.joints.limits, strict=True))
    for contact in statement.contacts:
        twist = [*add(motion.linear, cross(motion.angular, contact.position)), *motion.angular]
        if motion.joints:
            twist = add(twist, [dot(row, motion.joints) for row in statement.joints.jacobians[contact.name]])
        velocities = [[dot(unit, twist) for unit in units] for units in contact.units]
        if contact.limits is not None:
            ends += [(contact.name, rate, limits) for rate, limits in zip(velocities[0], contact.limits, strict=True)]
            continue
        grip = motion.grips.get(contact.name, Fraction(0))
        lo, hi = contact.bounds or (Fraction(0), None)
        if grip < 0 and hi is None:
            raise Refuted(f"{at}.grips.{contact.name}: nothing bounds the normal force of this contact, so it must be >= 0")
        for i, u in enumerate(velocities):
            if not in_dual(statement, contact, u, grip):
                raise Refuted(f"{at}: forces at {contact.name}[{i}] can prevent the motion")
        work += (lo if grip >= 0 or hi is None else hi) * grip
    for name, rate, (low, high) in ends:
        end = low if rate > 0 else high
        if rate and end is None:
            raise Refuted(f"{at}: {name} can prevent the motion, nothing limits it that way")
        work += end * rate if end is not None else 0
    return work


def check_region(statement: Statement, region: Any, at: str) -> tuple[float, float]:
    """Every inner corner is in balance where it was moved to, every outer edge is implied where it was moved to, both within 1e-8 of size.

    Returns:
        By how much at most corners and edges were moved [m].
    """
    inner, outer = (numbers(entry(region, key, at), None, 2, at=f"{at}.{key}") for key in ("inner", "outer"))
    corners, edges = entry(region, "corners", at), entry(region, "edges", at)
    if len(corners) != len(inner) or len(outer) < 3:
        raise Unreadable(f"{at}: forces for each inner corner, and three outer corners, are expected")
    most, pulled, pushed = DISPLACED**2 * statement.size_squared(), Fraction(0), Fraction(0)
    for i, (corner, given) in enumerate(zip(corners, inner, strict=True)):
        here = f"{at}.corners[{i}]"
        place = numbers(entry(corner, "com", here), 2, at=f"{here}.com")
        moved = sub(place, given)
        pulled = max(pulled, dot(moved, moved))
        if pulled > most:
            raise Refuted(f"{here}.com: the corner was moved by more than 1e-8 of the size")
        check_forces(statement, read_forces(statement, entry(corner, "forces", here), f"{here}.forces"), [*place, statement.com[2]], here)
    planes = [half_plane(statement, read_motion(statement, edge, f"{at}.edges[{i}]"), f"{at}.edges[{i}]") for i, edge in enumerate(edges)]
    if region.get("square") is not None:
        for axis, (low, high) in zip(([Fraction(1), 0], [0, Fraction(1)]), numbers(region["square"], 2, 2, at=f"{at}.square"), strict=True):
            planes += [(axis, high), ([-axis[0], -axis[1]], -low)]
    for i, (a, b) in enumerate(zip(outer, [*outer[1:], outer[0]], strict=True)):
        normal = [b[1] - a[1], a[0] - b[0]]
        offset = furthest(planes, normal) if any(normal) else Fraction(0)
        if offset is None:
            raise Refuted(f"{at}.outer[{i}]: no two of the motions bound the region beyond this edge")
        beyond = max(offset - dot(normal, a), Fraction(0)) ** 2 / (dot(normal, normal) or 1)
        pushed = max(pushed, beyond)
        if pushed > most:
            raise Refuted(f"{at}.outer[{i}]: the motions bound the region only further out than 1e-8 of the size")
    return float(pulled) ** 0.5, float(pushed) ** 0.5


def half_plane(statement: Statement, motion: Motion, at: str) -> tuple[Vector, Fraction]:
    """The half-plane ``a . c <= b`` of centres of mass that a motion leaves: beyond it, the load drives the motion and nothing prevents it."""
    origin = statement.load([Fraction(0), Fraction(0), statement.com[2]])
    work = dot(origin, [*motion.linear, *motion.angular]) + least_work(statement, motion, at)
    return cross(statement.weight, motion.angular)[:2], -work


def furthest(planes: list[tuple[Vector, Fraction]], normal: Vector) -> Fraction | None:
    """Least bound of ``normal . c`` that two half-planes ``a . c <= b`` imply, of those whose normals are nearest on either side."""
    found = []
    # floats only choose which half-planes to try
    nearest = sorted(planes, key=lambda plane: -float(dot(plane[0], normal)) / (float(dot(plane[0], plane[0])) or 1.0) ** 0.5)
    sides: tuple[list[Any], list[Any]] = ([], [])
    for a, b in nearest:
        sides[a[0] * normal[1] > a[1] * normal[0]].append((a, b))
    for (a, b), (c, d) in product(sides[0][:3], sides[1][:3]):
        area = a[0] * c[1] - a[1] * c[0]
        if area:
            first, second = (normal[0] * c[1] - normal[1] * c[0]) / area, (a[0] * normal[1] - a[1] * normal[0]) / area
            if first >= 0 and second >= 0:
                found.append(first * b + second * d)
    return min(found, default=None)


def verify(document: Any) -> str:
    """Check a proof.

    Args:
        document: The proof file as JSON reads it.

    Returns:
        What is proved, in one sentence.

    Raises:
        Refuted: It does not prove what it says; the message begins with where.
        Unreadable: It is no proof file.
    """
    if entry(document, "schema", "the file") != SCHEMA:
        raise Unreadable(f"schema: a proof file with schema {SCHEMA} is expected")
    claim, reason = entry(document, "claim", "the file"), document.get("reason")
    if claim not in ("stable", "unstable", "undecided"):
        raise Unreadable("claim: 'stable', 'unstable' or 'undecided' is expected")
    statement = read_statement(entry(document, "statement", "the file"))
    proved = []
    if claim == "stable":
        shift = numbers(entry(document, "shift", "the file"), 3, at="shift")
        if dot(shift, shift) > SHIFT**2 * statement.size_squared():
            raise Refuted("shift: the centre of mass was moved by more than 1e-12 of the size")
        check_forces(statement, read_forces(statement, entry(document, "forces", "the file"), "forces"), add(statement.com, shift), "forces")
        proved.append("stable" + (" with the centre of mass moved by less than 1e-12 of the size" if any(shift) else ""))
    elif claim == "unstable":
        motion = read_motion(statement, entry(document, "motion", "the file"), "motion")
        power = dot(statement.load(statement.com), [*motion.linear, *motion.angular]) + least_work(statement, motion, "motion")
        if power <= 0:
            raise Refuted(f"motion: load, forces and torques need not do work on it, their least power is {float(power):.3g} W")
        proved.append("unstable")
    if document.get("region") is not None:
        check_region(statement, document["region"], "region")
        proved.append("region between its polygons")
    if not proved:
        raise Refuted(f"claim: nothing is claimed, the verdict is undecided ({reason})")
    return "proved " + ", ".join(proved)


def read(path: str) -> Any:
    """A proof file.

    Raises:
        Unreadable: It is not there, a folder, or no JSON.
    """
    try:
        with open(path, encoding="utf-8") as file:
            return json.load(file)
    except (OSError, ValueError, RecursionError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise Unreadable(f"a proof (JSON) is expected ({reason})") from error


def main(arguments: list[str]) -> int:
    """Verify one file: 0 verified, 1 refuted, 2 unreadable."""
    if len(arguments) != 1:
        print("usage: verify_proof.py FILE", file=sys.stderr)
        return 2
    try:
        print(f"{arguments[0]}: {verify(read(arguments[0]))}")
    except Refuted as error:
        print(f"{arguments[0]}: {error}", file=sys.stderr)
        return 1
    except Unreadable as error:
        print(f"{arguments[0]}: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
