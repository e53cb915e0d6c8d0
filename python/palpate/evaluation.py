# SPDX-License-Identifier: Apache-2.0
"""An estimate held against a force sensor."""

import os
from dataclasses import dataclass
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from . import _palpate
from ._arguments import PathLike, Rows, path, structured
from .estimation import Estimates, columns_of, read_estimate

Floats = NDArray[np.float64]
Truth = Union[PathLike, Rows]


@dataclass(frozen=True)
class Evaluation:
    """Figures of the paper's Table 7, and whether the sigmas are true; (3,) along d1, d2, d3. error = estimate - truth.

    frames         judged: after the first skip_s, inside the truth's time span
    outside_truth  after it, but outside that span
    updated        of `frames`, those whose state was updated
    mean_N, sigma_N, rmse_N, largest_N   of the error
    inside_95, inside_3_sigma            share of frames with |error| <= 1.96, 3 sigma
    mean_nees      normalised estimation error squared; 3 if the covariance is true
    indefinite     frames without a valid covariance, not in mean_nees
    """

    frames: int
    outside_truth: int
    updated: int
    mean_N: Floats
    sigma_N: Floats
    rmse_N: Floats
    largest_N: Floats
    inside_95: Floats
    inside_3_sigma: Floats
    mean_nees: float
    indefinite: int


@dataclass(frozen=True)
class ForceSizes:
    """An entry a frame (n,): |F| [N], its sigma [N] to second order, whether it was measured."""

    time_s: Floats
    size_N: Floats
    sigma_N: Floats
    measured: NDArray[np.bool_]


def read_forces(path: PathLike) -> Rows:
    """Reads a force CSV: structured array with time_s, force_tip_N (3,) and, where the file has it, force_base_N (3,).
    Raises InputError naming file, line, field and value."""
    return structured(_palpate.read_forces(path))


def truth_rows(truth: Truth) -> tuple[NDArray[Any], NDArray[Any]]:
    """Times and forces of a force CSV, or of a structured array with time_s and force_tip_N."""
    if isinstance(truth, (str, os.PathLike)):
        path("truth", truth)
        truth = read_forces(truth)
    names = getattr(getattr(truth, "dtype", None), "names", None) or ()
    if isinstance(truth, np.ndarray) and {"time_s", "force_tip_N"} <= set(names):
        return truth["time_s"], truth["force_tip_N"]
    raise TypeError(
        f"truth: {type(truth).__name__}: expected a force CSV, or an array with fields time_s and force_tip_N"
    )


def estimate_columns(estimate: Union[Estimates, PathLike]) -> dict[str, NDArray[Any]]:
    """Of estimates, or of an estimate CSV."""
    if isinstance(estimate, (str, os.PathLike)):
        path("estimate", estimate)
        estimate = read_estimate(estimate)
    if not isinstance(estimate, Estimates):
        raise TypeError(f"estimate: {type(estimate).__name__}: expected palpate.Estimates or an estimate CSV")
    return columns_of(estimate.rows)


def evaluate(estimate: Union[Estimates, PathLike], truth: Truth, *, skip_s: float = 1.0) -> Evaluation:
    """Holds an estimate against the true force, interpolated linearly in time; the first skip_s are left out, every
    other frame counts, held ones too.

    truth  force CSV, or an array as read_forces() and simulate() give

    Raises InputError where nothing is left to judge. C++: palpate::evaluate.
    """
    time_s, force_tip_N = truth_rows(truth)
    return Evaluation(**_palpate.evaluate(estimate_columns(estimate), time_s, force_tip_N, skip_s))


def force_sizes(estimate: Union[Estimates, PathLike]) -> ForceSizes:
    """|F| of every frame with its sigma: what the report draws. C++: palpate::force_sizes."""
    return ForceSizes(**_palpate.force_sizes(estimate_columns(estimate)))
