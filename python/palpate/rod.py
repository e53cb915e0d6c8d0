# SPDX-License-Identifier: Apache-2.0
"""The loaded shaft: one rod, or many at a time.

R' = R hat(u), r' = R e3, K (u - u0) = R_T^T (M - r_T x F): docs/theory/rod.md, Eqs. (1)-(7) of the paper.
"""

from dataclasses import dataclass
from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _palpate
from ._arguments import flag, instance
from ._palpate import Catheter, Pose

Floats = NDArray[np.float64]
_ZERO = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Shape:
    """The shaft under one load, at n places.

    arc_length_m       (n,)       from the clamp
    position_base_m    (n, 3)     centre line, base frame [m]
    R_base_local       (n, 3, 3)  columns d1, d2, d3
    curvature_per_m    (n, 3)     (k1, k2, tau), local [1/m]
    force_local_N, moment_local_Nm  (n, 3)  internal, of the distal on the proximal part
    T_base_tip         Pose of the flexible end
    force_tip_N        (3,)       the load
    converged          False: the load is beyond the integrator's reach (a thousand times a catheter's) or not finite, or the
                       Newton loop around the shaft's own weight found no answer
    d_rotation         (n, 3, 3)  column j: by tip force component j [rad/N], body side: dR = R hat(d_rotation dF)
    d_position_m       (n, 3, 3)  [m/N], base components
    d_curvature_per_m  (n, 3, 3)  [1/(m N)]; these three None unless sensitivities were asked for
    """

    arc_length_m: Floats
    position_base_m: Floats
    R_base_local: Floats
    curvature_per_m: Floats
    shear_strain: Floats
    force_local_N: Floats
    moment_local_Nm: Floats
    T_base_tip: Pose
    force_tip_N: Floats
    converged: bool
    d_rotation: Optional[Floats] = None
    d_position_m: Optional[Floats] = None
    d_curvature_per_m: Optional[Floats] = None


def solve(
    catheter: Catheter,
    force_tip_N: ArrayLike = _ZERO,
    *,
    moment_tip_Nm: ArrayLike = _ZERO,
    tendon_couple_Nm: ArrayLike = _ZERO,
    log_stiffness: ArrayLike = _ZERO,
    precurvature_per_m: ArrayLike = _ZERO,
    arc_lengths_m: Optional[ArrayLike] = None,
    sensitivities: bool = False,
    accuracy: str = "reference",
) -> Shape:
    """Shape of the shaft under a tip load in tip components.

    force_tip_N, moment_tip_Nm  (3,): of the tissue on the tip, along d1, d2, d3 of the flexible end
    tendon_couple_Nm   (3,): constant in local components along the shaft
    log_stiffness      (3,): of (EI1, EI2, GJ) over those described
    precurvature_per_m (3,): added to that described
    arc_lengths_m      (n,): places, 0 to length plus rigid tip; default 51 at equal steps
    accuracy           "reference" (1e-8 of the length) or "realtime" (1e-6, as the observer)

    The shaft's own weight counts where the catheter has it. Raises InputError naming the argument. One integration,
    some microseconds (a few with weight). C++: palpate::solve_under_weight, palpate/rod/base_loads.hpp.
    """
    instance("catheter", catheter, Catheter)
    if arc_lengths_m is None:
        arc_lengths_m = np.linspace(0.0, catheter.length_m + catheter.rigid_tip_m, 51)
    load = {
        "force_tip_N": force_tip_N,
        "moment_tip_Nm": moment_tip_Nm,
        "tendon_couple_Nm": tendon_couple_Nm,
        "log_stiffness": log_stiffness,
        "precurvature_per_m": precurvature_per_m,
    }
    found = _palpate.solve(catheter, load, arc_lengths_m, flag("sensitivities", sensitivities), accuracy)
    places = np.array(arc_lengths_m, dtype=np.float64)
    return Shape(arc_length_m=places, force_tip_N=np.array(force_tip_N, dtype=np.float64), **found)


@dataclass(frozen=True)
class BatchPoints:
    """One place of n rods; fields as of Shape, first index the rod. Views of the batch's own memory, not copies: a
    rod's components do not lie side by side (numpy.ascontiguousarray puts them so). converged (n,): False where the
    load is beyond the integrator's reach, or not finite."""

    position_base_m: Floats
    R_base_local: Floats
    curvature_per_m: Floats
    converged: NDArray[np.bool_]
    d_rotation: Optional[Floats] = None
    d_position_m: Optional[Floats] = None
    d_curvature_per_m: Optional[Floats] = None


@dataclass(frozen=True)
class BatchShapes:
    """Flexible ends, and the places that were asked for, of many rods."""

    tip: BatchPoints
    stations: tuple[BatchPoints, ...]

    @property
    def converged(self) -> NDArray[np.bool_]:
        """(n,), as of each of the points."""
        return self.tip.converged


def solve_batch(
    catheter: Catheter,
    forces_tip_N: ArrayLike,
    *,
    moments_tip_Nm: Optional[ArrayLike] = None,
    tendon_couples_Nm: Optional[ArrayLike] = None,
    log_stiffness: Optional[ArrayLike] = None,
    precurvature_per_m: Optional[ArrayLike] = None,
    arc_lengths_m: ArrayLike = (),
    sensitivities: bool = False,
    workers: int = 0,
    accuracy: str = "realtime",
) -> BatchShapes:
    """The catheter's shaft under n loads, in SIMD lanes and over the cores; other Python threads run meanwhile.

    forces_tip_N and the other loads (n, 3), as of solve(); C-contiguous float64 is used where it lies. workers:
    threads, 0 for one a core, without effect on the results. A rod's result does not depend on the others.

    Raises InputError naming the argument, also on a shaft with own weight. About 0.2 us a rod and core.
    C++: palpate::solve_batch, palpate/batch/batch.hpp, docs/theory/batch.md.
    """
    instance("catheter", catheter, Catheter)
    loads: dict[str, Any] = {
        "forces_tip_N": forces_tip_N,
        "moments_tip_Nm": moments_tip_Nm,
        "tendon_couples_Nm": tendon_couples_Nm,
        "log_stiffness": log_stiffness,
        "precurvature_per_m": precurvature_per_m,
    }
    tip, stations = _palpate.solve_batch(
        catheter, loads, arc_lengths_m, flag("sensitivities", sensitivities), workers, accuracy
    )
    return BatchShapes(BatchPoints(**tip), tuple(BatchPoints(**points) for points in stations))
