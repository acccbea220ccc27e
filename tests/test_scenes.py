"""Generators that state places: contacts where the numbers say, centre of mass over the soles, each for every robot it makes sense for."""

import numpy as np
import pinocchio as pin
import pytest

import socp_statics as ss
from socp_statics.contacts.orientation import rotation_from_rpy
from socp_statics.exceptions import InputError
from socp_statics.postures import GENERATORS
from socp_statics.postures.home import feet_of, home
from socp_statics.postures.joint_roles import ROLES

HUMANOIDS = tuple(ROLES)
QUADRUPEDS = ("anymal_c", "solo12", "hyq", "centauro")
TWO_FEET = ("sloped_feet", "stairs", "wall_brace", "table_lean", "chimney", "push", "ladder", "hold_object", "random_reachable")
STATES = [
    {"name": "both", "support": ["left_foot", "right_foot"], "com": [0.0, 0.0]},
    {"name": "over the left", "support": ["left_foot", "right_foot"], "com": [0.0, 0.035]},
    {"name": "left", "support": ["left_foot"], "com": [0.0, 0.035]},
]
AT = np.array([1.0, -2.0, 0.5])


@pytest.fixture(scope="module")
def hoap2():
    return ss.load_robot("hoap2")


def generate(name, robot, **numbers):
    return GENERATORS.load(name)(robot, **numbers)


def touches_where_the_kinematics_are(posture):
    """Every contact at the place Pinocchio gives its frame; surfaces and lines with its orientation."""
    robot, data = posture.robot, posture.robot.pin_model.createData()
    pin.framesForwardKinematics(robot.pin_model, data, posture.q)
    for contact in posture.contacts:
        frame = robot.frames[contact.name]
        link = data.oMf[robot.pin_model.getFrameId(frame.frame, pin.FrameType.BODY)]
        placed = link * pin.SE3(np.array(frame.rotation), np.array(frame.position))
        assert contact.position == pytest.approx(placed.translation, abs=1e-9)
        if len(contact.points_C) > 1:
            assert contact.rotation == pytest.approx(placed.rotation, abs=1e-9)
    assert (posture.angles >= robot.lower - 1e-12).all() and (posture.angles <= robot.upper + 1e-12).all()
    return True


def middle_of_the_soles(posture):
    return np.mean([c.points_W.mean(axis=0) for c in posture.contacts if c.name.endswith("foot")], axis=0)[:2]


def test_all_generators_are_tested():
    by_angles = {"joint_angles", "random_joint_angles", "standing", "squat", "single_stance", "rolled_feet"}
    assert set(GENERATORS.names()) == by_angles | set(TWO_FEET) | {"quadruped_stance", "keyframes"}


class TestEveryRobot:
    @pytest.mark.parametrize("robot", HUMANOIDS)
    @pytest.mark.parametrize("name", TWO_FEET)
    def test_the_default_stands(self, name, robot):
        posture = generate(name, ss.load_robot(robot))
        assert touches_where_the_kinematics_are(posture)
        answer = ss.check_equilibrium(posture)
        if name != "random_reachable":
            assert answer.stable and answer.margin > 0.0
        if name not in ("random_reachable", "ladder"):
            assert posture.com_W[:2] == pytest.approx(middle_of_the_soles(posture), abs=1e-9)
        assert {"left_foot", "right_foot"} <= set(posture.support)

    @pytest.mark.parametrize("name", TWO_FEET)
    def test_where_and_how_rough(self, hoap2, name):
        posture, moved = generate(name, hoap2), generate(name, hoap2, at=AT, friction=0.7)
        assert moved.com_W - posture.com_W == pytest.approx(AT, abs=1e-9)
        assert moved.angles == pytest.approx(posture.angles, abs=1e-7)
        assert all(contact.friction == 0.7 for contact in moved.contacts if contact.type != "handle")
        for one, other in zip(posture.contacts, moved.contacts, strict=True):
            assert other.position - one.position == pytest.approx(AT, abs=1e-9)

    @pytest.mark.parametrize("name", QUADRUPEDS)
    def test_quadrupeds_stand_by_default(self, name):
        posture = generate("quadruped_stance", ss.load_robot(name))
        assert touches_where_the_kinematics_are(posture) and ss.check_equilibrium(posture).stable
        assert len(posture.support) == 4 and posture.com_W[:2] == pytest.approx([0, 0], abs=1e-9)
        assert generate("random_reachable", ss.load_robot(name)).support == posture.support

    def test_a_robot_nobody_has_named(self, hoap2):
        stranger = ss.Robot.from_pinocchio(hoap2.pin_model, hoap2.frames, name="stranger")
        assert generate("stairs", stranger).contacts["right_foot"].position[2] > 0.0


class TestHome:
    @pytest.mark.parametrize("name", [*HUMANOIDS, *QUADRUPEDS])
    def test_faces_x_with_its_feet_on_the_ground(self, name):
        robot = ss.load_robot(name)
        posture = home(robot)
        feet = np.array([posture.contacts[foot].position for foot in feet_of(robot)])
        assert feet.mean(axis=0)[:2] == pytest.approx([0, 0], abs=1e-9) and abs(feet[:, 2].min()) < 1e-9
        # the homing posture of Centauro is not quite level
        assert np.ptp(feet[:, 2]) < (1e-2 if name == "centauro" else 2e-3)
        for foot in feet_of(robot):
            assert np.sign(posture.contacts[foot].position[1]) == (1 if foot.startswith("left") else -1)
        hands = [contact.position[0] for contact in posture.contacts if contact.name.endswith("hand")]
        assert all(x > 0.0 for x in hands)


class TestNumbers:
    def test_sloped_feet(self, hoap2):
        posture = generate("sloped_feet", hoap2, left=(0.3, -0.2), right=(-0.1, 0.1), spread=0.1)
        assert posture.contacts["left_foot"].rotation == pytest.approx(rotation_from_rpy(np.array([0.3, -0.2, 0])), abs=1e-9)
        assert posture.contacts["right_foot"].rotation == pytest.approx(rotation_from_rpy(np.array([-0.1, 0.1, 0])), abs=1e-9)
        gap = posture.contacts["left_foot"].position - posture.contacts["right_foot"].position
        assert gap == pytest.approx([0, 0.1, 0], abs=1e-9)

    @pytest.mark.parametrize("upper", ["left", "right"])
    def test_stairs(self, hoap2, upper):
        posture = generate("stairs", hoap2, rise=0.04, tread=0.06, upper=upper)
        lower = "right" if upper == "left" else "left"
        step = posture.contacts[f"{upper}_foot"].position - posture.contacts[f"{lower}_foot"].position
        assert step[[0, 2]] == pytest.approx([0.06, 0.04], abs=1e-9)

    @pytest.mark.parametrize("inclination", [-0.5, 0.0, 0.4])
    @pytest.mark.parametrize("turn", [0.0, 1.2])
    def test_wall(self, hoap2, inclination, turn):
        posture = generate("wall_brace", hoap2, inclination=inclination, turn=turn, distance=0.19, height=0.33)
        hand, towards = posture.contacts["left_hand"], np.array([np.cos(turn), np.sin(turn), 0])
        assert hand.position @ towards == pytest.approx(0.19, abs=1e-9) and hand.position[2] == pytest.approx(0.33, abs=1e-9)
        assert hand.normal_W @ towards == pytest.approx(-np.cos(inclination), abs=1e-9)
        assert hand.normal_W[2] == pytest.approx(np.sin(inclination), abs=1e-9)

    def test_table(self, hoap2):
        posture = generate("table_lean", hoap2, distance=0.2, height=0.25, com=(0.03, 0.0))
        for hand in ("left_hand", "right_hand"):
            assert posture.contacts[hand].position[[0, 2]] == pytest.approx([0.2, 0.25], abs=1e-9)
            assert posture.contacts[hand].normal_W == pytest.approx([0, 0, 1], abs=1e-12)
        assert posture.com_W[:2] == pytest.approx([0.03, 0.0], abs=1e-9)

    def test_chimney(self, hoap2):
        posture = generate("chimney", hoap2, slope=0.15, width=0.24, height=0.3)
        for side, sign in (("left", 1), ("right", -1)):
            foot, hand = posture.contacts[f"{side}_foot"], posture.contacts[f"{side}_hand"]
            assert foot.normal_W == pytest.approx([0, -sign * np.sin(0.15), np.cos(0.15)], abs=1e-9)
            assert hand.normal_W == pytest.approx([0, -sign, 0], abs=1e-12)
            assert hand.position[1:] == pytest.approx([sign * 0.12, 0.3], abs=1e-9)
        assert ss.check_equilibrium(posture).margin == np.inf

    def test_push(self, hoap2):
        posture = generate("push", hoap2, force=12.0, stride=0.1)
        answer = ss.check_equilibrium(posture)
        for hand in ("left_hand", "right_hand"):
            assert posture.contacts[hand].normal_force == (6.0, 6.0)
        pushed = sum(np.array(w["force"]) for w in answer.forces.wrenches() if w["contact"].endswith("hand"))
        assert pushed[0] == pytest.approx(-12.0, abs=1e-6)
        feet = posture.contacts["left_foot"].position - posture.contacts["right_foot"].position
        assert feet[[0, 2]] == pytest.approx([0.1, 0.0], abs=1e-9)

    def test_the_pushing_leg_stands_against_a_surface_that_faces_forward(self, hoap2):
        posture = generate("push", hoap2, variant="B", slope=0.4, pushing_leg="left")
        rear = posture.contacts["left_foot"]
        assert rear.normal_W == pytest.approx([np.sin(0.4), 0, np.cos(0.4)], abs=1e-9)
        assert rear.points_W[:, 2].min() == pytest.approx(0.0, abs=1e-9)
        assert rear.position[0] < posture.contacts["right_foot"].position[0]

    @pytest.mark.parametrize(("variant", "verdict"), [("A", "unstable"), ("B", "stable")])
    def test_b_pushes_where_a_slides(self, hoap2, variant, verdict):
        """Fig. 3.9: level feet push at most mu W; an inclined surface pushes back by its normal."""
        weight = hoap2.mass * 9.81
        friction = {"left_foot": 0.15, "right_foot": 0.15, "left_hand": 0.0, "right_hand": 0.0}
        posture = generate("push", hoap2, variant=variant, force=0.2 * weight, friction=friction, height=0.22)
        assert ss.check_equilibrium(posture).verdict == verdict

    def test_ladder(self, hoap2):
        posture = generate("ladder", hoap2, rung_gap=0.03, foot_rungs=(0, 2), inclination=1.2, grip=50.0)
        along = np.array([np.cos(1.2), 0, np.sin(1.2)])
        for contact in posture.contacts:
            rung = contact.position[[0, 2]] @ along[[0, 2]] / 0.03
            assert rung == pytest.approx(round(rung), abs=1e-6)
            assert np.cross(along, contact.position)[1] == pytest.approx(0.0, abs=1e-9)
        assert posture.contacts["right_foot"].position[2] == pytest.approx(2 * 0.03 * np.sin(1.2), abs=1e-9)
        assert posture.contacts["left_foot"].type == "line" and posture.contacts["left_hand"].limits["fx"] == (-50.0, 50.0)

    def test_the_object_weighs_on_feet_and_arms(self, hoap2):
        empty, laden = (generate("hold_object", hoap2, mass=mass, squeeze=20.0) for mass in (0.0, 1.0))
        assert laden.mass == pytest.approx(hoap2.mass + 1.0) and empty.mass == pytest.approx(hoap2.mass)
        for posture in (empty, laden):
            assert posture.com_W[:2] == pytest.approx(middle_of_the_soles(posture), abs=1e-9)
        answers = [ss.check_equilibrium(posture) for posture in (empty, laden)]
        weights = [sum(w["force"][2] for w in answer.forces.wrenches()) for answer in answers]
        assert weights == pytest.approx([hoap2.mass * 9.81, (hoap2.mass + 1) * 9.81], rel=1e-9)
        assert np.abs(sum(load.force for load in laden.loads)).max() < 1e-12
        assert np.abs(sum(load.moment_about(np.zeros(3)) for load in laden.loads)).max() < 1e-12
        assert all(np.linalg.norm(load.force) == pytest.approx(20.0) for load in laden.loads)

    def test_a_laden_robot_by_hand(self, hoap2):
        """Mass and centre of mass of robot and object, and the torques of the arms, against the robot alone with the object as a load."""
        laden = generate("hold_object", hoap2, mass=1.2)
        alone = ss.posture_at(hoap2, laden.q, ["left_foot", "right_foot"])
        hands = ss.posture_at(hoap2, laden.q, ["left_hand", "right_hand"])
        points = [hands.contacts[name].position for name in ("left_hand", "right_hand")]
        assert laden.com_W == pytest.approx((hoap2.mass * alone.com_W + 0.6 * sum(points)) / (hoap2.mass + 1.2), abs=1e-12)
        half = [{"force": [0, 0, -0.6 * 9.81], "point": p, "link": f"{letter}ARM_LINK4"} for letter, p in zip("LR", points, strict=True)]
        presses = [{"force": load.force, "point": load.point, "link": load.link} for load in laden.loads]
        stances = laden.stance(), alone.stance(external_wrenches=half + presses)
        forces = [ss.optimise_contact_forces(stance, objective="least_squares") for stance in stances]
        for joint, torque in forces[0].torques.items():
            assert torque == pytest.approx(forces[1].torques[joint], abs=1e-6), joint

    def test_quadruped_on_a_slope_and_on_steps(self):
        robot = ss.load_robot("hyq")
        posture = generate("quadruped_stance", robot, slope=(0.2, -0.1), at=AT)
        R = rotation_from_rpy(np.array([0.2, -0.1, 0]))
        for contact in posture.contacts:
            assert contact.normal_W == pytest.approx(R[:, 2], abs=1e-12)
            assert (contact.position - AT) @ R[:, 2] == pytest.approx(0.0, abs=1e-9)
        three = ["left_front_foot", "left_hind_foot", "right_hind_foot"]
        stepped = generate("quadruped_stance", robot, steps={"left_front_foot": 0.1}, support=three)
        assert stepped.contacts["left_front_foot"].position[2] == pytest.approx(0.1, abs=1e-9)
        assert stepped.support == ("left_front_foot", "left_hind_foot", "right_hind_foot")
        lifted = ss.posture_at(robot, stepped.q, ["right_front_foot"]).contacts[0]
        assert lifted.position[2] > 0.03

    def test_random_reachable_is_seeded(self, hoap2):
        one, same, other = (generate("random_reachable", hoap2, seed=seed) for seed in (3, 3, 4))
        assert one.q.tobytes() == same.q.tobytes() and np.abs(one.q - other.q).max() > 1e-3
        assert generate("random_reachable", hoap2, hand=False).support == ("left_foot", "right_foot")


class TestKeyframes:
    def test_states_and_what_is_between(self, hoap2):
        for progress, support in ((0, 2), (0.5, 2), (1, 2), (1.25, 1), (2, 1)):
            posture = generate("keyframes", hoap2, states=STATES, progress=progress, at=AT)
            assert touches_where_the_kinematics_are(posture) and len(posture.support) == support
            expected = np.interp(progress, [0, 1, 2], [0.0, 0.035, 0.035])
            assert (posture.com_W - AT)[:2] == pytest.approx([0.0, expected], abs=1e-9)

    def test_the_way_is_continuous(self, hoap2):
        way = [generate("keyframes", hoap2, states=STATES, progress=p) for p in (0, 1e-6, 0.5, 0.501, 1 - 1e-6, 1)]
        for one, other, most in ((0, 1, 1e-4), (2, 3, 1e-2), (4, 5, 1e-4)):
            assert np.abs(way[one].q - way[other].q).max() < most

    def test_places(self, hoap2):
        state = {"support": ["left_foot", "right_foot"], "places": {"right_foot": {"position": [0.05, -0.05, 0.01], "rpy": [0, 0.1, 0]}}}
        foot = generate("keyframes", hoap2, states=[state]).contacts["right_foot"]
        assert foot.position == pytest.approx([0.05, -0.05, 0.01], abs=1e-9)
        assert foot.rotation == pytest.approx(rotation_from_rpy(np.array([0, 0.1, 0])), abs=1e-9)


def only(support, **keys):
    """Keyframes of one state."""
    return {"states": [{"support": support, **keys}]}


WRONG = {
    "a hand that is none": ("wall_brace", {"hands": ["left_foot"]}, ["wall_brace", "'left_foot'", "left_hand"]),
    "no hand": ("table_lean", {"hands": []}, ["table_lean", "at least one"]),
    "one hand twice": ("wall_brace", {"hands": ["left_hand", "left_hand"]}, ["hands must name"]),
    "an object held by nothing": ("hold_object", {"hands": []}, ["held by nothing"]),
    "an object held by one hand": ("hold_object", {"hands": ["left_hand"]}, ["hands must name two"]),
    "an object that slips": ("hold_object", {"mass": 2.0, "squeeze": 1.0}, ["slips", "19.62"]),
    "a mass below zero": ("hold_object", {"mass": -1.0}, ["mass", ">= 0"]),
    "a wall out of reach": ("wall_brace", {"distance": 2.0}, ["cannot reach", "left_hand"]),
    "a step out of reach": ("stairs", {"rise": 0.5}, ["cannot reach"]),
    "a foot beyond the ankle": ("sloped_feet", {"left": [1.3, 0.0]}, ["cannot reach", "LLEG_JOINT"]),
    "three numbers of a slope": ("sloped_feet", {"left": [1.3, 0.0, 1]}, ["left must be 2 numbers"]),
    "a centre of mass of one number": ("stairs", {"com": [1.0]}, ["com must be two or three"]),
    "a spread of zero": ("sloped_feet", {"spread": 0.0}, ["spread", "> 0"]),
    "a pushing force below zero": ("push", {"force": -1.0}, ["force", ">= 0"]),
    "rungs of three feet": ("ladder", {"foot_rungs": [0, 1, 2]}, ["foot_rungs"]),
    "a quadruped's foot of a humanoid": ("quadruped_stance", {}, ["'left_front_foot' is not one of its contacts"]),
    "a hand for a foot": ("quadruped_stance", {"support": ["left_hand"]}, ["'left_hand' is not a foot"]),
    "steps under no foot": ("quadruped_stance", {"support": ["left_foot"], "steps": {"foot": 1.0}}, ["'foot' is not a foot"]),
    "a seed below zero": ("random_reachable", {"seed": -1}, ["seed must be a whole number >= 0"]),
    "no states": ("keyframes", {}, ["states must hold at least one"]),
    "a state without support": ("keyframes", {"states": [{}]}, ["states[0].support"]),
    "a state with an unknown key": ("keyframes", {"states": [{"suport": []}]}, ["suport", "did you mean 'support'"]),
    "a state with an unknown contact": ("keyframes", {"states": [{"support": ["left_fot"]}]}, ["did you mean 'left_foot'"]),
    "a place of what does not touch": ("keyframes", only(["left_foot"], places={"right_foot": {}}), ["does not touch"]),
    "a place with an unknown key": ("keyframes", only(["left_foot"], places={"left_foot": {"at": 1}}), ["left_foot.at"]),
    "states that share nothing": ("keyframes", {"states": [{"support": ["left_foot"]}, {"support": ["right_foot"]}]}, ["share no contact"]),
    "progress beyond the last": ("keyframes", {"states": STATES, "progress": 2.5}, ["at most 2"]),
    "a state out of reach": ("keyframes", only(["left_foot"], name="far", com=[3, 0]), ["'far'", "cannot reach"]),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG.values(), ids=WRONG)
def test_wrong_numbers_are_one_sentence(hoap2, case):
    name, numbers, words = case
    with pytest.raises(InputError) as caught:
        generate(name, hoap2, **numbers)
    assert "\n" not in str(caught.value) and not [word for word in words if word not in str(caught.value)], str(caught.value)


def test_masses_at_contacts_are_checked(hoap2):
    with pytest.raises(InputError, match="left_hand.*mass.*>= 0"):
        hoap2.with_masses({"left_hand": -1.0})
    with pytest.raises(InputError, match="'left_hnd' is not one of its contacts"):
        hoap2.with_masses({"left_hnd": 1.0})
    assert hoap2.with_masses({"left_hand": 1.0}).digest != hoap2.digest
