"""``python -m socp_statics``: the command line."""

from socp_statics.cli import entry_point

entry_point()
