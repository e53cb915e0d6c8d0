# SPDX-License-Identifier: Apache-2.0
"""Recordings of trackers as numpy arrays."""

import os
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any, Optional, Union, overload

import numpy as np
from numpy.typing import ArrayLike

from . import _palpate
from ._arguments import PathLike, Rows, instance, is_path, path, shown, structured, words
from ._palpate import Catheter, Frame, InputError
from ._session import SessionEvent, events_of, name_of
from ._warnings import warn_all

_STATUSES = ["MISSING", "OK", "ABSENT"]


class Recording:
    """What a tracker said over time, as received.

    recording["tip"]   structured array, a row a frame: status ("OK", "MISSING", "ABSENT": the frame does not speak of
                       this sensor), quaternion_wxyz (4,) sensor to tracker, position_m (3,), error_m.
                       NaN where nothing was said.
    recording.frames   structured array: time_s, frame, tendon_moment_Nm (2,) (NaN where there is none); of a session
                       also output_time_s, the time that went out with the force [s since 1970, UTC], and received_ns,
                       the host's clock when the frame came [ns since 1970, UTC]
    recording[0]       a Frame, for ForceObserver.update_frame; iterating gives all
    recording.catheter of a session the catheter as it began, else None
    recording.events   of a session what was said and done (SessionEvent), else ()

    From arrays of your own: Recording(time_s, {"tip": (position_m, quaternion_wxyz), ...}) with (n, 3) and (n, 4)
    arrays; None for the quaternions of a point; rows of NaN for what was not seen.

    A recording does not change, and its arrays are read-only. A changed one is made of changed arrays:

        tip = recording["tip"]
        moved = Recording(recording.frames["time_s"], {"tip": (tip["position_m"] + 0.001, tip["quaternion_wxyz"]), ...})

    which has neither frame numbers nor a tendon's moment of the old, nor loads known from a catheter file.
    """

    catheter: Optional[Catheter] = None
    events: tuple[SessionEvent, ...] = ()

    def __init__(
        self,
        time_s: ArrayLike,
        sensors: Mapping[str, tuple[ArrayLike, Optional[ArrayLike]]],
        *,
        source: str = "recording",
    ) -> None:
        if not isinstance(sensors, Mapping):
            kind = type(sensors).__name__
            raise TypeError(f"sensors: {kind}: expected a dict of (position_m, quaternion_wxyz) by name")
        self._data = _palpate.Recording(time_s, dict(sensors), source)

    @classmethod
    def _of(cls, data: "_palpate.Recording", session: Optional[dict[str, Any]] = None) -> "Recording":
        recording = cls.__new__(cls)
        recording._data = data
        if session is not None:
            recording.catheter = session["catheter"]
            recording.events = events_of(session)
        return recording

    @property
    def source(self) -> str:
        """The path as given; of merged recordings all."""
        return self._data.source

    @property
    def sensor_names(self) -> list[str]:
        return self._data.sensor_names

    @property
    def notes(self) -> list[str]:
        """What a user should know about the file, one line each."""
        return self._data.notes

    @cached_property
    def frames(self) -> Rows:
        """time_s, frame, tendon_moment_Nm (2,) of each frame."""
        return _kept(self._data.frame_columns())

    @cached_property
    def _sensors(self) -> dict[str, Rows]:
        return {name: self._sensor(i) for i, name in enumerate(self.sensor_names)}

    def _sensor(self, index: int) -> Rows:
        columns = self._data.sensor_columns(index)
        columns["status"] = words(columns["status"], _STATUSES)
        return _kept(columns)

    def write_csv(self, file: PathLike) -> None:
        """As tracker CSV (docs/reference/formats.md), to the micrometre. Raises InputError, also on a sensor's name that
        a CSV could not say."""
        path("file", file)
        self._data.write_csv(file)

    def __len__(self) -> int:
        return len(self._data)

    def __iter__(self) -> Iterator[Frame]:
        for i in range(len(self)):
            yield self._data.frame_at(i)

    @overload
    def __getitem__(self, key: str) -> Rows: ...
    @overload
    def __getitem__(self, key: int) -> Frame: ...
    def __getitem__(self, key: Union[str, int]) -> Union[Rows, Frame]:
        if isinstance(key, str):
            if key not in self._sensors:
                raise KeyError(f"sensor '{key}': the recording has {', '.join(self.sensor_names)}")
            return self._sensors[key]
        if isinstance(key, (int, np.integer)):
            index = int(key)
            if not -len(self) <= index < len(self):
                raise IndexError(f"frame {index} of {len(self)}")
            return self._data.frame_at(index)
        raise TypeError(f"key: {type(key).__name__}: expected the name of a sensor or the number of a frame")

    def __repr__(self) -> str:
        return f"Recording({self.source!r}, {len(self)} frames of {', '.join(self.sensor_names)})"


def _kept(columns: dict[str, Any]) -> Rows:
    """Read-only, for estimates are made of the recording itself."""
    rows = structured(columns)
    rows.flags.writeable = False
    return rows


def paths_of(name: str, value: Union[PathLike, Sequence[PathLike]]) -> list[bytes]:
    """One path, or several."""
    if is_path(value):
        return [path(name, value)]
    if isinstance(value, Sequence) and not isinstance(value, (bytes, bytearray)) and len(value) > 0:
        return [path(name, one) for one in value]
    raise TypeError(f"{name}: {type(value).__name__}: expected a path, or several in a list")


def is_session(name: str, value: Union[PathLike, Sequence[PathLike]], catheter_name: Optional[str]) -> bool:
    """A single path, to a file that begins as sessions do."""
    files = paths_of(name, value)
    # A pipe is left alone: what is read of it to see is gone.
    sessions = [file for file in files if os.path.isfile(file) and _palpate.looks_like_session(file)]
    if sessions and len(files) > 1:
        raise InputError(f"{shown(sessions[0])}: is a session: expected alone, for it has all of its run")
    if not sessions and catheter_name is not None:
        raise InputError("catheter_name: expected a session, which may hold several catheters")
    return bool(sessions)


def refuse_tendon(tendon: Optional[PathLike], session: bytes) -> None:
    if tendon is not None:
        file = shown(path("tendon", tendon))
        raise InputError(f"tendon {file}: expected none: {shown(session)} is a session, which has its own")


def read_recording(
    recording: Union[PathLike, Sequence[PathLike]],
    catheter: Optional[Catheter] = None,
    *,
    tendon: Optional[PathLike] = None,
    catheter_name: Optional[str] = None,
) -> Recording:
    """Reads a recording of any format that the command line reads: tracker CSV, PLUS .igs.mha, NDI CSV, MR coil text;
    with a catheter also marker CSV; and a session of `palpate record` or `palpate serve`.

    Without a catheter as it stands in the file. With one as `estimate` and ForceObserver.update_frame need it: several
    recordings merged by time, sensors in the order of the catheter (a tracked base last), stated delays taken off,
    known loads and the tendon's moment (`tendon`: tendon CSV) in its frames; checked that it can be of this catheter.

    A session (docs/reference/session.md) brings its catheter, the tendon's moment and what was said and done along:
    `recording.catheter`, `recording.events`; `catheter_name` chooses one of several. Frames that are not as they were
    written are left out, and a PalpateWarning tells; the others are those of read_estimate(), row by row. A tare or a
    new base changed the observer's catheter from its event on, which `recording.catheter` does not show.

    Raises InputError naming file, line, field, value and what was expected.
    """
    if is_session("recording", recording, catheter_name):
        return _read_session(paths_of("recording", recording)[0], catheter, tendon, catheter_name)
    files = paths_of("recording", recording)
    if catheter is not None:
        data, remarks = _palpate.Recording.read_bound(files, instance("catheter", catheter, Catheter), tendon)
        warn_all(remarks)
        return Recording._of(data)
    if len(files) > 1 or tendon is not None:
        raise TypeError("catheter: None: expected one with several recordings, or with a tendon CSV")
    return Recording._of(_palpate.Recording.read(files[0]))


def _read_session(
    file: bytes, catheter: Optional[Catheter], tendon: Optional[PathLike], catheter_name: Optional[str]
) -> Recording:
    refuse_tendon(tendon, file)
    data, session = _palpate.read_session_recording(file, name_of(catheter_name))
    remarks = list(session["damage"])
    if catheter is not None:
        data, more = data.bind(instance("catheter", catheter, Catheter), None)
        remarks += more
    warn_all(remarks, level=4)
    return Recording._of(data, session)
