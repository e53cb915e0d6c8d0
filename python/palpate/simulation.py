# SPDX-License-Identifier: Apache-2.0
"""Virtual experiments."""

from dataclasses import dataclass
from typing import Optional

from . import _palpate
from ._arguments import PathLike, Rows, flag, structured
from ._palpate import Catheter
from ._warnings import warn_all
from .recording import Recording


@dataclass(frozen=True)
class VirtualRun:
    """A virtual experiment.

    recording  what the tracker said, with the tendon's measured moment
    truth      structured array, row i is frame i: time_s, force_tip_N (3,), force_base_N (3,), stiffness_Nm2 (3,),
               precurvature_per_m (3,), p_base_tip_m (3,), R_base_tip (3, 3), in_contact
    catheter   what the operator believes: estimate(run.recording, run.catheter)
    catheter_toml  the same as a catheter file
    events     (time_s, what): contacts, instabilities
    """

    recording: Recording
    truth: Rows
    catheter: Catheter
    catheter_toml: str
    events: tuple[tuple[float, str], ...]


def simulate(
    scenario: PathLike,
    *,
    seed: Optional[int] = None,
    duration_s: Optional[float] = None,
    rate_hz: Optional[float] = None,
    noise_free: bool = False,
    stable_only: bool = False,
) -> VirtualRun:
    """Plays a scenario file (TOML, docs/howto/simulate.md), as `palpate simulate` does.

    seed, duration_s, rate_hz  in place of the scenario's
    noise_free   tracker and tendon channel make no error at all
    stable_only  an instability is an error, which names its load and time

    Raises InputError naming file, line, key and value. C++: palpate::run_scenario.
    """
    recording, truth, catheter, text, events = _palpate.simulate(
        scenario, seed, duration_s, rate_hz, flag("noise_free", noise_free), flag("stable_only", stable_only)
    )
    warn_all(catheter.warnings)
    return VirtualRun(Recording._of(recording), structured(truth), catheter, text, tuple(events))
