# SPDX-License-Identifier: Apache-2.0
"""Arguments that are objects, and columns as structured arrays. Numbers are checked in the compiled module."""

import os
from collections.abc import Mapping
from typing import Any, Optional, TypeVar, Union

import numpy as np
from numpy.typing import NDArray

from ._palpate import InputError

PathLike = Union[str, "os.PathLike[str]"]
Rows = NDArray[np.void]
T = TypeVar("T")


def instance(name: str, value: object, kind: type[T]) -> T:
    """`value`, if it is of this class. Raises TypeError naming the argument."""
    if isinstance(value, kind):
        return value
    raise TypeError(f"{name}: {type(value).__name__}: expected palpate.{kind.__name__}")


def optional_instance(name: str, value: object, kind: type[T]) -> Optional[T]:
    return None if value is None else instance(name, value, kind)


def flag(name: str, value: object) -> bool:
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    raise TypeError(f"{name} = {value!r:.60}: expected True or False")


def is_path(value: object) -> bool:
    return isinstance(value, (str, os.PathLike))


def path(name: str, value: object) -> bytes:
    """A path in the file system's encoding. Raises TypeError or InputError naming the argument."""
    text = os.fspath(value) if isinstance(value, (str, os.PathLike)) else None
    if not isinstance(text, str):
        raise TypeError(f"{name}: {type(value).__name__}: expected a path (str or os.PathLike)")
    try:
        encoded = os.fsencode(text)
    except UnicodeEncodeError:
        expected = "a path that the file system's encoding can say"
        raise InputError(f"{name} = {text!r:.60}: expected {expected}") from None
    if b"\0" in encoded:
        raise InputError(f"{name} = {text!r:.60}: expected a path without a NUL")
    return encoded


def shown(file: bytes) -> str:
    """A path as messages have it, whatever its bytes."""
    return file.decode("utf-8", "backslashreplace")


def read_only(fields: dict[str, Any]) -> dict[str, Any]:
    """What other results rest on already: an array that could be edited would be seen to change, and they would not."""
    for value in fields.values():
        if isinstance(value, np.ndarray):
            value.flags.writeable = False
    return fields


def structured(columns: Mapping[str, NDArray[Any]]) -> Rows:
    """Columns of equal length, side by side: row["name"], rows["name"]."""
    dtype = np.dtype([(name, column.dtype, column.shape[1:]) for name, column in columns.items()], align=True)
    rows = np.zeros(len(next(iter(columns.values()))), dtype)
    for name, column in columns.items():
        rows[name] = column
    return rows


def words(numbers: NDArray[Any], names: list[str]) -> NDArray[np.str_]:
    """The word for each number."""
    known: NDArray[np.str_] = np.array(names, dtype=np.str_)
    return np.take(known, numbers)


def numbers_of(texts: NDArray[Any], names: list[str], name: str) -> NDArray[np.int32]:
    """The number of each word. Raises InputError on an unknown one."""
    known = {text: i for i, text in enumerate(names)}
    unique, where = np.unique(texts, return_inverse=True)
    for text in unique:
        if str(text) not in known:
            raise InputError(f"{name}: '{text}': expected one of {', '.join(names)}")
    return np.array([known[str(text)] for text in unique], dtype=np.int32)[where]
