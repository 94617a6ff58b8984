"""The former name of :mod:`studies.solving`."""

from studies.solving import *  # noqa: F403
