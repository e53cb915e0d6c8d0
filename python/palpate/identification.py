# SPDX-License-Identifier: Apache-2.0
"""Catheter and setup from measurements: stiffness, the unloaded shaft's arc, registration, noise, delay."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _palpate
from ._arguments import PathLike, flag, instance, is_path, path, read_only
from ._palpate import Catheter, Pose
from ._warnings import warn_all
from .estimation import Estimates
from .evaluation import Truth, truth_rows
from .recording import Recording

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class LoadCase:
    """The shaft at rest under one dead load.

    name             for messages
    force_base_N     (3,) at the contact point, base frame
    arc_length_m     (n,) of the points; NaN: not known, z of the point tells
    position_base_m  (n, 3); NaN: this component was not measured
    sigma_m          of each component; 0: unknown, told by the residuals
    """

    name: str
    force_base_N: ArrayLike
    arc_length_m: ArrayLike
    position_base_m: ArrayLike
    sigma_m: float = 0.0


@dataclass(frozen=True)
class StiffnessFit:
    """Arrays are read-only. unknowns: (name, value, sigma of its logarithm) each; stiffness_Nm2 (3,): EI1, EI2, GJ; catheter: the one given
    with the shaft as identified (its stated sigmas are kept)."""

    converged: bool
    unknowns: list[tuple[str, float, float]]
    stiffness_Nm2: Floats
    log_covariance: Floats
    rms_m: float
    chi_square: float
    degrees_of_freedom: int
    point_sigma_m: float
    iterations: int
    warnings: list[str]
    catheter: Catheter
    _found: _palpate.StiffnessFound = field(repr=False)

    def write(self, catheter: PathLike, out: PathLike) -> None:
        """As `palpate identify stiffness --catheter CATHETER --out OUT`: the catheter file, its order and comments kept,
        with the stiffness found, its sigma and correlation. catheter: the file from which the catheter was read.

        Raises InputError where the fit did not converge, `out` is the file itself, or the file differs from the catheter
        that was fitted in what the fit rests on: shaft, places of the sensors, base sigmas; of a load-case file also
        mountings, noise and base. Nothing is written then.
        """
        self._found.write(catheter, out)


def identify_stiffness(
    catheter: Catheter,
    cases: Union[PathLike, Sequence[LoadCase]],
    *,
    unknowns: str = "bending",
    method: str = "lm",
    poisson_ratio: Optional[float] = None,
    free_shear: bool = False,
) -> StiffnessFit:
    """Stiffness from the shape that known loads give the shaft (paper, section 5, Eq. (20)).

    cases     load-case file (TOML, docs/howto/identify_stiffness.md), or LoadCases
    unknowns  "bending" (EI1, EI2), "scale" (one factor), "bending,torsion"
    method    "lm" (Levenberg-Marquardt) or "nelder-mead" (the paper's)

    Raises InputError naming the cause; what the loads do not tell is a warning. C++: palpate::identify_stiffness.
    """
    instance("catheter", catheter, Catheter)
    given: Union[bytes, list[dict[str, Any]]]
    if is_path(cases):
        given = path("cases", cases)
    elif isinstance(cases, Sequence):
        given = [dict(vars(instance("cases", case, LoadCase))) for case in cases]
    else:
        raise TypeError(f"cases: {type(cases).__name__}: expected a load-case file or a list of palpate.LoadCase")
    free = flag("free_shear", free_shear)
    found = _palpate.identify_stiffness(catheter, given, unknowns, method, poisson_ratio, free)
    warn_all(found["warnings"])
    return StiffnessFit(**read_only(found))


@dataclass(frozen=True)
class ArcFit:
    """precurvature_per_m (3,): k1,0, k2,0, tau0; covariance (3, 3); told: which of them the data say; T_frame_base: the
    clamp as found, in the frame of the data."""

    converged: bool
    precurvature_per_m: Floats
    covariance: Floats
    told: list[bool]
    T_frame_base: Pose
    rms_m: float
    chi_square: float
    degrees_of_freedom: int
    doubtful: bool
    warnings: list[str]


def fit_arc(
    catheter: Catheter,
    data: Union[Recording, tuple[ArrayLike, ArrayLike]],
    *,
    interval: Optional[ArrayLike] = None,
    sigma_m: float = 0.0,
    clamp: Optional[str] = None,
) -> ArcFit:
    """Curvature of the unloaded shaft (paper, section 5.1).

    data      (arc_length_m (n,), position_m (n, 3)) of markers: a row of NaN was not seen and is left out, a column of
              NaN is a component that was not measured, as in a picture from one side; or a Recording at rest
    interval  (from_s, to_s) of the recording; sigma_m: of the points, 0: told by the residuals
    clamp     "exact": the frame of the data is the base frame (default of points); "stated": to the catheter's sigmas
              (default of a recording); "free": anywhere

    Raises InputError naming the cause. C++: palpate::fit_arc.
    """
    instance("catheter", catheter, Catheter)
    if isinstance(data, Recording):
        found = _palpate.fit_arc_to_recording(catheter, data._data, interval, clamp or "stated")
    elif isinstance(data, tuple) and len(data) == 2:
        found = _palpate.fit_arc_to_points(catheter, data[0], data[1], sigma_m, clamp or "exact")
    else:
        raise TypeError(f"data: {type(data).__name__}: expected a palpate.Recording or (arc_length_m, position_m)")
    warn_all(found["warnings"])
    return ArcFit(**found)


@dataclass(frozen=True)
class Registration:
    """Arrays are read-only. T_reference_base: the clamp in the tracker's frame (in the base sensor's where the base is tracked);
    base_covariance (6, 6): of position [m] and rotation [rad] in its own axes; precurvature_per_m (positions, 3)."""

    converged: bool
    T_reference_base: Pose
    base_covariance: Floats
    precurvature_per_m: Floats
    precurvature_sigma_per_m: Floats
    position_rms_m: float
    rotation_rms_rad: float
    chi_square: float
    degrees_of_freedom: int
    warnings: list[str]
    catheter: Catheter
    _found: _palpate.RegistrationFound = field(repr=False)

    def write(self, catheter: PathLike, out: PathLike) -> None:
        """As `palpate identify registration --catheter CATHETER --out OUT`: the catheter file, its order and comments
        kept, with the base found (of a tracked base its sensor's mounting), mountings where they were asked for, and
        their sigmas. catheter: the file from which the catheter was read.

        Raises InputError where `out` is the file itself, or the file differs from the catheter that was fitted in what
        the fit rests on: shaft (its stiffness under own weight alone), sensors. Nothing is written then.
        """
        self._found.write(catheter, out)


def identify_registration(
    catheter: Catheter,
    positions: Sequence[Union[Recording, tuple[Recording, ArrayLike]]],
    *,
    mounting: bool = False,
    mount_sigma_m: Optional[float] = None,
    mount_sigma_rad: Optional[float] = None,
) -> Registration:
    """Where the clamp stands, from the unloaded shaft at rest at several knob positions.

    positions  a Recording each, or (Recording, (from_s, to_s))
    mounting   how the sensors sit on the shaft is unknown, too

    Raises InputError naming the cause. C++: palpate::identify_registration.
    """
    instance("catheter", catheter, Catheter)
    pairs = [one if isinstance(one, tuple) else (one, None) for one in positions]
    stretches = [(instance("positions", pair[0], Recording)._data, pair[1]) for pair in pairs]
    found = _palpate.identify_registration(
        catheter, stretches, flag("mounting", mounting), mount_sigma_m, mount_sigma_rad
    )
    warn_all(found["warnings"])
    return Registration(**read_only(found))


@dataclass(frozen=True)
class RestNoise:
    """Noise of a sensor at rest: precision, not accuracy. covariance (6, 6): position in tracker axes [m], then
    rotation vector in sensor axes [rad]. untold: why nothing can be said; empty: all else holds. rest: still, drifts
    or moves."""

    untold: str
    used: int
    outliers: int
    covariance: Floats
    rest: str
    sigma_fraction: float
    correlation_time_s: float


@dataclass(frozen=True)
class MovingNoise:
    """Noise of a sensor that moves smoothly: sigma (6,): position along tracker axes [m], turn about sensor axes [rad].
    holds: the filter follows the motion well enough for it."""

    untold: str
    used: int
    holds: bool
    sigma: Floats
    sigma_fraction: Floats


def identify_rest_noise(recording: Recording, *, interval: Optional[ArrayLike] = None) -> dict[str, RestNoise]:
    """Noise of each sensor at rest, by name; interval (from_s, to_s). C++: palpate::identify_rest_noise."""
    data = instance("recording", recording, Recording)._data
    return {name: RestNoise(**found) for name, found in _palpate.identify_noise(data, interval, False).items()}


def identify_moving_noise(recording: Recording, *, interval: Optional[ArrayLike] = None) -> dict[str, MovingNoise]:
    """The same of smooth motion: what a Kalman filter cannot predict. C++: palpate::identify_moving_noise."""
    data = instance("recording", recording, Recording)._data
    return {name: MovingNoise(**found) for name, found in _palpate.identify_noise(data, interval, True).items()}


@dataclass(frozen=True)
class DelayFit:
    """delay_s > 0: the tracker's time stamps are later than the force sensor's. gain, offset_N (3,): F_tracker(t) =
    gain F_sensor(t - delay) + offset."""

    delay_s: float
    sigma_s: float
    gain: float
    gain_sigma: float
    offset_N: Floats
    rms_N: float
    explained: float
    ambiguous: bool
    used: int


def identify_delay(
    estimate: Estimates, truth: Truth, *, max_delay_s: float = 0.5, free_gain: bool = True
) -> DelayFit:
    """Time offset between a tracker, by the force it feels (smoothed: a filter that only looks back lags), and a force
    sensor. Frames that were not measured are left out. Raises InputError naming the cause.
    C++: palpate::identify_delay."""
    instance("estimate", estimate, Estimates)
    used = estimate.measured
    time_s, force_N = truth_rows(truth)
    found = _palpate.identify_delay(
        estimate.time_s[used], estimate.force_tip_N[used], estimate.sigma_tip_N[used], time_s, force_N, max_delay_s,
        flag("free_gain", free_gain),
    )
    return DelayFit(**found)
