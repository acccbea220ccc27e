"""A motion in words: which contact holds, slides or opens, and what the robot does as a whole."""

from __future__ import annotations

import numpy as np

from socp_statics.certificates.contact_motion import ContactMotion, Motion, frame_velocities
from socp_statics.spatial import Array
from socp_statics.statics.statics_data import StaticsData

REST = 1e-6
STILL = 1e-3
GENTLE = 1e-3
MOST_JOINTS = 3
AXES = {"+x": (1, 0, 0), "-x": (-1, 0, 0), "+y": (0, 1, 0), "-y": (0, -1, 0), "+z": (0, 0, 1), "-z": (0, 0, -1)}
FLOOR_WORDS = ("front", "front left", "left", "back left", "back", "back right", "right", "front right")


def direction_words(v: Array) -> str:
    """A direction as an axis where it nearly is one, else as a unit vector."""
    unit = v / np.linalg.norm(v)
    word, axis = max(AXES.items(), key=lambda item: float(unit @ np.array(item[1], dtype=float)))
    if float(unit @ np.array(axis, dtype=float)) > 0.995:
        return word
    return "(" + ", ".join(f"{0.0 if abs(c) < 0.005 else c:.2f}" for c in unit) + ")"


def _speed(motion: ContactMotion) -> float:
    """Speed against which contact velocities are judged: that of the fastest point, unless all are at rest but for rounding."""
    return max(float(np.abs(motion.velocity).max(initial=0.0)), STILL)


def point_states(motion: ContactMotion) -> list[str]:
    """What each contact point does: "holds", "slides" or "opens"."""
    scale = _speed(motion)
    states = []
    for u, spin, grip in zip(motion.velocity / scale, motion.spin / scale, motion.grip / scale, strict=True):
        if np.linalg.norm(u) <= REST and spin <= REST:
            states.append("holds")
        elif grip <= REST and max(np.linalg.norm(u[:2]), spin) > REST:
            states.append("slides")
        else:
            states.append("opens")
    return states


def _free_slides(data: StaticsData, whole: Motion) -> dict[str, Array]:
    """Handles whose position moves along what they do not transmit, with its velocity, shape (3,), in world axes.

    Rates that nothing resists are not zero to rounding where they are meant to be, so these are judged against `GENTLE`.
    """
    handles = set(range(len(data.names))) - set(data.contact_of_point.tolist())
    if not handles:
        return {}
    frames = frame_velocities(data, whole)
    com = whole.twist[:3] + np.cross(whole.twist[3:], data.com)
    fastest = max(float(np.linalg.norm(frames, axis=1).max(initial=0.0)), float(np.linalg.norm(com)), STILL)
    out = {}
    for k in sorted(handles):
        resisted = data.component_of_handle[data.contact_of_handle == k]
        unresisted = data.rotation[k].T @ frames[k]
        unresisted[resisted[resisted < 3]] = 0.0
        if np.linalg.norm(unresisted) > GENTLE * fastest:
            out[data.names[k]] = frames[k]
    return out


def contact_states(data: StaticsData, whole: Motion, motion: ContactMotion) -> dict[str, str]:
    """What each contact does: it holds while one of its points holds, else slides while one slides, else opens.

    A handle holds only where its own position stays, whatever it transmits.
    """
    points = point_states(motion)
    free = _free_slides(data, whole)
    scale = max(_speed(motion), float(np.abs(motion.handle).max(initial=0.0)))
    out = {}
    for k, name in enumerate(data.names):
        mine = {points[i] for i in np.flatnonzero(data.contact_of_point == k)}
        grips = np.abs(motion.handle[data.contact_of_handle == k]) / scale
        if not mine:
            out[name] = "slides" if name in free or (grips.size and grips.max() > REST) else "holds"
        else:
            out[name] = next(word for word in ("holds", "slides", "opens") if word in mine)
    return out


def side_words(R_WC: Array, outward_C: Array) -> str:
    """Which side of a contact a direction in its plane points to: as seen by the robot on floors, by height on walls."""
    if abs(R_WC[2, 2]) > 0.7:
        angle = np.arctan2(outward_C[1], outward_C[0])
        return FLOOR_WORDS[int(np.rint(angle / (np.pi / 4))) % 8]
    world = R_WC[:, :2] @ (outward_C / np.linalg.norm(outward_C))
    if abs(world[2]) > 0.7:
        return "upper" if world[2] > 0 else "lower"
    return f"{'+' if outward_C[int(np.argmax(np.abs(outward_C)))] > 0 else '-'}t{1 + int(np.argmax(np.abs(outward_C)))}"


def _pivots(data: StaticsData, states: list[str]) -> dict[str, str]:
    """Contacts that tip: "the right edge of left_foot", where some points hold and others open."""
    out = {}
    for k, name in enumerate(data.names):
        mine = np.flatnonzero(data.contact_of_point == k)
        rest = [i for i in mine if states[i] == "holds"]
        if not rest or len(rest) == len(mine):
            continue
        R = data.rotation[k]
        centre = data.point[mine].mean(axis=0)
        outward = (data.point[rest].mean(axis=0) - centre) @ R[:, :2]
        what = "edge" if len(rest) > 1 else "end" if len(mine) == 2 else "corner"
        side = side_words(R, outward) + " " if np.linalg.norm(outward) > 0 else ""
        out[name] = f"the {side}{what} of {name}"
    return out


def _yielding(data: StaticsData, motion: ContactMotion) -> list[str]:
    """Contacts that are pushed in against the upper bound of their normal force."""
    scale = _speed(motion)
    pushed = motion.grip < -REST * scale
    return [data.names[k] for k in data.bounded if pushed[data.contact_of_point == k].any()]


def _and(words: list[str]) -> str:
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " and " + words[-1]


def _giving_way(data: StaticsData, motion: Motion) -> str:
    """Joints that turn against their torque limits, the fastest first; equal ones in the order of the robot."""
    torques, rates = data.torques, motion.joints
    fastest = float(np.abs(rates).max(initial=0.0))
    if fastest <= REST * max(1.0, float(np.abs(motion.twist).max())):
        return ""
    turning = [int(k) for k in np.argsort(-np.round(np.abs(rates) / fastest, 6), kind="stable") if abs(rates[k]) > GENTLE * fastest]
    scale = data.units.force * data.units.length
    named = [f"{torques.names[k]} ({scale * torques.limits[k, 0 if rates[k] > 0 else 1]:.3g} N m)" for k in turning[:MOST_JOINTS]]
    more = f" and {len(turning) - MOST_JOINTS} more" if len(turning) > MOST_JOINTS else ""
    verb = "give" if len(turning) > 1 else "gives"
    return f"{_and(named) if not more else ', '.join(named) + more} {verb} way at the torque limit"


def reading(data: StaticsData, whole: Motion, motion: ContactMotion) -> str:
    """The motion in one sentence that names joints and contacts.

    Args:
        data: The stance's arrays.
        whole: Twist and joint rates.
        motion: The motion at the contacts.

    Returns:
        For example "tips about the right edge of right_foot, left_foot opens".
    """
    joints = _giving_way(data, whole)
    contacts = _at_contacts(data, whole, motion, bool(joints))
    return ", ".join(part for part in (joints, contacts) if part)


def _at_contacts(data: StaticsData, whole: Motion, motion: ContactMotion, with_joints: bool) -> str:
    com_velocity = whole.twist[:3] + np.cross(whole.twist[3:], data.com)
    turning = float(np.linalg.norm(whole.twist[3:])) > 1e-6
    states = point_states(motion)
    words = contact_states(data, whole, motion)
    free = _free_slides(data, whole)
    pivots = _pivots(data, states)
    holding = [name for name, word in words.items() if word == "holds" and name not in pivots]
    sliding = [name for name, word in words.items() if word == "slides"]
    yielding = _yielding(data, motion)
    opening = [name for name, word in words.items() if word == "opens" and name not in yielding]
    parts = []
    if with_joints and not pivots and len(holding) == len(words):
        return ""
    if pivots:
        parts.append("tips about " + _and([*pivots.values(), *holding]))
    elif holding and turning:
        through = "the line through " + _and(holding) if len(holding) > 1 else holding[0]
        parts.append(f"turns about {through}, which cannot resist it" if len(holding) == len(words) else f"tips about {through}")
    elif holding:
        parts.append(f"{_and(holding)} hold" + ("s" if len(holding) == 1 else ""))
    directions: dict[str, list[str]] = {}
    for name in sliding:
        if name in free:
            rates = motion.handle[data.contact_of_handle == data.names.index(name)]
            freely = "" if np.abs(rates).max(initial=0.0) > REST * _speed(motion) else " freely"
            how = f"slides{freely} along {direction_words(free[name])}"
        else:
            how = _sliding(data, motion, states, name)
        directions.setdefault(how, []).append(name)
    falling = len(sliding) > 1 and not free and not pivots and not holding and com_velocity[2] < -0.5 * np.linalg.norm(com_velocity)
    if falling:
        parts.append(f"falls between {_and(sliding)}")
    parts += [f"{how} at {_and(names)}" for how, names in directions.items()]
    if yielding:
        parts.append(f"{_and(yielding)} {'give' if len(yielding) > 1 else 'gives'} way at the bound of the normal force")
    if opening:
        alone = not parts
        verb = "open" if len(opening) > 1 else "opens"
        leaves = ""
        if alone and np.linalg.norm(com_velocity) > 0:
            leaves = f"{'falls' if com_velocity[2] < 0 else 'leaves'} along {direction_words(com_velocity)}: "
        parts.append(f"{leaves}{_and(opening)} {verb}")
    return ", ".join(parts)


def _sliding(data: StaticsData, motion: ContactMotion, states: list[str], name: str) -> str:
    """How a contact slides: along a direction in world axes, or by spinning about its normal."""
    k = data.names.index(name)
    mine = [i for i in np.flatnonzero(data.contact_of_point == k) if states[i] == "slides"]
    if not mine:
        rates = np.zeros(6)
        rates[data.component_of_handle[data.contact_of_handle == k]] = motion.handle[data.contact_of_handle == k]
        linear, angular = data.rotation[k] @ rates[:3], data.rotation[k] @ rates[3:]
        if np.linalg.norm(linear) > REST * np.linalg.norm(angular):
            return f"slides along {direction_words(linear)}"
        return f"turns about {direction_words(angular)}"
    u_t = motion.velocity[mine, :2]
    mean = u_t.mean(axis=0)
    if np.linalg.norm(mean) < 1e-3 * max(np.abs(u_t).max(), motion.spin[mine].max()):
        return "spins about the normal"
    return f"slides along {direction_words(data.rotation[k][:, :2] @ mean)}"
