"""The posture follows the centre of mass: how far it gets along horizontal rays, and what stops it."""

from socp_statics.following.region import FollowingRay as FollowingRay
from socp_statics.following.region import FollowingRegion as FollowingRegion
from socp_statics.following.region import RayEnd as RayEnd
from socp_statics.following.tracing import trace_following_region as trace_following_region
