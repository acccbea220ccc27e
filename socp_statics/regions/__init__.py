"""Support regions, the base of support, and margins in metres."""

from socp_statics.regions.base_of_support import BaseOfSupport as BaseOfSupport
from socp_statics.regions.base_of_support import base_of_support as base_of_support
from socp_statics.regions.com_prices import com_margin_prices as com_margin_prices
from socp_statics.regions.support_function import SupportValues as SupportValues
from socp_statics.regions.support_function import support_function as support_function
from socp_statics.regions.support_region import SupportRegion as SupportRegion
from socp_statics.regions.tracing import trace_support_region as trace_support_region
from socp_statics.regions.tracing import trace_support_regions as trace_support_regions
