"""Verifies a proof that a robot in contact can, or cannot, stand: exact arithmetic, standard library only, runs alone.

    python verify_proof.py proof.json      exit status 0: verified, 1: refuted, with where, 2: cannot be read

All numbers are rationals, "p/q". The theorem is about the model that the statement spells out; nothing else of the file is taken on trust.
A contact force is R f, R the matrix of the file (columns t1, t2, n; floats, not orthonormal to the last bit) and f in |(fx, fy)| <= mu fz,
or in a pyramid with the face normals and the slope factor of the file; it acts at position + R (x, y, 0). Forces and motions meet in
the power, so that cones and their duals need no roots. "Stable": forces that balance the load, each in its cone, bound and limit.
"Unstable": a motion (a twist, with rates of limited joints) on which the load does more work than forces and torques can take up.
"Region": forces at every inner corner, and motions whose half-planes, two at a time, imply every outer edge, of a segment or a point
its ends too; "empty": a motion that the load drives wherever the centre of mass is.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Sequence
from fractions import Fraction
from itertools import combinations, product
from math import atan2, tau
from typing import Any, NamedTuple

SCHEMA = 1
SHIFT = Fraction(1, 10**12)
DISPLACED = Fraction(1, 10**8)
RATIONAL = re.compile(r"-?\d{1,4000}(/0*[1-9]\d{0,4000})?")
COMPONENTS = ("fx", "fy", "fz", "mx", "my", "mz")
TYPES = ("point", "surface", "line", "soft_finger", "frictionless_point", "frictionless_surface", "handle")
ZERO = [Fraction(0)] * 3
Vector = Sequence[Fraction]
Ends = tuple[Fraction | None, Fraction | None]


class Refuted(Exception):
    """The file does not prove what it says; the message begins with where."""


class Unreadable(Exception):
    """The file is no proof file."""


class Place(NamedTuple):
    """A value of the file, and where it is."""

    value: Any
    at: str = ""

    def __call__(self, key: str) -> Place:
        """The entry of a key that has to be there."""
        if not isinstance(self.value, dict) or key not in self.value:
            raise Unreadable(f"{self.at or 'the file'}: a table with {key!r} is expected")
        return Place(self.value[key], f"{self.at}.{key}" if self.at else key)

    def each(self, count: int | None = None) -> list[Place]:
        """The entries of a list."""
        if not isinstance(self.value, list) or (count is not None and len(self.value) != count):
            raise Unreadable(f"{self.at}: a list{'' if count is None else f' of {count}'} is expected")
        return [Place(entry, f"{self.at}[{i}]") for i, entry in enumerate(self.value)]

    def numbers(self, *shape: int | None) -> Any:
        """Rationals, nested as the shape says (None: any length)."""
        if shape:
            return [entry.numbers(*shape[1:]) for entry in self.each(shape[0])]
        if not isinstance(self.value, str) or not RATIONAL.fullmatch(self.value):
            raise Unreadable(f'{self.at}: a rational number "p/q" is expected, got {str(self.value)[:40]!r}')
        return Fraction(self.value)

    def ends(self) -> Ends:
        """A lower and an upper end, of which either may be null."""
        low, high = (None if end.value is None else end.numbers() for end in self.each(2))
        if low is not None and high is not None and low > high:
            raise Unreadable(f"{self.at}: lower <= upper is expected")
        return low, high

    def word(self, words: Sequence[str] = ()) -> str:
        """A word, one of some."""
        if not isinstance(self.value, str) or (words and self.value not in words):
            raise Unreadable(f"{self.at}: {'one of ' + ', '.join(words) if words else 'a name'} is expected")
        return self.value


class Contact(NamedTuple):
    """A contact of the statement; ``units``: the wrenches [force; moment about the position] of its components, point by point."""

    name: str
    position: Vector
    points: list[Vector]
    units: list[list[Vector]]
    friction: Fraction = Fraction(0)
    torsion: Fraction = Fraction(0)
    box: bool = False
    bounds: Ends | None = None
    limits: list[Ends] | None = None


class Statement(NamedTuple):
    """What the theorem is about: contacts, cones, load (moment about the world's origin), joints whose torque passive - J'F is limited."""

    contacts: list[Contact]
    cone: str
    faces: list[Vector]
    slope: Fraction
    com: Vector
    weight: Vector
    force: Vector
    moment: Vector
    joints: list[str]
    limits: list[Ends]
    passive: Vector
    jacobians: dict[str, list[Vector]]

    def load(self, com: Vector) -> list[Fraction]:
        """The impressed wrench about the world's origin with the centre of mass somewhere."""
        return add(self.force, self.weight) + add(self.moment, cross(com, self.weight))

    def size_squared(self) -> Fraction:
        """Square of the largest distance between contact points, 1 if there is none."""
        points = [p for contact in self.contacts for p in contact.points]
        return max((dot(d, d) for a, b in combinations(points, 2) for d in [sub(a, b)]), default=Fraction(0)) or Fraction(1)


class Motion(NamedTuple):
    """A twist (velocity of the point at the world's origin), rates of the joints, least normal velocities of bounded contacts."""

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
    return add(a, [-v for v in b])


def cross(a: Vector, b: Vector) -> list[Fraction]:
    """Vector product."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def inside(value: Fraction, ends: Ends) -> bool:
    """Whether a number lies between two ends, of which either may be missing."""
    return (ends[0] is None or value >= ends[0]) and (ends[1] is None or value <= ends[1])


def read_contact(table: Place) -> Contact:
    """A contact with what it transmits: friction, normal and torsional components at its points, or those of a handle."""
    name, kind, position = table("name").word(), table("type").word(TYPES), table("position").numbers(3)
    axes: list[list[Fraction]] = [list(axis) for axis in zip(*table("rotation").numbers(3, 3), strict=True)]
    if kind == "handle":
        words = [COMPONENTS.index(word.word(COMPONENTS)) for word in table("transmits").each()]
        if len(set(words)) < len(words):
            raise Unreadable(f"{table.at}.transmits: a component is named twice")
        held: list[Vector] = [[*axes[i], *ZERO] if i < 3 else [*ZERO, *axes[i - 3]] for i in words]
        return Contact(name, position, [position], [held], limits=[ends.ends() for ends in table("limits").each(len(words))])
    arms = [add([x * a for a in axes[0]], [y * a for a in axes[1]]) for x, y in table("points").numbers(None, 2)]
    friction = Fraction(0) if kind.startswith("frictionless") else table("friction").numbers()
    torsion, box = Fraction(0), False
    if kind == "soft_finger" and friction:
        torsion, box = table("torsional_friction").numbers(), table("shape").word(("elliptic", "box")) == "box"
    if friction < 0 or torsion < 0 or not arms:
        raise Unreadable(f"{table.at}: points and coefficients of friction >= 0 are expected")
    spin: list[Vector] = [[*ZERO, *axes[2]]] if torsion else []
    units = [[*([*a, *cross(arm, a)] for a in axes[0 if friction else 2 :]), *spin] for arm in arms]
    bounds = table("normal_force").ends() if table.value.get("normal_force") is not None else None
    if bounds is not None and (bounds[0] is None or bounds[0] < 0):
        raise Unreadable(f"{table.at}.normal_force: 0 <= lower <= upper is expected")
    return Contact(name, position, [add(position, arm) for arm in arms], units, friction, torsion, box, bounds)


def read_statement(table: Place) -> Statement:
    """The statement of a proof file."""
    contacts = [read_contact(one) for one in table("contacts").each()]
    if len({contact.name for contact in contacts}) < max(len(contacts), 1):
        raise Unreadable(f"{table.at}.contacts: at least one contact, with unique names, is expected")
    kind = table("cone")("kind").word(("exact", "inscribed", "circumscribed"))
    faces = [] if kind == "exact" else table("cone")("faces").numbers(None, 2)
    slope = Fraction(1) if kind == "exact" else table("cone")("slope").numbers()
    mass, force, moment = table("mass").numbers(), ZERO, ZERO
    for wrench in table("external_wrenches").each():
        f, m, p = (wrench(key).numbers(3) for key in ("force", "moment", "point"))
        force, moment = add(force, f), add(moment, m, cross(p, f))
    joints = table("joints")
    names = [name.word() for name in joints("names").each()]
    n, limits = len(names), [ends.ends() for ends in joints("limits").each(len(names))]
    jacobians = {c.name: joints("jacobians")(c.name).numbers(6, n) for c in contacts} if names else {}
    weight, passive = [mass * g for g in table("gravity").numbers(3)], joints("passive").numbers(n)
    return Statement(contacts, kind, faces, slope, table("com").numbers(3), weight, force, moment, names, limits, passive, jacobians)


def read_forces(statement: Statement, table: Place) -> dict[str, list[Vector]]:
    """Components of the forces in contact frames, by contact and point."""
    points = {c.name: zip(table(c.name).each(len(c.units)), c.units, strict=True) for c in statement.contacts}
    return {name: [f.numbers(len(units)) for f, units in pairs] for name, pairs in points.items()}


def read_motion(statement: Statement, table: Place) -> Motion:
    """A motion of the file."""
    linear, angular, point = (table(key).numbers(3) for key in ("linear", "angular", "point"))
    grips = {c.name: table("grips")(c.name).numbers() for c in statement.contacts if c.bounds is not None}
    return Motion(sub(linear, cross(angular, point)), angular, table("joints").numbers(len(statement.joints)), grips)


def between(a: Vector, b: Vector, v: Vector) -> tuple[Fraction, Fraction] | None:
    """The shares >= 0 of two plane vectors in a third, None where it is not between them."""
    area = a[0] * b[1] - a[1] * b[0]
    shares = ((v[0] * b[1] - v[1] * b[0]) / area, (a[0] * v[1] - a[1] * v[0]) / area) if area else None
    return shares if shares and min(shares) >= 0 else None


def in_cone(statement: Statement, contact: Contact, f: Vector) -> bool:
    """Whether the components of a force at a point lie in its cone."""
    if not contact.friction:
        return f[0] >= 0
    slope, spin = contact.friction * statement.slope, abs(f[3]) if contact.torsion else Fraction(0)
    boxed = contact.box or statement.cone == "circumscribed" or not contact.torsion
    if f[2] < 0 or (boxed and spin > contact.torsion * f[2]):
        return False
    ratio = Fraction(0) if boxed else spin / contact.torsion
    if statement.cone == "exact":
        return f[0] ** 2 + f[1] ** 2 + (slope * ratio) ** 2 <= (slope * f[2]) ** 2
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
    # the most work against the sliding over n_j . f <= mu slope: its direction as a combination >= 0 of two neighbouring normals
    shares = (between(a, b, [-u[0], -u[1]]) for a, b in zip(statement.faces, statement.faces[1:] + statement.faces[:1], strict=True))
    most = next((mu * statement.slope * (first + second) for first, second in filter(None, shares)), None)
    return most is not None and normal >= (most + twist if boxed else max(most, twist))


def check_forces(statement: Statement, forces: dict[str, list[Vector]], com: Vector, at: str) -> None:
    """Forces balance the load with the centre of mass at ``com``, and each is admissible."""
    force, moment = (statement.load(com)[i : i + 3] for i in (0, 3))
    torques = list(statement.passive)
    for contact in statement.contacts:
        wrench, here = ZERO + ZERO, f"{at}.{contact.name}"
        for i, (f, units) in enumerate(zip(forces[contact.name], contact.units, strict=True)):
            wrench = add(wrench, *([value * x for x in unit] for value, unit in zip(f, units, strict=True)))
            if contact.limits is None and not in_cone(statement, contact, f):
                raise Refuted(f"{here}[{i}]: the force is outside its cone")
        total = sum((f[2 if contact.friction else 0] for f in forces[contact.name]), Fraction(0))
        if contact.bounds is not None and not inside(total, contact.bounds):
            raise Refuted(f"{here}: the normal force is outside its bounds")
        if not all(inside(value, ends) for value, ends in zip(forces[contact.name][0], contact.limits or (), strict=False)):
            raise Refuted(f"{here}: a component is outside its limits")
        force, moment = add(force, wrench[:3]), add(moment, wrench[3:], cross(contact.position, wrench[:3]))
        if torques:
            torques = sub(torques, [dot(column, wrench) for column in zip(*statement.jacobians[contact.name], strict=True)])
    for row, rest in zip(COMPONENTS, force + moment, strict=True):
        if rest:
            raise Refuted(f"{at}: the forces do not balance the load, {float(rest):.3g} of {row} is left")
    for name, torque, ends in zip(statement.joints, torques, statement.limits, strict=True):
        if not inside(torque, ends):
            raise Refuted(f"{at}: the torque of {name} is outside its limits")


def least_work(statement: Statement, motion: Motion, at: str) -> Fraction:
    """Least power on a motion of everything but the load: of contacts, handles, limited torques, less the passive torques."""
    work = -dot(statement.passive, motion.joints)
    ends = list(zip(statement.joints, motion.joints, statement.limits, strict=True))
    for contact in statement.contacts:
        twist = [*add(motion.linear, cross(motion.angular, contact.position)), *motion.angular]
        if motion.joints:
            twist = add(twist, [dot(row, motion.joints) for row in statement.jacobians[contact.name]])
        velocities = [[dot(unit, twist) for unit in units] for units in contact.units]
        if contact.limits is not None:
            ends += [(contact.name, rate, limits) for rate, limits in zip(velocities[0], contact.limits, strict=True)]
            continue
        grip = motion.grips.get(contact.name, Fraction(0))
        end = (contact.bounds or (Fraction(0), None))[grip < 0]
        if end is None:
            raise Refuted(f"{at}.grips.{contact.name}: nothing bounds the normal force of this contact, so it must be >= 0")
        if not all(in_dual(statement, contact, u, grip) for u in velocities):
            raise Refuted(f"{at}: forces at {contact.name} can prevent the motion")
        work += end * grip
    for name, rate, (low, high) in ends:
        end = low if rate > 0 else high
        if rate and end is None:
            raise Refuted(f"{at}: {name} can prevent the motion, nothing limits it that way")
        work += end * rate if end is not None else 0
    return work


def check_region(statement: Statement, region: Place) -> tuple[float, float]:
    """Every inner corner is in balance, every outer edge is implied, moved by at most 1e-8 of the size; by how much is returned [m]."""
    inner, outer = region("inner").numbers(None, 2), region("outer").numbers(None, 2)
    most, pulled, pushed = DISPLACED**2 * statement.size_squared(), Fraction(0), Fraction(0)
    for corner, given in zip(region("corners").each(len(inner)), inner, strict=True):
        moved = sub(place := corner("com").numbers(2), given)
        pulled = max(pulled, dot(moved, moved))
        if pulled > most:
            raise Refuted(f"{corner.at}.com: the corner was moved by more than 1e-8 of the size")
        check_forces(statement, read_forces(statement, corner("forces")), [*place, statement.com[2]], corner.at)
    planes = [half_plane(statement, read_motion(statement, edge), edge.at) for edge in region("edges").each()]
    if not outer and not any(b < 0 and not any(a) for a, b in planes):
        raise Refuted(f"{region.at}.edges: no motion is driven wherever the centre of mass is")
    if region.value.get("square") is not None:
        (left, right), (low, high) = region("square").numbers(2, 2)
        square = sides([[left, low], [right, low], [right, high], [left, high]], f"{region.at}.square")
        planes += [(normal, dot(normal, corner)) for normal, corner in square]
    for i, (normal, a) in enumerate(sides(outer, f"{region.at}.outer")):
        offset = furthest(planes, normal) if any(normal) else dot(normal, a)
        if offset is not None:
            pushed = max(pushed, max(offset - dot(normal, a), Fraction(0)) ** 2 / (dot(normal, normal) or 1))
        if offset is None or pushed > most:
            raise Refuted(f"{region.at}.outer[{i}]: no two of the motions bound the region within 1e-8 of the size of this edge")
    return float(pulled) ** 0.5, float(pushed) ** 0.5


def sides(outer: list[Vector], at: str) -> list[tuple[Vector, Vector]]:
    """Outward normals, each with a corner, whose half-planes leave the hull of the corners: of a polygon, a segment, a point or none."""
    if len(outer) > 2:
        edges = list(zip(outer, outer[1:] + outer[:1], strict=True))
        if sum(a[0] * b[1] - a[1] * b[0] for a, b in edges) <= 0:
            raise Unreadable(f"{at}: a polygon with an area, counter-clockwise, is expected")
        return [([b[1] - a[1], a[0] - b[0]], a) for a, b in edges]
    x, y = sub(outer[-1], outer[0]) if outer and outer[-1] != outer[0] else [Fraction(1), Fraction(0)]
    return [([x, y], outer[-1]), ([-x, -y], outer[0]), ([-y, x], outer[0]), ([y, -x], outer[0])] if outer else []


def half_plane(statement: Statement, motion: Motion, at: str) -> tuple[Vector, Fraction]:
    """The half-plane ``a . c <= b`` of centres of mass that a motion leaves: beyond it, the load drives what nothing prevents."""
    origin = statement.load([Fraction(0), Fraction(0), statement.com[2]])
    work = dot(origin, [*motion.linear, *motion.angular]) + least_work(statement, motion, at)
    return cross(statement.weight, motion.angular)[:2], -work


def furthest(planes: list[tuple[Vector, Fraction]], normal: Vector) -> Fraction | None:
    """Least bound of ``normal . c`` that two half-planes ``a . c <= b`` imply; angles, floats, only choose which ones to try."""
    turn = [(atan2(a[1], a[0]) - atan2(normal[1], normal[0])) % tau for a, _ in planes]
    order = sorted(range(len(planes)), key=turn.__getitem__)
    pairs = [(planes[i], planes[j]) for i, j in product([*order[:3], *order[-1:]], [*order[:1], *order[-3:]])]
    found = [(between(a, c, normal), b, d) for (a, b), (c, d) in pairs]
    return min((shares[0] * b + shares[1] * d for shares, b, d in found if shares), default=None)


def verify(document: Any) -> str:
    """What a proof file, as JSON reads it, proves, in one sentence; raises Refuted where it does not, Unreadable where it is none."""
    file = Place(document)
    if file("schema").value != SCHEMA:
        raise Unreadable(f"schema: a proof file with schema {SCHEMA} is expected")
    claim, statement, proved = file("claim").word(("stable", "unstable", "undecided")), read_statement(file("statement")), []
    if claim == "stable":
        shift = file("shift").numbers(3)
        if dot(shift, shift) > SHIFT**2 * statement.size_squared():
            raise Refuted("shift: the centre of mass was moved by more than 1e-12 of the size")
        check_forces(statement, read_forces(statement, file("forces")), add(statement.com, shift), "forces")
        proved.append("stable" + (" with the centre of mass moved by less than 1e-12 of the size" if any(shift) else ""))
    elif claim == "unstable":
        normal, offset = half_plane(statement, read_motion(statement, file("motion")), "motion")
        power = dot(normal, statement.com[:2]) - offset
        if power <= 0:
            raise Refuted(f"motion: load, forces and torques need not do work on it, their least power is {float(power):.3g} W")
        proved.append("unstable")
    if document.get("region") is not None:
        check_region(statement, file("region"))
        kind = ("empty", "a point", "a segment")[len(file("region").value["outer"]) :][:1] or ("between its polygons",)
        proved.append(f"region {kind[0]}" + (" in its square" if file("region").value.get("square") is not None else ""))
    if not proved:
        raise Refuted(f"claim: nothing is claimed, the verdict is undecided ({document.get('reason')})")
    return "proved " + ", ".join(proved)


def main(arguments: list[str]) -> int:
    """Verify one file: 0 verified, 1 refuted, 2 unreadable."""
    path = arguments[0] if len(arguments) == 1 else "usage: verify_proof.py FILE"
    try:
        with open(path, encoding="utf-8") as file:
            print(f"{path}: {verify(json.load(file))}")
        return 0
    except (Refuted, Unreadable, OverflowError, OSError, ValueError, RecursionError) as error:
        refuted = isinstance(error, Refuted | OverflowError)
        print(f"{path}: {'' if refuted else 'a proof (JSON) is expected, '}{error}", file=sys.stderr)
        return 1 if refuted else 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
