"""What the README promises: its commands, its program, its table of verbs."""

import re
import shlex
import subprocess
import sys
import time
from pathlib import Path

import pytest

from socp_statics.cli import main

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()


def blocks(language):
    return [text for word, text in re.findall(r"^```(\w*)\n(.*?)^```$", README, re.S | re.M) if word == language]


def test_two_commands_do_all_the_setting_up():
    first, second = blocks("sh")
    assert first.startswith("python3 -m venv .venv && .venv/bin/pip install") and "socp-statics solve" in first
    assert second.startswith(".venv/bin/pip install") and second.strip().endswith("-m pytest -q")
    assert len(first.splitlines()) == len(second.splitlines()) == 1


def test_the_first_command_solves_and_draws(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    command = blocks("sh")[0].strip().split("socp-statics ")[1].split()
    assert main(command) == 0
    said = capsys.readouterr().out
    shown = blocks("")[0]
    for line in shown.splitlines():
        if line and not line.startswith("engine"):
            assert line in said
    figure = tmp_path / command[command.index("--figure") + 1]
    assert figure.stat().st_size > 5_000


def test_the_walk_through_ends_with_a_figure(tmp_path, monkeypatch, capsys):
    install, *commands = blocks("bash")[0].strip().splitlines()
    assert install == ".venv/bin/pip install -q -c constraints.txt -e ." and len(commands) == 4
    monkeypatch.chdir(tmp_path)
    for command in commands:
        assert main(shlex.split(command.removeprefix(".venv/bin/socp-statics "))) == 0, command
    for file in ("runs/report.html", "runs/summary.md", "pyramids.pdf", "figures/torque_limited_regions.pdf", "figures/region_gallery.txt"):
        assert (tmp_path / file).stat().st_size > 200, file
    assert "four-sided pyramid" in capsys.readouterr().out


def test_the_ten_line_program_runs(tmp_path, monkeypatch, capsys):
    program = blocks("python")[0]
    assert len([line for line in program.splitlines() if line]) <= 11
    monkeypatch.chdir(tmp_path)
    exec(compile(program, "README", "exec"), {})  # noqa: S102
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith("stable ")
    assert said[1].startswith("polygon ")
    assert (tmp_path / "region.png").exists()


def test_the_batch_program_runs(capsys):
    exec(compile(blocks("python")[1], "README", "exec"), {})  # noqa: S102
    verdicts, largest, regions = capsys.readouterr().out.splitlines()
    assert 60.0 * 9.81 / 8 <= float(largest.split()[0]) <= 60.0 * 9.81
    assert 0.1 < float(verdicts.split()[0]) < 0.9
    assert float(regions.split()[0]) > 0.05


def test_the_robot_program_prints_what_the_readme_says(capsys):
    exec(compile(blocks("python")[2], "README", "exec"), {})  # noqa: S102
    (said,) = capsys.readouterr().out.splitlines()
    assert f"prints `{said}`" in README


def test_the_posture_program_prints_what_the_readme_says(capsys):
    names: dict = {}
    for block in blocks("python")[2:4]:
        exec(compile(block, "README", "exec"), names)  # noqa: S102
    said = capsys.readouterr().out.splitlines()[-1]
    assert f"prints `{said}`" in README
    assert names["gradient"].tangent.shape == (31,) and names["types"]["singular"].dimension == 0


def test_the_program_that_reaches_a_wall_runs(capsys):
    exec(compile(blocks("python")[4], "README", "exec"), {})  # noqa: S102
    assert capsys.readouterr().out.startswith("stable ")


def test_the_program_of_wrench_cones_runs(capsys):
    pytest.importorskip("cdd")
    program = next(block for block in blocks("python") if "body_wrench_cone" in block)
    exec(compile(program, "README", "exec"), {})  # noqa: S102
    said = capsys.readouterr().out.splitlines()
    assert said[0] == "(16, 6)" and "consistent=True" in said[2] and "by='faces'" in said[2]
    assert 0.01 < float(said[3].split()[0]) < 0.2
    assert said[4].startswith("left ") and "centre of pressure" in said[4]


def test_the_program_that_distributes_wrenches_runs(capsys):
    (program,) = (block for block in blocks("python") if "ss.distribute(" in block)
    exec(compile(program, "README", "exec"), {})  # noqa: S102
    said = capsys.readouterr().out.splitlines()
    assert "True" in said[0] and said[1].endswith("N m") and " N, stopped by (" in said[2]


def test_the_methods_of_distribution_are_those_of_the_table():
    from socp_statics.optimization.wrench_distribution import METHODS

    section = README.split("## Wrench distribution")[1].split("\n## ")[0]
    rows = re.findall(r"^\| (`\w+`(?:, `\w+`)*) \|", section, re.M)
    assert {name for row in rows for name in re.findall(r"`(\w+)`", row)} == set(METHODS)


def test_the_generators_and_their_keys_are_those_of_the_table():
    import inspect

    from socp_statics.postures import GENERATORS

    named = set()
    for row in re.findall(r"^\| (`\w+`(?:, `\w+`)*) \| (.*?) \|", README, re.M):
        names, keys = (re.findall(r"`(\w+)`", cell) for cell in row)
        if not set(names) <= set(GENERATORS.names()):
            continue
        named |= set(names)
        own = {key for name in names for key in inspect.signature(GENERATORS.load(name)).parameters} - {"robot", "at", "friction", "com"}
        assert own <= set(keys) | {"support"}, names
        assert set(keys) - {"name", "places", "com", "support"} <= own, names
    assert named == set(GENERATORS.names())


def test_every_verb_of_the_table_exists_and_no_other_is_listed(capsys):
    verbs = set(re.findall(r"\| `socp-statics ([a-z]+)", README))
    assert main(["--help"]) == 0
    said = capsys.readouterr().out
    listed = set(re.findall(r"^  ([a-z]+) ", said.split("Commands:")[1], re.M))
    assert listed == verbs
    for verb in verbs:
        assert main([verb, "--help"]) == 0
        options = set(re.findall(r"--[a-z]+", next(row for row in README.splitlines() if f"socp-statics {verb}" in row and row[0] == "|")))
        assert options <= set(re.findall(r"--[a-z]+", capsys.readouterr().out))


def test_the_files_it_names_exist():
    for name in re.findall(r"`((?:socp_statics|tests|problems)/[\w/.]*)`", README):
        assert (ROOT / name).exists(), name
    programs = ("kernel.py", "support_direction.py", "postures.py", "inverse_kinematics.py")
    assert all((ROOT / "tests/benchmarks" / name).exists() for name in programs)


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], ["list", "models"]])
def test_asking_for_help_imports_no_solver(arguments):
    code = f"import sys; from socp_statics.cli import main; main({arguments!r}); print(*sorted(sys.modules), file=sys.stderr)"
    start = time.perf_counter()
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert time.perf_counter() - start < 20  # a hang, not a speed, would fail here
    loaded = set(done.stderr.split())
    assert not loaded & {"cvxpy", "clarabel", "matplotlib", "scipy.optimize"}
