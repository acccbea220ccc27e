"""What is drawn in which colour, in figures and in the 3-D view alike: the Okabe-Ito palette, and greys for things that do not push."""

BLACK = "#000000"
ORANGE = "#E69F00"
SKY = "#56B4E9"
GREEN = "#009E73"
BLUE = "#0072B2"
VERMILLION = "#D55E00"
PURPLE = "#CC79A7"
GREY = "#6B6B6B"
SOLE = "#D4D4D4"

FLAT_PART, ROUND_PART, EDGE = "#A9B7C9", "#8493A8", "#46505F"
GROUND, SOLE_LINE = "#EFEDE8", "#1F1F1F"

VERDICT_COLOURS = {"stable": GREEN, "unstable": VERMILLION, "undecided": GREY}
REGION_COLOURS = {"exact": BLUE, "circumscribed": ORANGE, "inscribed": GREEN}
