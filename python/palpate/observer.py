# SPDX-License-Identifier: Apache-2.0
"""The live observer: a tracker frame in, an estimate out."""

from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _palpate
from ._arguments import instance
from ._palpate import Catheter, Estimate, Frame


class ForceObserver:
    """Feels the force on a catheter's tip through its shape, frame by frame.

    Options are those of palpate::ObserverOptions by name, in place of the catheter file's: method ("ekf", "iekf",
    "iaekf", "ukf"), measurement ("poses", "tip_and_curvature"), force_model ("random_walk", "constant_velocity",
    "gauss_markov", "rhythm"), state (["force", "stiffness", "precurvature"]), consider_uncertainty,
    initial_force_sigma_N, ...; `options` lists all with their values. Defaults, ranges, effects:
    palpate/observer/options.hpp. Raises InputError on an unknown name or a value out of range.

    One object a catheter and a thread. An update takes some microseconds. C++: palpate::ForceObserver.
    """

    def __init__(self, catheter: Catheter, **options: Any) -> None:
        self._observer = _palpate.Observer(instance("catheter", catheter, Catheter), options)

    def __reduce_ex__(self, protocol: Any) -> Any:
        """Of the filter's state there is one: a copy would share it."""
        raise TypeError("palpate.ForceObserver: cannot be pickled or copied: make another of the same catheter")

    @property
    def options(self) -> dict[str, Any]:
        """All options with their values."""
        return self._observer.options

    def update(
        self,
        time_s: float,
        position_m: ArrayLike,
        quaternion_wxyz: Optional[ArrayLike] = None,
        *,
        tendon_moment_Nm: Optional[ArrayLike] = None,
        tendon_sigma_Nm: Optional[float] = None,
    ) -> Estimate:
        """What is known after a frame.

        position_m       (sensors, 3): origins in the tracker's frame, in the order of catheter.sensors, a tracked base
                         last; a row of NaN: not seen
        quaternion_wxyz  (sensors, 4): sensor to tracker, scalar first; a row of NaN, or None for all: a point only
        tendon_moment_Nm (2,): of the tendon, about d1 and d2; tendon_sigma_Nm: its standard deviation, default the
                         catheter's share

        Frames in time order. Never raises over what a tracker may say: a time that stands still, NaN in a part of a
        pose or a broken quaternion are told by `status` and `rejections`. Raises InputError on a wrong shape or type.
        """
        return self._observer.update(time_s, position_m, quaternion_wxyz, tendon_moment_Nm, tendon_sigma_Nm)

    def update_frame(self, frame: Frame) -> Estimate:
        """The same of a frame of a Recording that was read for this catheter."""
        return self._observer.update_frame(instance("frame", frame, Frame))

    def forecast(self, ahead_s: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Force `ahead_s` after the latest frame, tip axes: mean (3,) [N] and covariance (3, 3) [N^2]. 0 to 60 s."""
        return self._observer.forecast(ahead_s)
