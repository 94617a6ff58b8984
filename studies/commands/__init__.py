"""The commands of the command line, by kind: ``add_NAME(parser)`` and ``run_NAME(options)`` of each.

A command turns text into calls and results into lines; nothing is computed here. Only the module of the command that
is asked for is imported. Exit codes: 0 fine, 1 a check failed, 2 wrong use (one line), 3 did not converge, 130
interrupted.
"""

from __future__ import annotations

OK, FAILED, WRONG_USE, NOT_CONVERGED = 0, 1, 2, 3
INTERRUPTED = 130  # as shells have it for SIGINT
