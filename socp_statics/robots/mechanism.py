"""The mechanism a URDF describes, checked link by link and joint by joint before Pinocchio reads it.

Pinocchio names the element of a broken URDF on the C++ error stream only.
"""

from __future__ import annotations

from xml.etree import ElementTree

from socp_statics.registry import nearest
from socp_statics.robots.urdf_text import UrdfText

MOVING = ("revolute", "continuous", "prismatic")
INERTIA = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def check_mechanism(urdf: UrdfText) -> None:
    """Check everything that the statics of the robot depends on; shapes, transmissions and the like are not looked at.

    Args:
        urdf: A URDF.

    Raises:
        InputError: An element is wrong; the sentence names the file and the element.
    """
    links, joints = _named(urdf, "link"), _named(urdf, "joint")
    if not links:
        raise urdf.wrong("<robot>", "has no link, at least one is expected")
    if not sum(_checked_mass(urdf, f"link '{name}'", link) for name, link in links.items()) > 0:
        raise urdf.wrong("<robot>", "has no link with a mass > 0, at least one is expected")
    for name, joint in joints.items():
        _check_joint(urdf, f"joint '{name}'", joint, links)
    for name, joint in joints.items():
        _check_mimic(urdf, name, joint, joints)
    _check_tree(urdf, links, joints)


def _named(urdf: UrdfText, kind: str) -> dict[str, ElementTree.Element]:
    named: dict[str, ElementTree.Element] = {}
    for number, tag in enumerate(urdf.root.findall(kind), start=1):
        name = tag.get("name", "")
        if not name.strip():
            raise urdf.wrong(f"{kind} number {number}", "has no name, one is expected")
        if name in named:
            raise urdf.wrong(f"{kind} '{name}'", "is defined twice, names must be unique")
        named[name] = tag
    return named


def _checked_mass(urdf: UrdfText, element: str, link: ElementTree.Element) -> float:
    inertial = link.find("inertial")
    if inertial is None:
        return 0.0
    mass, inertia = inertial.find("mass"), inertial.find("inertia")
    if mass is None or inertia is None:
        raise urdf.wrong(element, f"has an <inertial> without <{'mass' if mass is None else 'inertia'}>")
    if (value := float(urdf.numbers(element, mass, "value", 1)[0])) < 0:
        raise urdf.wrong(element, f"has a negative mass, a mass >= 0 is expected, got {value:g} kg")
    urdf.placement(element, inertial)
    for key in INERTIA:
        urdf.numbers(element, inertia, key, 1)
    return value


def _check_joint(urdf: UrdfText, element: str, joint: ElementTree.Element, links: dict[str, ElementTree.Element]) -> None:
    kind = joint.get("type")
    if kind not in (*MOVING, "fixed"):
        added = ", the free-flying base is added by the toolkit" if kind == "floating" else ""
        got = "no type" if kind is None else f"{kind!r}"
        raise urdf.wrong(element, f"must be of type {', '.join(MOVING)} or fixed, got {got}{added}")
    for end in ("parent", "child"):
        tag = joint.find(end)
        link = None if tag is None else tag.get("link")
        if link is None:
            raise urdf.wrong(element, f"has no {end} link")
        if link not in links:
            raise urdf.wrong(element, f"has the {end} link '{link}', which is not defined{nearest(link, links)}")
    urdf.placement(element, joint)
    if kind == "fixed":
        return
    axis = joint.find("axis")
    if axis is not None and not urdf.numbers(element, axis, "xyz", 3).any():
        raise urdf.wrong(element, "has an <axis> of length zero")
    limit = joint.find("limit")
    if limit is None:
        if kind == "continuous":
            return
        raise urdf.wrong(element, f"has no <limit>, a {kind} joint needs lower, upper, effort and velocity")
    for key in ("effort", "velocity"):
        if (value := urdf.numbers(element, limit, key, 1)[0]) < 0:
            raise urdf.wrong(element, f"has a negative {key} limit, a number >= 0 is expected, got {value:g}")
    lower, upper = (urdf.numbers(element, limit, key, 1, default="0")[0] for key in ("lower", "upper"))
    if lower > upper and kind != "continuous":
        raise urdf.wrong(element, f"has a lower limit {lower:g} above its upper limit {upper:g}")


def _check_mimic(urdf: UrdfText, name: str, joint: ElementTree.Element, joints: dict[str, ElementTree.Element]) -> None:
    mimic, element = joint.find("mimic"), f"joint '{name}'"
    if mimic is None or joint.get("type") == "fixed":
        return
    leader = mimic.get("joint")
    if leader is None or leader not in joints or leader == name:
        hint = nearest(leader, [other for other in joints if other != name]) if leader and leader != name else ""
        raise urdf.wrong(element, f"must mimic another joint, got {leader!r}{hint}")
    if joints[leader].get("type") not in ("revolute", "prismatic") or joints[leader].find("mimic") is not None:
        what = "is a mimic joint itself" if joints[leader].find("mimic") is not None else f"is {joints[leader].get('type')}"
        raise urdf.wrong(element, f"must mimic a revolute or prismatic joint that leads, but '{leader}' {what}")
    for key, default in (("multiplier", "1"), ("offset", "0")):
        urdf.numbers(element, mimic, key, 1, default=default)


def ends(joint: ElementTree.Element) -> tuple[str, str]:
    """Names of the parent and the child link of a joint that was checked."""
    parent, child = (joint.findall(end)[0].get("link", "") for end in ("parent", "child"))
    return parent, child


def _check_tree(urdf: UrdfText, links: dict[str, ElementTree.Element], joints: dict[str, ElementTree.Element]) -> None:
    above: dict[str, tuple[str, str]] = {}
    for name, joint in joints.items():
        parent, child = ends(joint)
        if child in above:
            raise urdf.wrong(f"link '{child}'", f"is the child of two joints, '{above[child][1]}' and '{name}', one is expected")
        above[child] = (parent, name)
    for link in links:
        path = [link]
        while path[-1] in above and above[path[-1]][0] not in path:
            path.append(above[path[-1]][0])
        if path[-1] in above:
            parent, joint_name = above[path[-1]]
            loop = [*path[path.index(parent) :], parent][::-1]
            raise urdf.wrong(f"joint '{joint_name}'", f"closes a loop of links ({' -> '.join(loop)}), a tree is expected")
    roots = [link for link in links if link not in above]
    if len(roots) > 1:
        names = ", ".join(f"'{root}'" for root in roots[:4]) + (", ..." if len(roots) > 4 else "")
        raise urdf.wrong(f"link '{roots[1]}'", f"has no joint to a parent, but only one root link is expected, got {len(roots)}: {names}")


def bare_text(urdf: UrdfText, first: frozenset[str] = frozenset()) -> str:
    """The URDF reduced to what was checked: inertias and joints.

    Args:
        urdf: A URDF that was checked.
        first: Joints to be ordered before their siblings: Pinocchio orders siblings by name, and theirs get a leading "!".

    Returns:
        XML for Pinocchio.
    """
    robot = ElementTree.Element("robot", name=urdf.root.get("name") or "robot")
    for kind, kept in (("link", ("inertial",)), ("joint", ("origin", "parent", "child", "axis", "limit", "mimic"))):
        for tag in urdf.root.findall(kind):
            bare = ElementTree.SubElement(robot, kind, tag.attrib)
            if kind == "joint" and tag.get("name") in first:
                bare.set("name", f"!{tag.get('name')}")
            for part in kept:
                if (found := tag.find(part)) is None or (part == "mimic" and tag.get("type") == "fixed"):
                    continue
                copy = ElementTree.SubElement(bare, part, found.attrib)
                copy.extend(found)
                if part == "mimic" and found.get("joint") in first:
                    copy.set("joint", f"!{found.get('joint')}")
    return ElementTree.tostring(robot, encoding="unicode")


def above_leaders(urdf: UrdfText) -> frozenset[str]:
    """The joints that others mimic, and all joints between them and the root."""
    joints = {joint.get("name", ""): joint for joint in urdf.root.findall("joint")}
    over = {ends(joint)[1]: name for name, joint in joints.items()}
    found = set()
    for joint in joints.values():
        if (mimic := joint.find("mimic")) is None or joint.get("type") == "fixed":
            continue
        name: str | None = mimic.get("joint", "")
        while name is not None and name not in found:
            found.add(name)
            name = over.get(ends(joints[name])[0])
    return frozenset(found)
