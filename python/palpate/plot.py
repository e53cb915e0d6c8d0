# SPDX-License-Identifier: Apache-2.0
"""Pictures with matplotlib, which is imported only when one is drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np
from numpy.typing import NDArray

from . import _palpate
from ._arguments import PathLike, instance
from .estimation import Estimates, read_estimate
from .evaluation import Truth, force_sizes, truth_rows
from .rod import Shape

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from mpl_toolkits.mplot3d.axes3d import Axes3D

_SIGMAS_OF_95 = 1.959963984540054
_UNITS = {"N": 1.0, "mN": 1e3, "g": float(_palpate.GRAMS_FORCE_PER_NEWTON)}
_LOOK = {
    "size": ("|F|", "#20527a"),
    "x": ("Fx (d1)", "#b1491c"),
    "y": ("Fy (d2)", "#3b7d3c"),
    "z": ("Fz (d3)", "#6a4a9c"),
}
_MILLIMETRES_PER_METRE = 1e3
_AXES = ("#b1491c", "#3b7d3c", "#6a4a9c")


def force_curve(
    estimate: Estimates, component: str = "size"
) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Time, force, and the ends of its 95 % interval [s, N], as plot_force draws them: NaN where nothing was measured.

    component  "size": |F|; "x", "y", "z": along d1, d2, d3
    """
    if component not in _LOOK:
        raise _palpate.InputError(f"component = {component!r:.40}: expected one of {', '.join(_LOOK)}")
    sizes = force_sizes(instance("estimate", estimate, Estimates))
    if component == "size":
        value, sigma = sizes.size_N, sizes.sigma_N
        low = np.maximum(value - _SIGMAS_OF_95 * sigma, 0.0)
    else:
        axis = "xyz".index(component)
        value, sigma = estimate.force_tip_N[:, axis], estimate.sigma_tip_N[:, axis]
        low = value - _SIGMAS_OF_95 * sigma
    gap = np.where(sizes.measured, 0.0, np.nan)
    return estimate.time_s, value + gap, low + gap, value + _SIGMAS_OF_95 * sigma + gap


def true_curve(truth: Truth, component: str = "size") -> tuple[NDArray[Any], NDArray[Any]]:
    """Time and true force [s, N]."""
    time_s, force_N = truth_rows(truth)
    return time_s, np.linalg.norm(force_N, axis=1) if component == "size" else force_N[:, "xyz".index(component)]


def plot_force(
    estimate: Union[Estimates, PathLike],
    truth: Optional[Truth] = None,
    *,
    unit: str = "g",
    components: tuple[str, ...] = ("size",),
    ax: Optional[Axes] = None,
) -> Axes:
    """Draws force over time with its 95 % band, as the report does: a gap where nothing was measured.

    estimate    Estimates, or an estimate CSV
    truth       as of evaluate(): drawn dashed
    unit        "g" (grams-force), "N" or "mN"
    components  of "size" (|F|), "x", "y", "z" (along d1, d2, d3)
    ax          matplotlib axes to draw on; default: new ones. Returned.
    """
    if unit not in _UNITS:
        raise _palpate.InputError(f"unit = {unit!r:.40}: expected one of {', '.join(_UNITS)}")
    if not isinstance(estimate, Estimates):
        estimate = read_estimate(estimate)
    axes = _new_axes() if ax is None else ax
    scale = _UNITS[unit]
    for component in (components,) if isinstance(components, str) else components:
        time_s, value, low, high = force_curve(estimate, component)
        label, colour = _LOOK[component]
        axes.fill_between(time_s, scale * low, scale * high, color=colour, alpha=0.2, linewidth=0)
        axes.plot(time_s, scale * value, color=colour, linewidth=1.2, label=f"{label}, 95 % band")
        if truth is not None:
            true_time_s, true_N = true_curve(truth, component)
            known = "true" not in axes.get_legend_handles_labels()[1]
            axes.plot(true_time_s, scale * true_N, color="#444444", linewidth=0.9, linestyle="--",
                      label="true" if known else None)
    axes.set_xlabel("time [s]")
    axes.set_ylabel(f"force on the tip [{unit}]")
    axes.margins(x=0.0)
    axes.grid(True, color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    above = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "ncols": 4}
    axes.legend(**above, frameon=False, fontsize="small", borderaxespad=0.2)
    return axes


def _new_axes() -> Any:
    from matplotlib import pyplot

    return pyplot.subplots(figsize=(9.0, 3.6), layout="constrained")[1]


def plot_shape(shape: Shape, *, force_mm_per_N: float = 100.0, ax: Optional[Axes3D] = None) -> Axes3D:
    """Draws the shaft in the base frame [mm], with the axes d1, d2, d3 at its flexible end and the force as an arrow of
    force_mm_per_N. Equal scales on all axes. Returns the 3-D axes (ax, or new ones)."""
    instance("shape", shape, Shape)
    axes = _new_axes3d() if ax is None else ax
    line = _MILLIMETRES_PER_METRE * shape.position_base_m
    tip = _MILLIMETRES_PER_METRE * shape.T_base_tip.p
    axes.plot(*line.T, color="#20527a", linewidth=2.5, label="shaft")
    length = 0.12 * _span(line)
    for i, colour in enumerate(_AXES):
        axes.quiver(*tip, *(length * shape.T_base_tip.R[:, i]), color=colour, linewidth=1.2, label=f"d{i + 1}")
    force = shape.T_base_tip.R @ shape.force_tip_N
    if np.any(force != 0.0):
        label = f"force, {np.linalg.norm(force):.3g} N"
        axes.quiver(*tip, *(force_mm_per_N * force), color="black", linewidth=1.8, label=label)
    _scale_alike(axes, np.vstack([line, tip + force_mm_per_N * force]))
    axes.set_xlabel("e1 [mm]")
    axes.set_ylabel("e2 [mm]")
    axes.set_zlabel("e3 [mm]")
    axes.legend(loc="upper left", fontsize="small")
    return axes


def _new_axes3d() -> Any:
    from matplotlib import pyplot

    return pyplot.figure(figsize=(6.0, 6.0)).add_axes((0.0, 0.04, 0.88, 0.94), projection="3d")


def _span(points: NDArray[Any]) -> float:
    return float(np.ptp(points, axis=0).max())


def _scale_alike(axes: Any, points: NDArray[Any]) -> None:
    middle, half = (points.min(axis=0) + points.max(axis=0)) / 2.0, 0.55 * max(_span(points), 1.0)
    for i, name in enumerate("xyz"):
        getattr(axes, f"set_{name}lim")(middle[i] - half, middle[i] + half)
    axes.set_box_aspect((1.0, 1.0, 1.0))
