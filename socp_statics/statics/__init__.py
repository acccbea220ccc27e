"""From a stance to the arrays of its convex set, and back to forces."""

from socp_statics.statics.assemble import assemble as assemble
from socp_statics.statics.point_forces import PointForces as PointForces
from socp_statics.statics.point_forces import point_forces as point_forces
from socp_statics.statics.statics_data import StaticsData as StaticsData
from socp_statics.statics.units import Units as Units
from socp_statics.statics.wrench_range import wrench_range as wrench_range
