"""A plugin whose model kills, stalls or breaks the process that answers it, and runs of the command line that know it."""

import os
import signal
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
MODEL = '''
import os
import signal
import time
from pathlib import Path

from pydantic import Field

from socp_statics.cases.answers.answer import Answer, Parameters


class DeadlyParameters(Parameters):
    number: int = Field(0, description="a whole number")
    kills: list[int] = Field([], description="numbers that kill")
    breaks: list[int] = Field([], description="numbers that raise")
    seconds: float = Field(0.0, description="how long it takes")
    log: str = Field("", description="a file that is told of every answer")


def answer(problem, stance, engine):
    stated = problem.parameters
    if stated["log"]:
        with open(stated["log"], "a") as log:
            log.write(f"{stated['number']} {os.getpid()}\\n")
    time.sleep(stated["seconds"])
    if stated["number"] in stated["kills"]:
        os.kill(os.getpid(), signal.SIGKILL)
    if stated["number"] in stated["breaks"]:
        raise ZeroDivisionError("broken on purpose")
    return {
        "status": "solved", "verdict": "undecided", "reason": None, "cone": problem.cone.as_record(), "objective": None,
        "margin": float(stated["number"]), "idle": [], "idle_margin": None, "wrenches": [], "forces": [], "certificate": None, "prices": {},
        "residuals": {"balance": 0.0, "cone": 0.0, "gap": 0.0}, "engine": "none", "handovers": 0,
    }


ANSWER = Answer(DeadlyParameters, answer)
'''
PROBLEM = """\
description = "deadly"
model = "deadly"

[posture]
generator = "contacts"
mass = 1.0
com = [0, 0, 1]
contacts = [{{ name = "foot", type = "point", position = [0, 0, 0], normal = [0, 0, 1], friction = 0.5 }}]

[parameters]
kills = {kills}
breaks = {breaks}
seconds = {seconds}
log = "{log}"

[sweep]
"parameters.number" = {{ from = 0, to = {last} }}
"""


def install(place):
    """Put the plugin where a process that has the place on its path finds it."""
    (place / "deadly.py").write_text(MODEL)
    about = place / "deadly-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: deadly\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text("[socp_statics.answers]\ndeadly = deadly:ANSWER\n")


def write_problem(path, *, last, kills=(), breaks=(), seconds=0.0):
    path.write_text(PROBLEM.format(last=last, kills=list(kills), breaks=list(breaks), seconds=seconds, log=path.with_suffix(".log")))
    return path


def told(path):
    """Numbers of the cases that were begun, and by which process."""
    log = path.with_suffix(".log")
    return [tuple(map(int, line.split())) for line in log.read_text().splitlines()] if log.exists() else []


def start(place, *arguments):
    """The command line in a process of its own; the engine is Clarabel, which is not asked anything."""
    path = os.pathsep.join((str(ROOT), str(place), os.environ.get("PYTHONPATH", "")))
    command = [sys.executable, "-m", "socp_statics", "run", *map(str, arguments), "--engine", "clarabel"]
    # Where the tests run in the background, interrupts are ignored, and processes inherit that.
    return subprocess.Popen(command, cwd=place, env={**os.environ, "PYTHONPATH": path}, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                            text=True, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))  # fmt: skip


def finish(process):
    said, complaints = process.communicate(timeout=120)
    return process.returncode, said, complaints.strip().splitlines()
