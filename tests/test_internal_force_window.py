"""The internal-force window: closed forms, its ends checked from outside, torque limits, the set of two directions, wrong input."""

import json

import numpy as np
import pytest
from random_postures import robot

import socp_statics as ss
from socp_statics.cli import main
from socp_statics.contacts import ContactSet, FrictionlessSurfaceContact, PointContact, Stance, SurfaceContact
from socp_statics.exceptions import InputError
from socp_statics.optimization.null_directions import null_direction
from socp_statics.optimization.wrench_reserve import wrench_reserve
from socp_statics.statics import assemble

UP, SOLE = (0, 0, 1), [[-0.049, -0.0315], [0.049, -0.0315], [0.049, 0.0315], [-0.049, 0.0315]]
MASS = 6.2431648
HALF = MASS * 9.81 / 2
FAST = ("clarabel", "cvxpy")
FEET = ["right_foot", "left_foot"]
SETTINGS = {"engine": FAST}


def roof(roll, friction, com=(0.0, 0.0, 0.24)):
    feet = [
        SurfaceContact(name, (0, side * 0.039, 0), rpy=(side * roll, 0, 0), friction=friction, vertices=SOLE)
        for name, side in (("right_foot", -1), ("left_foot", 1))
    ]
    return Stance(ContactSet(feet), com, MASS)


def limits_on_a_slope(roll, friction):
    """Horizontal force on half the weight so that the resultant stays in the cone about the normal: tan(roll -+ atan mu)."""
    return HALF * np.tan(roll - np.arctan(friction)), HALF * np.tan(roll + np.arctan(friction))


@pytest.mark.parametrize(("roll", "friction"), [(0.0, 0.5), (np.deg2rad(15), 0.2), (np.deg2rad(15), 0.1), (np.deg2rad(25), 0.3)])
@pytest.mark.parametrize("others", ["fixed", "free"])
def test_the_window_on_a_roof_in_closed_form(roll, friction, others):
    window = ss.internal_force_window(roof(roll, friction), [FEET], others=others, **SETTINGS)
    low, high = limits_on_a_slope(roll, friction)
    assert window.kind == "interval"
    assert window.lower.value == pytest.approx(low, abs=1e-6) and window.upper.value == pytest.approx(high, abs=1e-6)
    assert set(window.lower.stopped_by) == set(window.upper.stopped_by) == set(FEET)
    assert window.width == pytest.approx(high - low, abs=1e-6)
    assert window.holds(0.5 * (low + high)) and not window.holds(high + 1.0)
    assert window.holds(0.0) == (np.tan(roll) <= friction), "without internal force the slope asks tan(roll) of friction"


def test_slip_is_predicted_where_the_window_ends():
    roll, friction = np.deg2rad(15), 0.2
    low, high = limits_on_a_slope(roll, friction)
    stance = roof(roll, friction)
    data, base = assemble(stance), ss.distribute(stance, "barycentric", **SETTINGS)
    D = null_direction(stance.contacts, FEET)
    for s, inside in ((low - 1e-3, False), (low + 1e-3, True), (high - 1e-3, True), (high + 1e-3, False)):
        assert (wrench_reserve(data, base.wrenches_C + s * D, ss.ConeChoice(), "socp", "clarabel") >= 0) == inside


def test_free_others_widen_the_window():
    stance = roof(np.deg2rad(10), 0.3, com=(0.03, 0.02, 0.24))
    fixed, free = (ss.internal_force_window(stance, [FEET], others=others, **SETTINGS) for others in ("fixed", "free"))
    assert free.lower.value <= fixed.lower.value - 1e-3 and free.upper.value >= fixed.upper.value + 1e-3
    for end in (free.lower, free.upper):
        total = end.wrenches_W[:, :3].sum(axis=0)
        assert np.allclose(total, [0, 0, 2 * HALF], atol=1e-6)


def test_the_window_is_empty_where_the_fixed_solution_slips_whatever_is_added():
    stance = roof(np.deg2rad(15), 0.2, com=(0.2, 0.0, 0.24))
    window = ss.internal_force_window(stance, [FEET], **SETTINGS)
    assert window.kind == "empty" and window.lower is None and window.width == 0.0 and not window.holds(0.0)


def test_between_walls_a_squeeze_has_no_end():
    walls = [PointContact(name, (0, y, 0), normal=(0, -np.sign(y), 0), friction=0.8) for name, y in (("left", 0.4), ("right", -0.4))]
    walls.append(PointContact("third", (0.3, 0.4, 0.0), normal=(0, -1, 0), friction=0.8))
    stance = Stance(ContactSet(walls), (0.05, 0.0, 0.0), 10.0)
    window = ss.internal_force_window(stance, [["left", "right"]], others="free", **SETTINGS)
    assert window.kind == "unbounded" and window.upper.value == np.inf and window.upper.wrenches_W is None
    assert window.lower.value > 0 and not window.holds(0.0) and window.holds(1e6)


def test_torque_limits_close_the_window_at_a_named_joint():
    posture = ss.pose(robot("hoap2"), {"LARM_JOINT1": 1.57, "RARM_JOINT1": 1.57}, friction=0.5)
    limits = {"default": np.inf, "?LEG_JOINT*": 2.0}
    wide, narrow = (ss.internal_force_window(posture, [FEET], torque_limits=given, **SETTINGS) for given in (False, limits))
    assert narrow.lower.value > wide.lower.value and narrow.upper.value < wide.upper.value
    for end in (narrow.lower, narrow.upper):
        assert len(end.stopped_by) >= 1 and all("LEG_JOINT" in name for name in end.stopped_by)
        J = np.vstack([posture.jacobian[c.name] for c in posture.contacts])
        tau = ss.static_torque(ss.gravity_torque(posture.com_jacobian, posture.mass, np.array([0, 0, -9.81])), J, end.wrenches_W.ravel())
        legs = ["LEG_JOINT" in name for name in posture.robot.joints]
        assert np.abs(tau[legs]).max() == pytest.approx(2.0, abs=1e-6)


def test_the_feasible_set_of_two_directions_in_closed_form():
    """Feet that press against each other along y and along x: the tangential resultant stays in a disc, corners permitting."""
    stance = roof(0.0, 0.5)
    along_x = {"right_foot": [1, 0, 0, 0, 0, -0.039], "left_foot": [-1, 0, 0, 0, 0, -0.039]}
    window = ss.internal_force_window(stance, [FEET, along_x], tolerance=1e-3, **SETTINGS)
    found = window.set
    assert window.kind == "polygon" and found.relative_gap <= 1e-3
    disc = np.pi * (0.5 * HALF) ** 2
    assert found.inner_area < disc, "the twist that balances the moment about z costs friction"
    radius = np.linalg.norm(found.inner, axis=1)
    assert radius.max() <= 0.5 * HALF + 1e-6
    assert window.upper.value == pytest.approx(0.5 * HALF, abs=1e-6)
    assert window.upper.value <= found.outer[:, 0].max() + 1e-9
    base, directions = ss.distribute(stance, "barycentric", **SETTINGS).wrenches_C, window.directions
    data = assemble(stance)
    for s in found.inner[::7]:
        inside = base + np.tensordot(s, directions, axes=1)
        assert wrench_reserve(data, inside, ss.ConeChoice(), "socp", "clarabel") > -1e-6
        beyond = base + np.tensordot(1.01 * s, directions, axes=1)
        assert wrench_reserve(data, beyond, ss.ConeChoice(), "socp", "clarabel") < 0


def test_two_directions_of_an_unbounded_or_flat_set():
    stance = roof(0.0, 0.5)
    twist = {"right_foot": [0, 0, 0, 0, 0, 1], "left_foot": [0, 0, 0, 0, 0, -1]}
    ice = [FrictionlessSurfaceContact(c.name, c.position, normal=UP, vertices=SOLE) for c in stance.contacts]
    slide = Stance(ContactSet(ice), (0, 0, 0.24), MASS)
    moments = [{"right_foot": [0, 0, 0, *m], "left_foot": [0, 0, 0, *(-np.array(m))]} for m in ((1, 0, 0), (0, 1, 0))]
    tilted = ss.internal_force_window(slide, moments, **SETTINGS)
    assert tilted.kind == "polygon"
    corner = 4 * HALF * 0.0315 * HALF * 0.049
    assert tilted.set.inner_area == pytest.approx(corner, rel=1e-6)
    assert ss.internal_force_window(stance, [FEET, twist], **SETTINGS).kind == "polygon"
    outside = Stance(stance.contacts, (0.2, 0, 0.24), MASS)
    assert ss.internal_force_window(outside, [FEET, twist], **SETTINGS).kind == "empty"


@pytest.mark.parametrize(
    ("directions", "options", "words"),
    [
        ([], {}, "one or two directions"),
        ("left_foot", {}, "one or two directions"),
        ([["left_foot"]], {}, "two different contacts"),
        ([["left_foot", "left_foot"]], {}, "two different contacts"),
        ([["left_foot", "left_hand"]], {}, "contact 'left_hand' is not there"),
        ([{"left_hand": [0, 0, 1]}], {}, "contact 'left_hand' is not there"),
        ([{"left_foot": [0, 0, 1]}], {}, "no net wrench, these have .*force along z"),
        ([{"left_foot": [0, 0, 1], "right_foot": [0, 0, -1]}], {}, "no net wrench, these have .*moment about x"),
        ([{"left_foot": [0, 0]}], {}, "directions: contact 'left_foot' needs a force of 3"),
        ([{"left_foot": [0, 0, 0]}], {}, "a direction that is not zero"),
        ([FEET, ["left_foot", "right_foot"]], {}, "two independent directions"),
        (None, {}, "one or two directions"),
        ([3], {}, "two different contacts"),
        ([{"left_foot": [0, 0, np.nan]}], {}, "finite numbers"),
        ([FEET], {"others": "loose"}, "others must be one of"),
        ([FEET], {"particular": "qp"}, "particular must be one of"),
        ([FEET], {"tolerance": 0.0}, "tolerance must be"),
    ],
)
def test_wrong_input_is_named(directions, options, words):
    with pytest.raises(InputError, match=words):
        ss.internal_force_window(roof(0.1, 0.5), directions, **SETTINGS, **options)


def test_a_frictionless_foot_transmits_no_squeeze():
    ice = ContactSet([FrictionlessSurfaceContact(c.name, c.position, normal=UP, vertices=SOLE) for c in roof(0, 0.5).contacts])
    with pytest.raises(InputError, match="does not transmit fy"):
        ss.internal_force_window(Stance(ice, (0, 0, 0.24), MASS), [FEET], **SETTINGS)
    same = ContactSet([SurfaceContact(name, (0, 0, 0), normal=UP, friction=0.5, vertices=SOLE) for name in FEET])
    with pytest.raises(InputError, match="at the same place"):
        ss.internal_force_window(Stance(same, (0, 0, 0.24), MASS), [FEET], **SETTINGS)


def test_the_window_of_the_command_line(capsys):
    assert main(["solve", "chapter/internal_force_window"]) == 0
    printed = capsys.readouterr().out
    assert "along right_foot - left_foot, tension positive, others fixed" in printed and "below it gives way: right_foot" in printed
    assert main(["solve", "chapter/internal_force_window", "--set", "parameters.others=free", "--json", "-"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["window"]["kind"] == "interval" and record["objective"] == record["window"]["width"]
    assert main(["solve", "chapter/internal_force_set"]) == 0
    assert "polygon" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ('parameters.directions=[["left_foot"]]', "a pair of contacts is expected"),
        ('parameters.directions=[["left_foot", "tail"]]', "directions names 'tail', which is no contact"),
        ("parameters.directions=[]", "parameters.directions"),
        ("parameters.directions=[{ left_foot = [0, 0, 1] }]", "no net wrench"),
        ("parameters.others=some", "parameters.others"),
        ("parameters.particular=qp", "parameters.particular"),
        ("parameters.tolerance=0", "parameters.tolerance"),
    ],
)
def test_wrong_files_are_answered_in_one_sentence(setting, words, capsys):
    assert main(["solve", "chapter/internal_force_window", "--set", setting]) == 2
    assert words in capsys.readouterr().err.strip().splitlines()[-1]


def test_windows_are_drawn(tmp_path):
    window = ss.internal_force_window(roof(0.2, 0.3), [FEET], **SETTINGS)
    ax = ss.draw(window)
    assert ax.get_xlim()[0] < window.lower.value and ax.get_xlim()[1] > window.upper.value
    twist = {"right_foot": [0, 0, 0, 0, 0, 1], "left_foot": [0, 0, 0, 0, 0, -1]}
    both = ss.draw(ss.internal_force_window(roof(0.2, 0.3), [FEET, twist], **SETTINGS))
    assert len(both.get_lines()) >= 3 and len(both.patches) == 1 and both.get_ylim()[1] > both.get_ylim()[0]
    empty = ss.draw(ss.internal_force_window(roof(0.2, 0.1, com=(0.2, 0, 0.24)), [FEET], **SETTINGS))
    assert empty.get_xlim()[0] < 0 < empty.get_xlim()[1]
    for name in ("internal_force_set",):
        path = tmp_path / f"{name}.png"
        assert main(["solve", f"chapter/{name}", "--figure", str(path)]) == 0
        assert path.stat().st_size > 5_000


def test_the_five_link_example_of_the_chapter_by_its_regression_numbers():
    """Section 3.6.5, example 1: hips and ankles rolled 5 deg outward, internal force of -5, 0 and +5 N at the soles."""
    roll = np.deg2rad(5)
    angles = {
        "LARM_JOINT1": np.pi / 2,
        "RARM_JOINT1": np.pi / 2,
        "RLEG_JOINT2": -roll,
        "RLEG_JOINT6": roll,
        "LLEG_JOINT2": roll,
        "LLEG_JOINT6": -roll,
    }
    posture = ss.pose(robot("hoap2"), angles, friction=0.5)
    y = [posture.contacts[name].position[1] - posture.com_W[1] for name in FEET]
    assert y == pytest.approx([-0.05643, 0.05643], abs=1e-4)
    base = ss.distribute(posture, "barycentric", **SETTINGS)
    D = null_direction(posture.contacts, FEET)
    J = np.vstack([posture.jacobian[c.name] for c in posture.contacts])
    joints = posture.robot.joints
    expected = {0.0: (0.403, 0.0), -5.0: (1.584, 0.185), 5.0: (-0.778, -0.185)}
    for internal, (hip, ankle) in expected.items():
        local = base.wrenches_C + internal * D
        world = np.concatenate([np.kron(np.eye(2), c.rotation) @ F for c, F in zip(posture.contacts, local, strict=True)])
        assert world[2] == pytest.approx(30.62, abs=0.01) and world[8] == pytest.approx(30.62, abs=0.01)
        tau = dict(
            zip(
                joints,
                ss.static_torque(ss.gravity_torque(posture.com_jacobian, posture.mass, np.array([0, 0, -9.81])), J, world),
                strict=True,
            )
        )
        assert tau["RLEG_JOINT2"] == pytest.approx(hip, abs=2e-3) and tau["LLEG_JOINT2"] == pytest.approx(-hip, abs=2e-3)
        assert tau["RLEG_JOINT6"] == pytest.approx(ankle, abs=2e-3) and tau["LLEG_JOINT6"] == pytest.approx(-ankle, abs=2e-3)


@pytest.mark.parametrize("degrees", [10, 30])
@pytest.mark.parametrize("y", [0.0, 0.03])
def test_d32_an_internal_force_makes_the_needed_friction_zero(degrees, y):
    roll = np.deg2rad(degrees)
    stance = roof(roll, 1e-3, com=(0.0, y, 0.24))
    assert ss.internal_force_window(stance, [FEET], others="free", **SETTINGS).kind == "interval"
    base = ss.distribute(stance, "barycentric", **SETTINGS)
    assert 1e-3 * base.measures.friction_use["left_foot"] == pytest.approx(np.tan(roll), rel=1e-9)


@pytest.mark.parametrize("engine", ["kernel", "cvxpy"])
def test_every_engine_finds_the_same_window(engine):
    one, other = (
        ss.internal_force_window(roof(0.25, 0.3, com=(0.01, 0.01, 0.24)), [FEET], others="free", engine=e) for e in ("clarabel", engine)
    )
    assert other.engine == engine
    assert one.lower.value == pytest.approx(other.lower.value, abs=1e-6) and one.upper.value == pytest.approx(other.upper.value, abs=1e-6)


@pytest.mark.parametrize("count", [1, 2])
def test_where_the_contacts_cannot_balance_the_load_the_window_is_empty(count, tmp_path):
    contact = '[[posture.contacts]]\nname = "{}"\ntype = "point"\nposition = [{}, {}, 0]\nnormal = [0, 0, 1]\nfriction = 0.5\n'
    places = {"right_foot": (0, -0.5), "left_foot": (0, 0.5), "hand": (0, 1)}
    pairs = [FEET, ["left_foot", "hand"]][:count]
    text = f'model = "internal_force_window"\n[parameters]\ndirections = {json.dumps(pairs)}\n'
    text += '[posture]\ngenerator = "contacts"\nmass = 60.0\ncom = [0.1, 0, 1]\n'
    path, out = tmp_path / "line.toml", tmp_path / "record.json"
    path.write_text(text + "".join(contact.format(name, *place) for name, place in places.items()))
    assert main(["solve", str(path), "--json", str(out), "--figure", str(tmp_path / "line.svg")]) == 0
    drawn = (tmp_path / "line.svg").read_text()
    assert "no forces balance the load" in drawn and "particular solution" not in drawn
    record = json.loads(out.read_text())
    assert (record["status"], record["verdict"], record["certificate"]["kind"]) == ("solved", "unstable", "motion")
    window = record["window"]
    assert (window["kind"], window["width"], window["lower"], window["particular"]) == ("empty", 0.0, None, [])
    assert ("set" in window) == (count == 2) and window.get("set", {}).get("inner", []) == []
