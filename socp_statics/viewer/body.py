"""What moves: a robot by the shapes and meshes of its links, or as a skeleton where they are few; without a robot struts."""

from __future__ import annotations

import numpy as np

from socp_statics.colours import EDGE, FLAT_PART, ROUND_PART
from socp_statics.contacts import Stance
from socp_statics.postures import Posture
from socp_statics.spatial import Array
from socp_statics.viewer.marks import Frame, Lines, Mark, Solid, path
from socp_statics.viewer.meshes import robot_meshes
from socp_statics.viewer.motion import BODY, still_bodies
from socp_statics.viewer.solids import Surface, ball, box, cylinder, fan, placed, rod

BONE, JOINT = 0.008, 0.014
# seen through, so that the centre of mass and the forces inside are visible
OPACITY = 0.45
SAME = 1e-9


def body_marks(stance: Stance, extent: float) -> list[Mark]:
    """The body of a stance where it stands.

    Args:
        stance: The stance.
        extent: How large the scene is [m].

    Returns:
        A frame for each body that moves as one, named as in `motion.CertifiedMotion.bodies`, and what is fixed to it.
    """
    posture = stance.posture
    frames = [Frame(body_name(name), at.position, at.rotation) for name, at in still_bodies(stance).items()]
    if posture is None:
        return [*frames, *_massless(stance, extent)]
    surfaces = [*_shapes(posture), *_meshes(posture)]
    bones = _skeleton(posture, extent) if len(surfaces) < len(posture.robot.joints) else []
    return [*frames, *surfaces, *bones]


def body_name(joint: str) -> str:
    """The path of the frame of a body."""
    return path("body", joint)


def body_extent(stance: Stance) -> Array:
    """Points that the body reaches to, world axes, shape (n, 3) [m]."""
    return np.vstack([stance.contacts.points_W, stance.com, *(at.position for at in still_bodies(stance).values())])


def _in_joint(posture: Posture, frame: str) -> tuple[str, Array, Array]:
    """The joint that carries a frame of the robot, and the frame's rotation and position in its axes."""
    model = posture.robot.pin_model
    found = model.frames[posture.robot.frame_id(frame)]
    return model.names[found.parentJoint], found.placement.rotation, found.placement.translation


def _shapes(posture: Posture) -> list[Mark]:
    out: list[Mark] = []
    for k, shape in enumerate(posture.robot.shapes):
        joint, R_JF, p_JF = _in_joint(posture, shape.link)
        surface = placed(_primitive(shape.kind, shape.size), R_JF @ shape.rotation, p_JF + R_JF @ shape.position)
        flat = shape.kind == "box"
        out.append(Solid(path("body", joint, f"{shape.link}_{k}"), *surface, FLAT_PART if flat else ROUND_PART, OPACITY, flat))
    return out


def _meshes(posture: Posture) -> list[Mark]:
    out: list[Mark] = []
    for k, (link, surface) in enumerate(robot_meshes(posture.robot)):
        joint, R_JF, p_JF = _in_joint(posture, link)
        out.append(Solid(path("body", joint, f"{link}_mesh_{k}"), *placed(surface, R_JF, p_JF), FLAT_PART, OPACITY))
    return out


def _primitive(kind: str, size: tuple[float, ...]) -> Surface:
    if kind == "box":
        return box(np.array(size))
    return cylinder(*size) if kind == "cylinder" else ball(*size)


def _skeleton(posture: Posture, extent: float) -> list[Mark]:
    """Bones from every joint to those it carries and to where the robot can touch, in axes of the joint."""
    robot, model = posture.robot, posture.robot.pin_model
    ends = [(model.names[model.parents[k]], model.names[k], model.jointPlacements[k].translation) for k in range(2, model.njoints)]
    for frame in robot.frames.values():
        joint, R_JF, p_JF = _in_joint(posture, frame.frame)
        ends.append((joint, f"to_{frame.name}", p_JF + R_JF @ frame.position))
    out: list[Mark] = [Solid(path("body", joint, "joint"), *ball(JOINT * extent), EDGE) for joint in list(model.names)[1:]]
    for joint, name, end in ends:
        if np.linalg.norm(end) > SAME * extent:
            out.append(Solid(path("body", joint, f"bone_{name}"), *rod(np.zeros(3), np.array(end), BONE * extent), ROUND_PART))
    return out


def _massless(stance: Stance, extent: float) -> list[Mark]:
    """A massless body: its own side of every contact; its struts follow the centre of mass."""
    centre = stance.contacts.centre
    out: list[Mark] = []
    for contact in stance.contacts:
        points = contact.points_W - centre
        surface = fan(points) if len(points) > 2 else placed(ball(JOINT * extent), np.eye(3), points.mean(axis=0))
        out.append(Solid(path("body", BODY, f"side_{contact.name}"), *surface, ROUND_PART, opacity=0.8))
    return out


def struts(stance: Stance) -> Lines:
    """Lines from the centre of mass to the contacts of a stance without a robot, in axes of its body."""
    centre = stance.contacts.centre
    ends = np.array([contact.points_W.mean(axis=0) for contact in stance.contacts]) - centre
    starts = np.broadcast_to(stance.com - centre, ends.shape)
    return Lines(path("body", BODY, "struts"), np.stack([starts, ends], axis=1), ROUND_PART, pixels=5.0)
