"""Exact cones beside pyramids: what does linearising friction cost, and when is it unsafe? Nothing here draws."""

from socp_statics.comparison.comparison import Comparison as Comparison
from socp_statics.comparison.comparison import compare as compare
from socp_statics.comparison.comparison import compare_records as compare_records
from socp_statics.comparison.population import judge_stances as judge_stances
from socp_statics.comparison.rates import population_tables as population_tables
from socp_statics.comparison.regions import compare_regions as compare_regions
