"""A results folder on one page: counts, failures, slowest cases, distributions, thumbnails of regions, versions."""

from socp_statics.report.writing import write_report as write_report
