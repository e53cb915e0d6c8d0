# SPDX-License-Identifier: Apache-2.0
"""Force over time from a whole recording."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _palpate
from ._arguments import PathLike, Rows, flag, instance, numbers_of, structured, words
from ._arguments import path as path_of
from ._palpate import Catheter, InputError
from ._session import SessionEvent, events_of, name_of
from ._warnings import warn_all
from .recording import Recording, is_session, paths_of, refuse_tendon

Floats = NDArray[np.float64]
_NEEDED = ("time_s", "force_tip_N", "covariance_tip_N2", "status")


@dataclass(frozen=True)
class Tare:
    """What a stretch without tip force said of base and precurvature (C++: palpate::Tare)."""

    frames: int
    base_shift_m: Floats
    base_rotation_rad: Floats
    precurvature_change_per_m: Floats
    largest_change_sigmas: float


@dataclass(frozen=True)
class Estimates:
    """One row for every frame; estimates["name"] is a column of `rows`:

    time_s                         of the frame [s]
    force_tip_N        (3,)        of the tissue on the tip, along d1, d2, d3
    covariance_tip_N2  (3, 3)      of all that is not known exactly, not of the noise alone
    force_base_N       (3,)        the same force in the clamp's frame; R_base_tip (3, 3) turns one into the other
    status                         UPDATED, RESEEDED, AMBIGUOUS, REJECTED, HELD, NOT_CONVERGED
    sensors_used, nis, dof, evaluations
    stiffness_Nm2, precurvature_per_m  (3,), each with _sigma_: estimated, or as stated
    sigma_by_source_N  (7, 3)      what the sigma is made of, rows as palpate.estimation.SOURCES
    forecast_tip_N (3,), forecast_covariance_N2 (3, 3)  where forecast_s was given

    Read from a file, only those that the file has and that are needed to judge it. HELD and REJECTED rows carry the
    predicted force with its grown covariance; `measured` leaves them out.
    """

    rows: Rows
    catheter: Optional[Catheter] = None  # as the reference interval corrects it; of a session as it began
    tare: Optional[Tare] = None
    warnings: tuple[str, ...] = field(default=())
    events: tuple[SessionEvent, ...] = field(default=())  # of a session

    def __post_init__(self) -> None:
        names = getattr(getattr(self.rows, "dtype", None), "names", None) or ()
        missing = [name for name in _NEEDED if name not in names]
        if missing or np.ndim(self.rows) != 1:
            kind = type(self.rows).__name__
            raise TypeError(f"rows: {kind}: expected a structured array (n,) with fields {', '.join(_NEEDED)}")

    @property
    def time_s(self) -> Floats:
        return self["time_s"]

    @property
    def force_tip_N(self) -> Floats:
        """(n, 3)"""
        return self["force_tip_N"]

    @property
    def covariance_tip_N2(self) -> Floats:
        """(n, 3, 3)"""
        return self["covariance_tip_N2"]

    @property
    def sigma_tip_N(self) -> Floats:
        """(n, 3): one standard deviation along each axis."""
        return np.sqrt(np.diagonal(self.covariance_tip_N2, axis1=1, axis2=2))

    @property
    def status(self) -> NDArray[np.str_]:
        return self["status"]

    @property
    def measured(self) -> NDArray[np.bool_]:
        """UPDATED or RESEEDED: a predicted or ambiguous force is counted by no figure."""
        measured: NDArray[np.bool_] = _palpate.force_sizes(columns_of(self.rows))["measured"]
        return measured

    def __getitem__(self, column: str) -> NDArray[Any]:
        return self.rows[column]

    def __len__(self) -> int:
        return len(self.rows)


SOURCES: list[str] = _palpate.SOURCES
"""Rows of sigma_by_source_N: noise, bias, stiffness, ..."""


def columns_of(rows: Rows) -> dict[str, NDArray[Any]]:
    """What the compiled module needs of estimates."""
    columns: dict[str, NDArray[Any]] = {name: rows[name] for name in ("time_s", "force_tip_N", "covariance_tip_N2")}
    columns["status"] = numbers_of(rows["status"], _palpate.STATUSES, "estimate.status")
    return columns


def _rows(columns: dict[str, NDArray[Any]]) -> Rows:
    columns["status"] = words(columns["status"], _palpate.STATUSES)
    return structured(columns)


def estimate(
    recording: Union[Recording, PathLike, Sequence[PathLike]],
    catheter: Catheter,
    *,
    catheter_name: Optional[str] = None,
    tendon: Optional[PathLike] = None,
    reference: Optional[ArrayLike] = None,
    smooth: bool = False,
    strict: bool = False,
    **options: Any,
) -> Estimates:
    """The force of every frame, with the numbers of `palpate estimate`.

    recording  a Recording, a path, or several paths that are merged by time; of a session (`palpate record`, `palpate
               serve`) the frames are estimated anew: read_estimate() gives what was felt live
    catheter_name  which catheter of a session that has several
    tendon     tendon CSV beside it: moment or tension over time, or where the handle stands
    reference  (from_s, to_s) without tip force: corrects base and precurvature
    smooth     use later frames as well: each force in the light of the whole recording
    strict     make every reading that would be passed over an error
    options    as of ForceObserver

    Raises InputError with the message of the command line; warns with PalpateWarning. Other threads run meanwhile.
    About 10 us a frame. C++: palpate::ForceObserver, palpate::SmoothingPass.
    """
    instance("catheter", catheter, Catheter)
    _palpate.check_options(catheter, options)
    source: Union[_palpate.Recording, list[bytes]]
    damage: list[str] = []
    if isinstance(recording, Recording):
        if catheter_name is not None:
            raise InputError("catheter_name: expected a session's path: this recording was read of one catheter already")
        source = recording._data
    elif is_session("recording", recording, catheter_name):
        file = paths_of("recording", recording)[0]
        refuse_tendon(tendon, file)
        source, session = _palpate.read_session_recording(file, name_of(catheter_name))
        damage = session["damage"]
    else:
        source = paths_of("recording", recording)
    columns, corrected, remarks, tare = _palpate.estimate(
        source, catheter, tendon, reference, flag("smooth", smooth), flag("strict", strict), options
    )
    return Estimates(_rows(columns), corrected, None if tare is None else Tare(**tare), warn_all(damage + remarks))


def read_estimate(path: PathLike, *, catheter_name: Optional[str] = None) -> Estimates:
    """Reads an estimate CSV of `palpate estimate`, or what a session of `palpate record` or `palpate serve` felt live.

    A session has all columns, bit for bit as they went out (forecast_* only where it was asked for), and its catheter,
    as it began, and events beside them; `catheter_name` chooses one of several. Rows that are not as they were written
    are left out, and a PalpateWarning tells. time_s is the device's; read_recording(path).frames, row by row the same,
    has the host's.

    Raises InputError naming file, line, field and value.
    """
    file = path_of("path", path)
    if not is_session("path", path, catheter_name):
        return Estimates(_rows(_palpate.read_estimate(path)))
    columns, session = _palpate.read_session_estimates(file, name_of(catheter_name))
    damage = warn_all(session["damage"])
    return Estimates(_rows(columns), session["catheter"], None, damage, events_of(session))
