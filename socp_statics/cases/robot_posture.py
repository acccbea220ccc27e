"""From ``[posture]`` with a robot to the posture itself: the robot loaded, every name checked against it, the kinematics done."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

from socp_statics.cases.dotted import Part, key_text
from socp_statics.cases.robot_statements import generator_statement
from socp_statics.cases.statement import read_statement
from socp_statics.contacts import Stance
from socp_statics.exceptions import InputError
from socp_statics.postures import GENERATORS, Posture
from socp_statics.postures.torque_limits import resolve_torque_limits
from socp_statics.robots import Robot, load_robot
from socp_statics.robots.contact_frame import ContactFrame

UNLIMITED = float("inf")
NOT_FOR_THE_GENERATOR = ("generator", "robot", "gravity", "external_wrenches", "torque_limits", "frames")
Trial = tuple[tuple[Part, ...], Callable[[], Any]]


def read_robot_posture(raw: Mapping[str, Any], folder: Path | None, faults: dict[str, str]) -> tuple[dict[str, Any] | None, Posture | None]:
    """Validate a posture with a robot and make it.

    Args:
        raw: The table ``[posture]`` as TOML reads it; its generator is known.
        folder: Where relative paths of URDFs start; the working directory where there is none.
        faults: Key path -> sentence, added to.

    Returns:
        The table with defaults filled in and the posture; None for what has faults.
    """
    before = len(faults)
    generate = GENERATORS.load(raw["generator"])
    read = read_statement(generator_statement(generate), raw, ("posture",), faults)
    stated = None if read is None else read.stated()
    robot = _read_robot(raw, folder, faults)
    if robot is None:
        return stated, None
    unread = set(raw["frames"]) - set(robot.frames) if isinstance(raw.get("frames"), Mapping) else set()
    for path, trial in _trials(_sound(stated or raw, faults), robot, unread):
        _try(faults, path, trial)
    if stated is None or len(faults) > before:
        return stated, None
    own = {key: value for key, value in stated.items() if key not in NOT_FOR_THE_GENERATOR}
    try:
        return stated, generate(robot, **own)
    except InputError as error:
        _add(faults, ("posture", error.field) if error.field in stated else ("posture",), error)
        return stated, None


def check_torque_limits(stated: Mapping[str, Any], posture: Posture, in_force: bool, faults: dict[str, str]) -> None:
    """Check the table of torque limits as a whole: two patterns on one joint, joints left with placeholders.

    Args:
        stated: The table ``[posture]`` with defaults filled in.
        posture: The posture.
        in_force: Whether the forces have to respect the limits; else placeholders do not matter.
        faults: Key path -> sentence, added to.
    """
    limits = stated.get("torque_limits", {})
    _try(faults, ("torque_limits",), partial(posture.torque_limits, limits if in_force else {"default": UNLIMITED} | limits))


def robot_stance(posture: Posture, stated: Mapping[str, Any], in_force: bool) -> Stance:
    """The stance of a posture with its loads.

    Args:
        posture: The posture.
        stated: The table ``[posture]`` with defaults filled in.
        in_force: Whether the forces have to respect the torque limits.

    Raises:
        InputError: The limits of some joints are placeholders and not overridden.
    """
    limits = stated.get("torque_limits", True) if in_force else False
    return posture.stance(gravity=stated["gravity"], external_wrenches=stated["external_wrenches"], torque_limits=limits)


def _add(faults: dict[str, str], path: tuple[Part, ...], error: InputError) -> None:
    text = key_text(path)
    faults.setdefault(text, f"{text}: {error}")


def _try(faults: dict[str, str], path: tuple[Part, ...], trial: Callable[[], Any]) -> Any:
    """What the trial returns; where it complains, the complaint is added."""
    try:
        return trial()
    except InputError as error:
        _add(faults, ("posture", *path), error)
        return None


def _sound(stated: Mapping[str, Any], faults: Mapping[str, str]) -> dict[str, Any]:
    """The keys, and the entries of tables, that have no fault yet."""

    def faulty(*path: Part) -> bool:
        text = key_text(("posture", *path))
        return any(fault == text or fault.startswith((f"{text}.", f"{text}[")) for fault in faults)

    sound = {}
    for key, value in stated.items():
        if isinstance(value, Mapping) and key_text(("posture", key)) not in faults:
            sound[key] = {name: entry for name, entry in value.items() if not faulty(key, name)}
        elif not faulty(key):
            sound[key] = value
    return sound


def _trials(sound: Mapping[str, Any], robot: Robot, unread: set[str]) -> Iterator[Trial]:
    """Every name and number of the posture that can be judged on its own, with the check that judges it.

    Contacts whose frames are known to be wrong are not blamed again where they are named.
    """
    for number, name in enumerate(sound.get("support", ())):
        if name not in unread:
            yield ("support", number), partial(robot.contact_frame, name)
    angles = sound.get("angles")
    for joint, angle in angles.items() if isinstance(angles, Mapping) else ():
        yield ("angles", joint), partial(robot.angles, {joint: angle})
    for number, wrench in enumerate(sound.get("external_wrenches", ())):
        if "link" in wrench:
            yield ("external_wrenches", number, "link"), partial(robot.frame_id, wrench["link"])
    for key, limit in sound.get("torque_limits", {}).items():
        # the default keeps placeholders of other joints out of the judgement of this entry
        yield ("torque_limits", key), partial(resolve_torque_limits, robot, {"default": UNLIMITED} | {key: limit})


def _read_robot(raw: Mapping[str, Any], folder: Path | None, faults: dict[str, str]) -> Robot | None:
    """The robot with the frames that could be read, or None."""
    name = raw.get("robot")
    if not isinstance(name, str) or not name:
        return None
    robot = _try(faults, ("robot",), partial(_loaded, name, folder, _content(name, folder)))
    if robot is None or not isinstance(raw.get("frames"), Mapping):
        return robot
    sound = _sound(raw, faults).get("frames", {})
    frames = {contact: _read_frame(contact, keys, robot, faults) for contact, keys in sound.items()}
    return robot.with_frames({contact: frame for contact, frame in frames.items() if frame is not None})


def _read_frame(contact: str, keys: Mapping[str, Any], robot: Robot, faults: dict[str, str]) -> ContactFrame | None:
    at = ("frames", contact)
    try:
        frame = ContactFrame.from_statement(contact, keys)
        robot.frame_id(frame.frame, contact)
    except InputError as error:
        _add(faults, ("posture", *at, error.field) if error.field else ("posture", *at), error)
        return None
    return frame


def _content(name: str, folder: Path | None) -> bytes | None:
    """The bytes of a URDF, so that a robot is loaded once for all cases of a sweep and again when the file has changed."""
    path = (folder or Path()) / name
    try:
        return path.read_bytes() if path.is_file() else None
    except OSError:
        return None


@lru_cache(maxsize=16)
def _loaded(name: str, folder: Path | None, content: bytes | None) -> Robot:
    return load_robot(name, folder=folder)
