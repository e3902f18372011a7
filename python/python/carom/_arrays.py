"""What users give, as the arrays that the extension takes: float64 and int64, checked, as bytes."""

from __future__ import annotations

from typing import Any, NamedTuple, Optional, Sequence

import numpy as np

INFINITY = float("inf")


class Sparse(NamedTuple):
    """A matrix by rows: where rows begin, columns, values."""

    starts: np.ndarray
    columns: np.ndarray
    values: np.ndarray

    def to_bytes(self) -> "tuple[bytes, bytes, bytes]":
        return self.starts.tobytes(), self.columns.tobytes(), self.values.tobytes()


def numbers(name: str, value: Any) -> np.ndarray:
    """A dense array of float64."""
    if np.iscomplexobj(value):
        raise TypeError(f"`{name}` is complex; only real numbers can be optimised")
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise TypeError(
            f"`{name}` must be an array of numbers, and numpy cannot make one of {type(value).__name__}: {error}"
        ) from error


def vector(name: str, value: Any, size: int, default: float) -> np.ndarray:
    """A vector of a size; `None` is the default everywhere, and a scalar is the same everywhere."""
    if value is None:
        return np.full(size, default)
    array = numbers(name, value)
    if array.ndim == 0:
        array = np.full(size, float(array))
    if array.ndim == 2 and 1 in array.shape:
        array = array.ravel()
    if array.shape != (size,):
        raise ValueError(f"`{name}` has the shape {array.shape} and must have the shape ({size},)")
    return np.ascontiguousarray(array)


def finite(name: str, array: np.ndarray) -> np.ndarray:
    """Refuses numbers that are not finite."""
    if not np.isfinite(array).all():
        k = int(np.flatnonzero(~np.isfinite(array))[0])
        raise ValueError(f"`{name}[{k}]` is {array[k]} and must be a finite number")
    return array


def limits(names: "tuple[str, str]", lower: np.ndarray, upper: np.ndarray) -> None:
    """Refuses limits that are NaN, infinite on the wrong side or crossed."""
    for name, array, wrong, help in (
        (names[0], lower, INFINITY, "-inf is no lower limit"),
        (names[1], upper, -INFINITY, "inf is no upper limit"),
    ):
        bad = np.isnan(array) | (array == wrong)
        if bad.any():
            k = int(np.flatnonzero(bad)[0])
            raise ValueError(f"`{name}[{k}]` is {array[k]}; {help}")
    if (lower > upper).any():
        k = int(np.flatnonzero(lower > upper)[0])
        raise ValueError(
            f"`{names[0]}[{k}]` is {lower[k]} and above `{names[1]}[{k}]`, which is {upper[k]}; swap them"
        )


def is_sparse(value: Any) -> bool:
    """Whether it is a matrix or an array of scipy.sparse."""
    return hasattr(value, "tocsr") and hasattr(value, "nnz")


def columns_of(name: str, value: Any) -> Optional[int]:
    """The number of columns of a matrix, `None` of nothing."""
    if value is None:
        return None
    shape = value.shape if is_sparse(value) else numbers(name, value).shape
    if len(shape) != 2:
        raise ValueError(f"`{name}` has the shape {tuple(shape)} and must have rows and columns, as a matrix does")
    return int(shape[1])


def matrix(name: str, value: Any, columns: int) -> Sparse:
    """A matrix with so many columns, dense or sparse."""
    if columns_of(name, value) != columns:
        raise ValueError(f"`{name}` has {columns_of(name, value)} columns and must have one a variable, {columns}")
    if is_sparse(value):
        rows = value.tocsr()
        starts, places, values = rows.indptr, rows.indices, numbers(name, rows.data)
    else:
        dense = numbers(name, value)
        of_row, places = np.nonzero(dense)
        starts = np.concatenate(([0], np.cumsum(np.bincount(of_row, minlength=dense.shape[0]))))
        values = dense[of_row, places]
    starts, places = starts.astype(np.int64), places.astype(np.int64)
    if not np.isfinite(values).all():
        k = int(np.flatnonzero(~np.isfinite(values))[0])
        row = int(np.searchsorted(starts, k, side="right")) - 1
        raise ValueError(f"`{name}[{row}, {places[k]}]` is {values[k]} and must be a finite number")
    return Sparse(starts, places, np.ascontiguousarray(values))


def symmetric(name: str, of: Sparse, size: int) -> None:
    """Refuses a matrix that is not symmetric, such as one triangle of one that is."""
    rows = np.repeat(np.arange(len(of.starts) - 1), np.diff(of.starts))
    here, there = rows * size + of.columns, of.columns * size + rows
    keys = np.concatenate((here, there))
    sums = np.concatenate((of.values, -of.values))
    keys, inverse = np.unique(keys, return_inverse=True)
    differences = np.abs(np.bincount(inverse.ravel(), weights=sums, minlength=len(keys)))
    largest = float(np.abs(of.values).max(initial=0.0))
    if differences.size and differences.max() > 1e-9 * largest:
        k = int(keys[int(np.argmax(differences))])
        raise ValueError(
            f"`{name}` is not symmetric at [{k // size}, {k % size}]; give both triangles, such as ({name} + {name}.T) / 2"
        )


def integers(value: Any, size: int) -> np.ndarray:
    """1 for integers and 0 for other variables."""
    array = vector("integrality", value, size, 0.0)
    if not np.isin(array, (0.0, 1.0)).all():
        k = int(np.flatnonzero(~np.isin(array, (0.0, 1.0)))[0])
        raise ValueError(
            f"`integrality[{k}]` is {array[k]}; it is 1 (or True) for an integer and 0 for any number, and an integer"
            " between 0 and 1 is a binary"
        )
    return array.astype(np.int64)


class Cones(NamedTuple):
    """Cones as one matrix: `h + G x` in the product of cones, the larger side first in each."""

    matrix: Optional[Sparse]
    h: np.ndarray
    sizes: np.ndarray


def cones(value: Optional[Sequence[Any]], size: int) -> Cones:
    """Cones `(C, d, e, f)`, each for `||C x + d|| <= e'x + f`."""
    blocks, constants, sizes = [], [], []
    for k, cone in enumerate(value or ()):
        name = f"cones[{k}]"
        if not isinstance(cone, (tuple, list)) or len(cone) != 4:
            raise TypeError(f"`{name}` must be a tuple (C, d, e, f) for ||C x + d|| <= e'x + f; d and e may be None")
        inner, d, e, f = cone
        entries = matrix(f"{name}[0]", inner, size)
        count = len(entries.starts) - 1
        e = finite(f"{name}[2]", vector(f"{name}[2]", e, size, 0.0))
        f = vector(f"{name}[3]", f, 1, 0.0)
        places = np.flatnonzero(e)
        blocks += [Sparse(np.array([0, len(places)]), places, e[places]), entries]
        constants += [finite(f"{name}[3]", f), finite(f"{name}[1]", vector(f"{name}[1]", d, count, 0.0))]
        sizes.append(1 + count)
    if not blocks:
        return Cones(None, np.zeros(0), np.zeros(0, dtype=np.int64))
    ends = np.cumsum([block.starts[-1] for block in blocks])
    starts = [blocks[0].starts] + [block.starts[1:] + end for block, end in zip(blocks[1:], ends)]
    joined = Sparse(
        np.concatenate(starts).astype(np.int64),
        np.concatenate([block.columns for block in blocks]).astype(np.int64),
        np.concatenate([block.values for block in blocks]),
    )
    return Cones(joined, np.concatenate(constants), np.array(sizes, dtype=np.int64))


def count(given: "dict[str, Any]", cone_list: Optional[Sequence[Any]]) -> int:
    """The number of variables, from whatever has it."""
    for name in ("P", "A"):
        columns = columns_of(name, given[name])
        if columns is not None:
            return columns
    for name in ("q", "lb", "ub", "integrality"):
        if given[name] is not None and np.ndim(given[name]):
            return int(np.size(given[name]))
    for k, cone in enumerate(cone_list or ()):
        if isinstance(cone, (tuple, list)) and cone:
            columns = columns_of(f"cones[{k}][0]", cone[0])
            if columns is not None:
                return columns
    raise ValueError("how many variables are there? Give `q`, such as numpy.zeros(3) for three without costs")


def program(
    P: Any, q: Any, A: Any, l: Any, u: Any, lb: Any, ub: Any, integrality: Any, cone_list: Any, offset: float, names: Any
) -> "dict[str, Any]":
    """The arrays of a program, checked; values are arrays, or `None`."""
    given = {"P": P, "q": q, "A": A, "lb": lb, "ub": ub, "integrality": integrality}
    size = count(given, cone_list)
    squares = None if P is None else matrix("P", P, size)
    if squares is not None:
        if len(squares.starts) - 1 != size:
            raise ValueError(f"`P` has {len(squares.starts) - 1} rows and must have one a variable, {size}")
        symmetric("P", squares, size)
    rows = None if A is None else matrix("A", A, size)
    if rows is None and (l is not None or u is not None):
        raise ValueError("`l` and `u` are limits of the rows of `A`, which is not given; bounds of variables are `lb` and `ub`")
    count_of_rows = 0 if rows is None else len(rows.starts) - 1
    lower, upper = vector("l", l, count_of_rows, -INFINITY), vector("u", u, count_of_rows, INFINITY)
    limits(("l", "u"), lower, upper)
    least, most = vector("lb", lb, size, -INFINITY), vector("ub", ub, size, INFINITY)
    limits(("lb", "ub"), least, most)
    joined = cones(cone_list, size)
    constant = float(finite("offset", vector("offset", offset, 1, 0.0))[0])
    if names is not None:
        names = [str(name) for name in names]
        if len(names) != size:
            raise ValueError(f"`names` has {len(names)} names and must have one a variable, {size}")
    return {
        "P": squares, "q": finite("q", vector("q", q, size, 0.0)), "offset": constant,
        "A": rows, "l": lower, "u": upper, "lb": least, "ub": most,
        "integrality": integers(integrality, size),
        "G": joined.matrix, "h": joined.h, "sizes": joined.sizes, "names": names,
    }


def to_bytes(arrays: "dict[str, Any]") -> "dict[str, Any]":
    """The arrays as the extension takes them."""
    def one(value: Any) -> Any:
        if isinstance(value, Sparse):
            return value.to_bytes()
        return value.tobytes() if isinstance(value, np.ndarray) else value

    return {name: one(value) for name, value in arrays.items()}
