"""What users may give wrongly: exceptions that name the argument and the way out."""

import carom
import numpy as np
import pytest

NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize(
    "given, error, text",
    [
        ({}, ValueError, "how many variables"),
        ({"q": [1, NAN]}, ValueError, r"`q\[1\]` is nan"),
        ({"q": [INF]}, ValueError, r"`q\[0\]` is inf"),
        ({"q": ["a"]}, TypeError, "`q` must be an array of numbers"),
        ({"q": [1j]}, TypeError, "`q` is complex"),
        ({"q": [1, 2], "A": [[1]]}, ValueError, r"`q` has the shape \(2,\)"),
        ({"q": [1], "A": [1]}, ValueError, "as a matrix does"),
        ({"q": [1], "A": [[1]], "l": [1, 2]}, ValueError, r"`l` has the shape \(2,\)"),
        ({"q": [1], "A": [[NAN]]}, ValueError, r"`A\[0, 0\]` is nan"),
        ({"q": [1], "A": [[1]], "l": 2, "u": 1}, ValueError, r"`l\[0\]` is 2.0 and above"),
        ({"q": [1], "A": [[1]], "l": NAN}, ValueError, r"`l\[0\]` is nan"),
        ({"q": [1], "A": [[1]], "l": INF}, ValueError, r"`l\[0\]` is inf"),
        ({"q": [1], "l": 0}, ValueError, "limits of the rows of `A`"),
        ({"q": [1], "lb": [3], "ub": [2]}, ValueError, r"`lb\[0\]` is 3.0 and above"),
        ({"q": [1], "ub": -INF}, ValueError, r"`ub\[0\]` is -inf"),
        ({"q": [1], "integrality": [2]}, ValueError, r"`integrality\[0\]` is 2"),
        ({"q": [1], "integrality": [1, 0]}, ValueError, "`integrality` has the shape"),
        ({"P": [[1, 2]]}, ValueError, "`P` has 1 rows"),
        ({"P": [[2, 1], [0, 2]]}, ValueError, "give both triangles"),
        ({"P": [[-1.0]]}, ValueError, "convex"),
        ({"q": [1], "cones": [1]}, TypeError, r"`cones\[0\]` must be a tuple"),
        ({"q": [1], "cones": [([[1, 2]], None, None, 1)]}, ValueError, r"`cones\[0\]\[0\]` has 2 columns"),
        ({"q": [1], "cones": [([[1]], [1, 2], None, 1)]}, ValueError, r"`cones\[0\]\[1\]` has the shape"),
        ({"q": [1], "cones": [([[1]], None, None, NAN)]}, ValueError, r"`cones\[0\]\[3\]\[0\]` is nan"),
        ({"q": [1], "offset": NAN}, ValueError, "offset"),
        ({"q": [1, 2], "names": ["a"]}, ValueError, "`names` has 1 names"),
        ({"q": [1, 2], "names": ["a", "a"]}, ValueError, "a"),
        ({"q": [1], "time_limit": -1}, ValueError, "`time_limit` is -1.0"),
        ({"q": [1], "time_limit": "1"}, TypeError, "`time_limit` must be a number"),
        ({"q": [1], "threads": 0}, ValueError, "`threads` is 0"),
        ({"q": [1], "threads": 1.5}, ValueError, "`threads` is 1.5"),
        ({"q": [1], "threads": 1000}, ValueError, "threads"),
        ({"q": [1], "node_limit": -3}, ValueError, "`node_limit` is -3"),
        ({"q": [1], "feasibility": 1.0}, ValueError, "feasibility"),
        ({"q": [1], "callback": 3}, TypeError, "`callback` must be a function"),
        ({"q": [1], "start": [1, 2]}, ValueError, "`start` has the shape"),
        ({"q": [1], "speed": 9}, TypeError, "there is no option `speed`"),
    ],
)
def test_wrong_input_is_an_exception_that_names_it(given, error, text):
    with pytest.raises(error, match=text):
        carom.solve(**given)


def test_arrays_of_the_caller_do_not_change():
    sparse = pytest.importorskip("scipy.sparse")
    A = sparse.coo_matrix((np.array([1.0, 2.0]), ([0, 0], [0, 0])), shape=(1, 1))
    assert carom.solve(q=[1.0], A=A, l=6.0).objective == pytest.approx(2.0, abs=1e-6)
    assert A.nnz == 2


def test_other_types_of_numbers_are_taken():
    for kind in (np.float32, np.int8, np.bool_):
        result = carom.solve(q=np.array([1], dtype=kind), A=np.array([[1]], dtype=kind), l=np.array([1], dtype=kind))
        assert result.objective == pytest.approx(1.0, abs=1e-6)
    backwards = np.arange(6.0)[::-2]
    assert carom.solve(q=backwards, lb=0, ub=1).objective == pytest.approx(0.0, abs=1e-9)
    column = np.array([[1.0], [2.0]])
    assert carom.solve(q=column, lb=1, ub=2).objective == pytest.approx(3.0, abs=1e-9)


def test_what_is_not_there_is_an_error():
    with pytest.raises(AttributeError, match="has no `speed`"):
        carom.speed
