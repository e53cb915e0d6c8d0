# SPDX-License-Identifier: Apache-2.0
"""What the command line prints as `palpate: warning: ...`."""

import warnings
from collections.abc import Iterable


class PalpateWarning(UserWarning):
    """Something that a user should know about the input; the result stands."""


def warn_all(messages: Iterable[str], level: int = 3) -> tuple[str, ...]:
    """Warns of each, at the line of whoever called the public function: so many calls above."""
    kept = tuple(messages)
    for message in kept:
        warnings.warn(message, PalpateWarning, stacklevel=level)
    return kept
