"""The command line: a verb a file, each calls one public function.

Only typer is imported here; what a verb needs is imported by the verb, so that ``--help`` answers at once. The verbs join the
application in the order in which ``--help`` lists them.
"""

from __future__ import annotations

import os
import sys

import typer

from socp_statics.cli import comparing, figuring, listing, proving, reporting, running, showing, solving, viewing  # noqa: F401
from socp_statics.cli.app import app
from socp_statics.exceptions import InputError, StaticsError


def main(arguments: list[str] | None = None) -> int:
    """Run the command line.

    Args:
        arguments: Without the program's name; those of the process by default.

    Returns:
        0: the question was answered. 1: the computation or an expectation failed. 2: the input is wrong. On 1 and 2 the last line
        of standard error is one plain sentence.
    """
    try:
        status = app(args=arguments, standalone_mode=False, prog_name="socp-statics")
        sys.stdout.flush()
        return status if isinstance(status, int) else 0
    except InputError as error:
        return _say(error, 2)
    except StaticsError as error:
        return _say(error, 1)
    except typer.TyperException as error:
        return _say(f"{error.format_message().rstrip('.')}; socp-statics --help says what is expected", 2)
    except typer.Abort:
        return _say("interrupted", 1)
    except BrokenPipeError:
        # whoever read our output has enough; Python would complain again when it flushes at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


def _say(message: object, status: int) -> int:
    print(" ".join(str(message).split()), file=sys.stderr)
    return status


def entry_point() -> None:
    """The console script ``socp-statics``."""
    sys.exit(main())
