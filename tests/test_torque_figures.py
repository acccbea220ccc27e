"""Figures of joint torques: bars have their length and colour; no limit, no share of it."""

import pytest
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from socp_statics.exceptions import InputError
from socp_statics.figures import draw_torques
from socp_statics.figures.torque_use import torque_uses

INF = float("inf")
MINUS = "\N{MINUS SIGN}"
TORQUES = {"HIP": 1.5, "KNEE": -3.0, "ANKLE": 0.25, "WAIST": 2.0, "NECK": -0.5}
LIMITS = {"HIP": (-2, 2), "KNEE": (-4, 1), "ANKLE": (-INF, 0.25), "WAIST": (-INF, INF), "NECK": ("-inf", 5.0)}


def words_of(figure):
    return [text.get_text() for text in figure.texts] + [text.get_text() for one in figure.legends for text in one.get_texts()]


def bars_of(ax):
    return [artist for artist in ax.get_children() if isinstance(artist, Rectangle) and artist is not ax.patch]


def test_bars_are_as_long_as_torque_over_limit():
    ax = draw_torques({"torques": TORQUES, "torque_limits": LIMITS})
    lengths = {round(bar.get_y() + 0.5 * bar.get_height()): bar.get_width() for bar in bars_of(ax)}
    names = [label.get_text() for label in ax.get_yticklabels()]
    assert names == ["HIP", "KNEE", "ANKLE", "WAIST", "NECK"]
    assert {names[k]: v for k, v in lengths.items()} == pytest.approx({"HIP": 0.75, "KNEE": -0.75, "ANKLE": 1.0})
    assert ax.get_xlabel() == "share of its torque limit [%]"
    assert ax.get_xlim()[0] < -1.0 and ax.get_xlim()[1] > 1.0
    ticks = [ax.xaxis.get_major_formatter()(x) for x in (-1.0, 0.0, 1.0)]
    assert ticks == [MINUS + "100", "0", "100"]


def test_joints_without_a_limit_have_no_share():
    uses = {use.joint: use for use in torque_uses(TORQUES, LIMITS)}
    assert uses["WAIST"].share is None and uses["NECK"].share is None and not uses["NECK"].limited
    ax = draw_torques(TORQUES, torque_limits=LIMITS)
    (other,) = [one for one in ax.get_figure().axes if one is not ax]
    assert other.get_xlabel() == "torque of joints without a limit [N m]"
    assert [bar.get_width() for bar in bars_of(other)] == [2.0, -0.5]
    assert [round(bar.get_y() + 0.5 * bar.get_height()) for bar in bars_of(other)] == [3, 4]
    assert "torque without a limit" in words_of(ax.get_figure())


def test_without_any_limit_nothing_is_said_about_limits():
    for torques in (TORQUES, {"torques": TORQUES, "torque_limits": {}}, {"torques": TORQUES, "torque_limits": None}):
        ax = draw_torques(torques)
        assert ax.get_figure().axes == [ax] and ax.get_xlabel() == "joint torque [N m]"
        assert [bar.get_width() for bar in bars_of(ax)] == list(TORQUES.values())
        assert not any("limit" in word for word in words_of(ax.get_figure()))


def test_numbers_beside_the_bars_have_torque_and_limit_on_its_side():
    ax = draw_torques(TORQUES, torque_limits=LIMITS)
    words = [text.get_text() for text in ax.texts]
    assert words == ["1.50 of 2", f"{MINUS}3.00 of {MINUS}4", "0.25 of 0.25", "2.00", f"{MINUS}0.50", "[N m]"]


def test_colours_tell_how_near_the_limit_is():
    shares = {"LOW": 0.5, "NEAR": 0.85, "AT": 1.0, "OVER": -1.4}
    ax = draw_torques(shares, torque_limits=dict.fromkeys(shares, (-1, 1)))
    colours = {round(bar.get_y() + 0.5 * bar.get_height()): bar.get_facecolor() for bar in bars_of(ax)}
    assert colours[2] == colours[3] and len({colours[k] for k in (0, 1, 2)}) == 3


def test_far_beyond_a_limit_and_against_a_limit_of_zero_the_bar_is_cut():
    torques = {"STUCK": 0.1, "STILL": 0.0, "WEAK": 100.0, "FINE": 1.0}
    limits = {"STUCK": (0, 0), "STILL": (0, 0), "WEAK": (-1, 1), "FINE": (-2, 2)}
    assert [use.share for use in torque_uses(torques, limits)] == [INF, 0.0, 100.0, 0.5]
    ax = draw_torques(torques, torque_limits=limits)
    assert ax.get_xlim()[1] < 4.0
    assert sum(isinstance(a, Line2D) and a.get_marker() == ">" for a in ax.get_children()) == 2


@pytest.mark.parametrize(
    ("torques", "limits", "sentence"),
    [
        ({}, None, "there are no joint torques"),
        ({"torques": None}, None, "there are no joint torques"),
        ({"KNEE": "strong"}, None, "the torque of joint 'KNEE' must be a number, got 'strong'"),
        ({"KNEE": INF}, None, "the torque of joint 'KNEE' must be a number"),
        ({"KNEE": 1.0}, {"KNEES": (-1, 1)}, "a torque limit for joint 'KNEES', which has no torque .did you mean 'KNEE'"),
        ({"KNEE": 1.0}, {"KNEE": 3.0}, "must be .lower, upper., got 3.0"),
        ({"KNEE": 1.0}, {"KNEE": (1, 3)}, "must hold 0, got .1, 3."),
        ({"KNEE": 1.0}, {"KNEE": (-1, "much")}, "the torque limit of joint 'KNEE' must be a number, got 'much'"),
    ],
)
def test_wrong_torques_are_refused_by_name(torques, limits, sentence):
    with pytest.raises(InputError, match=sentence):
        draw_torques(torques, torque_limits=limits)
