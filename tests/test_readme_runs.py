"""The README's "Thousands of cases": its problem, its commands, its program."""

import re
import shlex
from pathlib import Path

from socp_statics.cli import main

ROOT = Path(__file__).parents[1]
SECTION = (ROOT / "README.md").read_text().split("## Thousands of cases")[1].split("\n## ")[0]


def block(language):
    (text,) = re.findall(rf"^```{language}\n(.*?)^```$", SECTION, re.S | re.M)
    return text


def test_the_commands_answer_and_report_thousands_of_cases(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "population.toml").write_text(block("toml"))
    for line in block("console").strip().splitlines():
        assert main(shlex.split(line)[1:]) == 0
    said = capsys.readouterr().out
    cases = int(re.search(r"(\d+) cases: \1 computed", said)[1])
    assert cases > 200 and f"{cases} records of" in said
    assert (tmp_path / "runs/report.html").stat().st_size > 20_000
    exec(compile(block("python"), "README", "exec"), {})  # noqa: S102
    stood, total = (int(word) for word in re.match(r"(\d+) of (\d+) stand", capsys.readouterr().out).groups())
    assert 50 < stood < total == cases
