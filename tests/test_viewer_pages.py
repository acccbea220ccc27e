"""The verb view: the exported page and the live one, in a browser and without; wrong input."""

import ast
import os
import re
import signal
import subprocess
import sys
import time
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pinocchio
import pytest
from browser import needs_browser, opened

import socp_statics.viewer
from socp_statics.cases.problem import load_problem
from socp_statics.cases.solve import solve
from socp_statics.cli import main
from socp_statics.engines import SINGLE
from socp_statics.exceptions import EngineError
from socp_statics.viewer import LiveView, ask, page_html, save_page
from socp_statics.viewer.page import linear_rgb, quaternion
from socp_statics.viewer.scene import LAYERS

PATIENCE = 60.0
# colours as they look on the page, and shares of it that they must at least have
REGION, ROBOT, VELOCITIES = ((165, 212, 233), 5e-3), ((190, 200, 212), 5e-3), ((220, 110, 30), 1e-3)


def asked(name):
    problem = load_problem(name)
    return ask(problem, solve(problem, SINGLE), SINGLE)


@pytest.fixture
def live():
    views = []

    def start(name):
        views.append(LiveView(asked(name)))
        return views[-1]

    yield start
    for view in views:
        view.close()


class References(HTMLParser):
    """Everything that a page would fetch."""

    def __init__(self):
        super().__init__()
        self.found, self.titles, self._inside = [], [], None

    def handle_starttag(self, tag, attrs):
        self._inside = tag
        self.found += [value for key, value in attrs if key in ("src", "href", "srcset", "action", "data") and value]

    def handle_data(self, data):
        if self._inside == "title":
            self.titles.append(data.strip())


def arrow_points(view, name):
    """Tails and heads of the arrows of a node, world axes."""
    return np.asarray(view.page.nodes[name].points, dtype=float) + view.page.scene.origin


def wait_for(what, patience=PATIENCE):
    end = time.monotonic() + patience
    while time.monotonic() < end:
        found = what()
        if found is not None and found is not False:
            return found
        time.sleep(0.2)
    raise AssertionError("nothing of the kind in time")


def picture(driver, path, colour, least):
    """A screenshot once the page has faded in, so that a share of it has a colour: shape (height, width, 3), 0 to 1."""
    import matplotlib.image

    def faded_in():
        driver.save_screenshot(str(path))
        pixels = matplotlib.image.imread(path)[..., :3]
        return pixels if share_of(pixels, colour) > least else None

    return wait_for(faded_in)


def share_of(pixels, colour, tolerance=0.12):
    return (np.abs(pixels - np.array(colour) / 255.0).max(axis=2) < tolerance).mean()


def test_the_exported_page_refers_to_nothing_outside_and_is_the_same_every_time(tmp_path):
    question = asked("hoap2/push_tips")
    save_page(question, tmp_path / "a.html")
    page = (tmp_path / "a.html").read_text()
    assert page == page_html(question)
    references = References()
    references.feed(page)
    assert all(value.startswith("data:") for value in references.found)
    assert references.titles[0] == "hoap2/push_tips, equilibrium"
    assert set(re.findall(r"\b(?:https?|wss?)://[\w.-]+", page)) <= {"http://www.w3.org"}
    assert not re.search(r"@import|url\((?!['\"]?(?:data:|#))", page)
    assert "tips about the back edge of left_foot" in page and os.fspath(Path.home()) not in page
    assert [path.name for path in tmp_path.iterdir()] == ["a.html"]


@pytest.fixture(scope="module")
def driver(tmp_path_factory):
    with opened(tmp_path_factory.mktemp("browser") / "profile", 900, 700) as browser:
        yield browser


def on_screen(camera, point_W):
    """Where a browser with that camera shows a point of the world, shape (2,) [pixels]."""
    turn = pinocchio.Quaternion(*camera.wxyz).toRotationMatrix()
    x, y, depth = turn.T @ (np.asarray(point_W) - camera.position)
    focal = 0.5 * camera.image_height / np.tan(0.5 * camera.fov)
    return np.array([camera.image_width / 2 + focal * x / depth, camera.image_height / 2 + focal * y / depth])


def drag(driver, start, end, steps=5):
    """Drag with the mouse from one place of the scene to another, both in pixels."""
    from selenium.webdriver.common.action_chains import ActionChains

    canvas = driver.find_element("css selector", "canvas")
    middle = np.array([canvas.rect["width"], canvas.rect["height"]]) / 2
    hand = ActionChains(driver, duration=50)
    for step in range(steps + 1):
        x, y = np.rint(start + step / steps * (end - start) - middle).astype(int).tolist()
        hand = hand.move_to_element_with_offset(canvas, x, y).pause(0.2)
        hand = hand.click_and_hold() if step == 0 else hand
    hand.release().perform()


@needs_browser()
def test_exported_pages_show_the_robot_the_region_and_the_motion(driver, tmp_path):
    for name in ("hoap2/hands_on_the_wall", "contacts/slope_block_slides"):
        assert main(["view", name, "--html", str(tmp_path / f"{name.split('/')[1]}.html")]) == 0
    driver.get((tmp_path / "hands_on_the_wall.html").as_uri())
    pixels = picture(driver, tmp_path / "robot.png", *REGION)
    assert share_of(pixels, ROBOT[0]) > ROBOT[1]
    assert (pixels.min(axis=2) > 0.97).mean() < 0.95
    text = driver.find_element("id", "answer").text
    assert "stable" in text and "6.8993 N" in text
    fetched = driver.execute_script("return performance.getEntriesByType('resource').map(entry => entry.name)")
    assert not [url for url in fetched if url.startswith(("http", "ws"))]
    driver.get((tmp_path / "slope_block_slides.html").as_uri())
    first = picture(driver, tmp_path / "slope.png", *VELOCITIES)

    def moved():
        later = picture(driver, tmp_path / "later.png", *VELOCITIES)
        return bool((np.abs(later - first).max(axis=2) > 0.1).mean() > 2e-3)

    assert wait_for(moved)
    assert "slides along" in driver.find_element("id", "answer").text
    assert not [line for line in driver.get_log("browser") if line["level"] == "SEVERE"]


@needs_browser()
def test_dragging_the_centre_of_mass_in_the_browser_asks_again(driver, tmp_path, live):
    view = live("contacts/foot_and_wall_hand")

    def says(words):
        return lambda: words in driver.execute_script("return document.body.innerText")

    driver.get(view.url)
    wait_for(says("71.837 N"))
    picture(driver, tmp_path / "live.png", REGION[0], 1e-3)
    (client,) = wait_for(lambda: list(view.clients()) or None)
    com, arm = np.array(view.record["case"]["generated"]["com"]), 0.6 * view.handle.scale
    grip = com + [arm, 0.0, 0.0]
    drag(driver, on_screen(client.camera, grip), on_screen(client.camera, grip + [0.8, 0.0, 0.0]))
    wait_for(says("unstable"))
    dragged = np.array(view.record["case"]["generated"]["com"])
    assert dragged[0] > com[0] + 0.3 and np.allclose(dragged[1:], com[1:], atol=1e-6)
    driver.execute_script("arguments[0].click()", driver.find_element("xpath", "//button[contains(., 'show')] | //*[text()='show']"))
    label = wait_for(lambda: next(iter(driver.find_elements("xpath", "//label[contains(., 'friction cones')]")), None))
    cones = view.page.server.scene.get_handle_by_name("/stance/cones")
    assert cones.visible
    box = driver.find_element("id", label.get_attribute("for"))
    driver.execute_script("arguments[0].click()", box)
    assert wait_for(lambda: not cones.visible)
    button = driver.find_element("xpath", "//button[contains(., 'put the centre of mass back')]")
    driver.execute_script("arguments[0].click()", button)
    wait_for(says("71.837 N"))
    assert view.record["verdict"] == "stable" and view.record["forces"]


def test_the_page_holds_the_arrows_of_the_record_while_the_com_is_dragged(live):
    view = live("contacts/foot_and_wall_hand")
    scale = view.page.scene.scale
    for xy in ([0.1, 0.0], [0.2, 0.03]):
        record = view.move_com(xy)
        assert view.record is record and record["verdict"] == "stable"
        shown = arrow_points(view, "forces/contacts")
        entries = {tuple(np.round(e["point"], 6)): np.array(e["force"]) for e in record["forces"]}
        assert view.page.nodes["forces/contacts"].visible and not view.page.nodes["motion/velocities"].visible
        for tail, head in shown:
            assert np.allclose(head - tail, scale * entries[tuple(np.round(tail, 6))], atol=1e-6)
        assert np.allclose(arrow_points(view, "forces/weight")[0, 0], [*xy, record["case"]["generated"]["com"][2]])
        assert record["verdict"] in view._words.content
    record = view.move_com([-1.0, 0.0])
    assert record["verdict"] == "unstable" and record["certificate"]["reading"] in view._words.content.replace("&#x27;", "'")
    assert not view.page.nodes["forces/contacts"].visible and view.page.nodes["motion/velocities"].visible
    assert len(view.solve_times) == 3


def test_dragging_the_handle_asks_again_and_the_button_puts_it_back(live):
    view = live("hoap2/double_stance")
    start = view.record
    view.handle.position = view.page.local([0.5, 0.0, 0.3])
    view.drag()
    assert view.record["verdict"] == "unstable" and view.record["case"]["generated"]["com"][:2] == pytest.approx([0.5, 0.0])
    view.put_back()
    assert view.record["verdict"] == "stable" and view.record["margin"] == start["margin"]
    assert np.allclose(view.handle.position, view.page.local(start["case"]["generated"]["com"]))


def test_where_no_engine_settles_the_last_answer_stays_and_the_page_says_so(live, monkeypatch):
    view = live("contacts/slope_block_holds")
    record = view.record

    def breaks(*args, **kwargs):
        raise EngineError("no engine settled it & stopped")

    monkeypatch.setattr(type(view._question), "moved_to", breaks)
    view.drag()
    assert view.record is record and "no engine settled it &amp; stopped" in view._words.content
    with pytest.raises(EngineError):
        view.move_com([0.0, 0.0])


def test_the_certified_motion_is_played_and_everything_comes_back(live):
    view = live("hoap2/push_tips")
    base = view.page.nodes["body/root_joint"]
    stands, ball = np.array(base.position), np.array(view.page.nodes["com/ball"].position)
    view.animate(0.0)
    assert np.allclose(base.position, stands)
    view.animate(4.0)
    assert np.linalg.norm(base.position - stands) > 0.01 and np.linalg.norm(view.page.nodes["com/ball"].position - ball) > 0.01
    view.move_com([-0.01, -0.039])
    view.move_com([0.06, -0.039])
    assert view.record["verdict"] == "stable"
    view.animate(4.0)
    assert np.allclose(base.position, stands)


def test_answers_follow_within_a_twentieth_of_a_second_of_work(live):
    view = live("hoap2/hands_on_the_wall")
    com, rng, spent = np.array(view.record["case"]["generated"]["com"][:2]), np.random.default_rng(0), []
    for _ in range(9):
        start = time.process_time()
        view.move_com(com + rng.uniform(-0.03, 0.03, 2))
        spent.append(time.process_time() - start)
    assert np.median(spent) < 0.5  # 0.013 s measured alone; a hang, not a speed, would fail here


def test_layers_are_shown_and_hidden(live):
    view = live("contacts/slope_block_slides")
    for layer in LAYERS:
        node = view.page.server.scene.get_handle_by_name(f"/stance/{layer}")
        assert node.visible
        view.page.show_layer(layer, False)
        assert not node.visible


def test_a_frame_of_a_motion_that_is_over_does_not_stay(live):
    view = live("hoap2/push_tips")
    base = view.page.nodes["body/root_joint"]
    stands = np.array(base.position)
    old = view._moving
    view.move_com([0.06, -0.039])
    view.page.play(old, 1.0)  # as a frame that was on its way when the answer came
    view._at_rest = False
    view.animate(2.0)
    assert np.allclose(base.position, stands)


def test_rotations_and_colours_reach_the_browser_as_they_are():
    assert np.allclose(quaternion(np.eye(3)), [1, 0, 0, 0])
    assert np.allclose(quaternion(np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])), [0.5**0.5, 0, 0, 0.5**0.5])
    assert linear_rgb("#FFFFFF") == (255, 255, 255) and linear_rgb("#000000") == (0, 0, 0)
    assert linear_rgb("#808080") == (55, 55, 55)


def test_view_serves_until_it_is_interrupted():
    # a process that a shell put into the background ignores interrupts; at a terminal it does not
    program = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); import socp_statics.cli as c; c.entry_point()"
    command = [sys.executable, "-c", program, "view", "contacts/slope_block_sweep", "--case", "2", "--set", "posture.mass=11",
               "--engine", "clarabel"]  # fmt: skip
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        line = process.stdout.readline()
        url = re.search(r"http://127\.0\.0\.1:\d+", line).group()
        import urllib.request

        page = urllib.request.urlopen(url, timeout=30).read()
        assert b"<html" in page[:2000].lower()
        process.send_signal(signal.SIGINT)
        rest, said = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 0 and rest == "" and said == ""
    assert line.startswith("contacts/slope_block_sweep with --set posture.mass case 2 at ")


def test_options_of_solve_reach_the_exported_page(tmp_path, capsys):
    page = tmp_path / "page.html"
    values = ["--set", "posture.contacts.sole.friction=0.5"]
    assert main(["view", "contacts/slope_block_slides", *values, "--engine", "cvxpy", "--html", str(page)]) == 1  # its [expect] fails
    out = capsys.readouterr()
    assert "stable" in page.read_text() and out.out.strip().endswith(f"stable: written to {page}")
    assert "[expect] verdict is 'stable', expected 'unstable'" in out.err.splitlines()[-1]


REFUSED = {
    "a sweep without --case": (["contacts/slope_block_sweep", "--html", "{tmp}/a.html"], ["--case 0 to 5", "6 cases"]),
    "a folder": (["contacts/slope_block_slides", "--html", "{tmp}"], ["--html", "this is a folder"]),
    "a missing folder": (["contacts/slope_block_slides", "--html", "{tmp}/none/a.html"], ["--html", "none/a.html", "No such file"]),
    "the problem file itself": (["{tmp}/own.toml", "--html", "{tmp}/own.toml"], ["--html", "own.toml", "the problem file itself"]),
    "an unknown engine": (["contacts/slope_block_slides", "--engine", "clarabell"], ["--engine", "clarabell", "clarabel"]),
    "an unknown problem": (["contacts/slope_blok_slides"], ["slope_blok_slides", "slope_block_slides"]),
    "an unknown key": (["contacts/slope_block_slides", "--set", "posture.mas=3"], ["posture.mas", "mass"]),
    "a case that is not there": (["contacts/slope_block_sweep", "--case", "6"], ["--case", "6"]),
    "no problem": ([], ["PROBLEM"]),
}  # fmt: skip


@pytest.mark.parametrize("wrong", REFUSED)
def test_wrong_input_is_one_sentence_and_no_file(wrong, tmp_path, capsys):
    arguments, words = REFUSED[wrong]
    own = tmp_path / "own.toml"
    own.write_text(load_problem("contacts/slope_block_slides").path.read_text())
    assert main(["view", *(argument.format(tmp=tmp_path) for argument in arguments)]) == 2
    said = capsys.readouterr()
    assert said.out == "" and all(word in said.err.strip().splitlines()[-1] for word in words)
    assert len(said.err.strip().splitlines()) == 1 and [path.name for path in tmp_path.iterdir()] == ["own.toml"]


@pytest.mark.parametrize("library", ["viser", "trimesh"])
def test_a_missing_extra_is_one_sentence_with_the_command(library, tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, library, None)
    assert main(["view", "contacts/slope_block_slides", "--html", str(tmp_path / "a.html")]) == 2
    said = capsys.readouterr().err
    assert said == f"view: {library} cannot be imported, install the extra with: pip install 'socp-statics[viewer]'\n"
    assert not list(tmp_path.iterdir())


def test_a_page_that_cannot_be_written_is_a_failure_and_leaves_nothing(tmp_path, monkeypatch, capsys):
    def full(*args, **kwargs):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_text", full)
    assert main(["view", "contacts/slope_block_slides", "--html", str(tmp_path / "a.html")]) == 1
    assert "No space left on device" in capsys.readouterr().err and not list(tmp_path.iterdir())


def test_the_extra_is_imported_only_where_something_is_drawn():
    for path in Path(socp_statics.viewer.__file__).parent.glob("*.py"):
        imported = [node for node in ast.parse(path.read_text()).body if isinstance(node, ast.Import | ast.ImportFrom)]
        assert not re.search(r"\b(viser|trimesh)\b", "\n".join(ast.unparse(node) for node in imported).replace("viewer", ""))
