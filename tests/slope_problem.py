"""A block on slopes as a problem file with a sweep of eight cases, for tests of runs."""

PROBLEM = """\
description = "a block on slopes"
model = "{model}"

[posture]
generator = "contacts"
mass = 10.0
com = [0.05, 0.0, 0.2]

[[posture.contacts]]
name = "sole"
type = "surface"
position = [0, 0, 0]
rpy = [0, 0.3490658503988659, 0]
friction = 0.5
size = [0.3, 0.2]

[parameters]
cone = "exact"

[sweep]
"posture.contacts.sole.friction" = {frictions}
"parameters.cone" = ["exact", "inscribed"]
{rest}
"""


def write(path, frictions=(0.3, 0.36, 0.37, 0.5), model="equilibrium", rest=""):
    path.write_text(PROBLEM.format(frictions=list(frictions), model=model, rest=rest))
    return path
