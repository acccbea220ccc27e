"""Robustness of a posture in units a person understands (3.7.1): each number by convex programs, each with its side of the truth."""

from socp_statics.stability.robustness.assess import DEFAULT_MEASURES as DEFAULT_MEASURES
from socp_statics.stability.robustness.assess import MEASURES as MEASURES
from socp_statics.stability.robustness.assess import RobustnessAnswer as RobustnessAnswer
from socp_statics.stability.robustness.assess import measure_robustness as measure_robustness
from socp_statics.stability.robustness.given_rule import check_push_rule as check_push_rule
from socp_statics.stability.robustness.measure import Measure as Measure
