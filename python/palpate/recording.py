# SPDX-License-Identifier: Apache-2.0
"""Recordings of trackers as numpy arrays."""

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import Optional, Union, overload

import numpy as np
from numpy.typing import ArrayLike

from . import _palpate
from ._arguments import PathLike, Rows, instance, is_path, path, structured, words
from ._palpate import Catheter, Frame
from ._warnings import warn_all

_STATUSES = ["MISSING", "OK", "ABSENT"]


class Recording:
    """What a tracker said over time, as received.

    recording["tip"]   structured array, a row a frame: status ("OK", "MISSING", "ABSENT": the frame does not speak of
                       this sensor), quaternion_wxyz (4,) sensor to tracker, position_m (3,), error_m.
                       NaN where nothing was said.
    recording.frames   structured array: time_s, frame, tendon_moment_Nm (2,) (NaN where there is none)
    recording[0]       a Frame, for ForceObserver.update_frame; iterating gives all

    From arrays of your own: Recording(time_s, {"tip": (position_m, quaternion_wxyz), ...}) with (n, 3) and (n, 4)
    arrays; None for the quaternions of a point; rows of NaN for what was not seen.
    """

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
    def _of(cls, data: "_palpate.Recording") -> "Recording":
        recording = cls.__new__(cls)
        recording._data = data
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
        return structured(self._data.frame_columns())

    @cached_property
    def _sensors(self) -> dict[str, Rows]:
        return {name: self._sensor(i) for i, name in enumerate(self.sensor_names)}

    def _sensor(self, index: int) -> Rows:
        columns = self._data.sensor_columns(index)
        columns["status"] = words(columns["status"], _STATUSES)
        return structured(columns)

    def write_csv(self, file: PathLike) -> None:
        """As tracker CSV (docs/reference/formats.md), to the micrometre. Raises InputError."""
        self._data.write_csv(path("file", file))

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
            return self._data.frame_at(int(key))
        raise TypeError(f"key: {type(key).__name__}: expected the name of a sensor or the number of a frame")

    def __repr__(self) -> str:
        return f"Recording({self.source!r}, {len(self)} frames of {', '.join(self.sensor_names)})"


def paths_of(name: str, value: Union[PathLike, Sequence[PathLike]]) -> list[str]:
    """One path, or several."""
    if is_path(value):
        return [path(name, value)]
    if isinstance(value, Sequence) and len(value) > 0:
        return [path(name, one) for one in value]
    raise TypeError(f"{name}: {type(value).__name__}: expected a path, or several in a list")


def read_recording(
    recording: Union[PathLike, Sequence[PathLike]],
    catheter: Optional[Catheter] = None,
    *,
    tendon: Optional[PathLike] = None,
) -> Recording:
    """Reads a recording of any format that the command line reads: tracker CSV, PLUS .igs.mha, NDI CSV, MR coil text;
    with a catheter also marker CSV.

    Without a catheter as it stands in the file. With one as `estimate` and ForceObserver.update_frame need it: several
    recordings merged by time, sensors in the order of the catheter (a tracked base last), stated delays taken off,
    known loads and the tendon's moment (`tendon`: tendon CSV) in its frames; checked that it can be of this catheter.

    Raises InputError naming file, line, field, value and what was expected.
    """
    files = paths_of("recording", recording)
    if catheter is not None:
        data, remarks = _palpate.Recording.read_bound(files, instance("catheter", catheter, Catheter), tendon)
        warn_all(remarks)
        return Recording._of(data)
    if len(files) > 1 or tendon is not None:
        raise TypeError("catheter: None: expected one with several recordings, or with a tendon CSV")
    return Recording._of(_palpate.Recording.read(files[0]))
