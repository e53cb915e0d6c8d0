# SPDX-License-Identifier: Apache-2.0
"""Palpate: the force on a catheter's tip, felt through its shape.

    import palpate
    catheter = palpate.Catheter.from_toml("catheter.toml")
    estimates = palpate.estimate("run.tracker.csv", catheter)
    palpate.plot.plot_force(estimates)

Everything is SI, with the unit in the name: `force_tip_N`, `length_m`. Tip components are along d1, d2 (across) and d3
(the tangent) at the flexible end; the base frame stands at the clamp, e3 along the straight shaft. `T_a_b` maps b to a.
Arrays go in as anything numpy understands (lists, other number types, strided or read-only arrays) and come out as
float64.

Bad input raises `InputError` (a ValueError) with the message that the command line prints: place, value, expectation.
An object of the wrong class raises TypeError. What a user should know but need not act upon is a `PalpateWarning`.

The code is C++ (palpate/, docs/); this package gives it Python's shape and adds nothing to its mathematics.
Research software: no medical device.
"""

from . import plot
from ._palpate import Catheter, Estimate, Frame, InputError, Observability, Pose, Section, Sensor
from ._palpate import version as __version__
from ._session import SessionEvent
from ._warnings import PalpateWarning
from .estimation import Estimates, Tare, estimate, read_estimate
from .evaluation import Evaluation, ForceSizes, evaluate, force_sizes, read_forces
from .identification import (
    ArcFit,
    DelayFit,
    LoadCase,
    MovingNoise,
    Registration,
    RestNoise,
    StiffnessFit,
    fit_arc,
    identify_delay,
    identify_moving_noise,
    identify_registration,
    identify_rest_noise,
    identify_stiffness,
)
from .observer import ForceObserver
from .recording import Recording, read_recording
from .rod import BatchPoints, BatchShapes, Shape, solve, solve_batch
from .simulation import VirtualRun, simulate

InputError.__module__ = "palpate"

__all__ = [
    "ArcFit", "BatchPoints", "BatchShapes", "Catheter", "DelayFit", "Estimate", "Estimates", "Evaluation",
    "ForceObserver", "ForceSizes", "Frame", "InputError", "LoadCase", "MovingNoise", "Observability",
    "PalpateWarning", "Pose", "Recording", "Registration", "RestNoise", "Section", "Sensor", "SessionEvent",
    "Shape", "StiffnessFit", "Tare", "VirtualRun", "__version__", "estimate", "evaluate", "fit_arc", "force_sizes",
    "identify_delay", "identify_moving_noise", "identify_registration", "identify_rest_noise", "identify_stiffness",
    "plot", "read_estimate", "read_forces", "read_recording", "simulate", "solve", "solve_batch",
]
