# SPDX-License-Identifier: Apache-2.0
"""What a session has beside its rows."""

import json
from typing import Any, NamedTuple, Optional


class SessionEvent(NamedTuple):
    """Something that was said or done while a session was recorded (docs/reference/session.md).

    time_s    the device's time of the catheter's frame before it; NaN before the first
    catheter  its name; None: an event of all of them
    event     "note", "tare", "base", "tendon", "stale", "live", "dropped", "inconsistent", ...
    data      what came with it, as a note's {"text": ...}
    """

    time_s: float
    catheter: Optional[str]
    event: str
    data: dict[str, Any]


def data_of(text: str) -> dict[str, Any]:
    """Of JSON; what is none, or no object, stands under "text"."""
    if not text:
        return {}
    try:
        data = json.loads(text)
    except ValueError:
        data = text
    return data if isinstance(data, dict) else {"text": data}


def events_of(session: dict[str, Any]) -> tuple[SessionEvent, ...]:
    return tuple(SessionEvent(time_s, name, event, data_of(text)) for time_s, name, event, text in session["events"])


def name_of(catheter_name: Optional[str]) -> Optional[str]:
    """A catheter's name as the readers take it. Raises TypeError."""
    if catheter_name is None or (isinstance(catheter_name, str) and catheter_name):
        return catheter_name
    raise TypeError(f"catheter_name = {catheter_name!r:.60}: expected the name of a catheter")
