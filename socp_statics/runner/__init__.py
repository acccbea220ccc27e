"""Many problems at once: a process pool or a cluster answers them, a folder keeps the records, a later run goes on where one stopped."""

from socp_statics.runner.results import Results as Results
from socp_statics.runner.results import load_results as load_results
from socp_statics.runner.running import Summary as Summary
from socp_statics.runner.running import run as run
from socp_statics.runner.staleness import stale_problems as stale_problems
