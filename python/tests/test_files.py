"""Files: read, solved, written and read again."""

import carom
import numpy as np
import pytest
from programs import random_integer_program


@pytest.mark.parametrize("name", ["a.mps", "a.lp", "a.cbf", "a.nl", "a.lp.gz"])
@pytest.mark.parametrize("kind", ["linear", "quadratic", "conic"])
def test_a_program_is_written_and_read(tmp_path, name, kind):
    program = random_integer_program(7, quadratic=kind == "quadratic", cones=kind == "conic")
    model = carom.Model(**program)
    path = tmp_path / name
    model.write(path)
    again = carom.read(path)
    assert again.solve().objective == pytest.approx(model.solve().objective, abs=1e-5)
    assert name in ("a.cbf", "a.nl") or again.names[: len(model.names)] == model.names


def test_files_say_what_is_wrong(tmp_path):
    path = tmp_path / "a.lp"
    path.write_text("minimize x subject to x >= end")
    with pytest.raises(ValueError, match="line 1"):
        carom.read(path)
    with pytest.raises(FileNotFoundError):
        carom.read(tmp_path / "b.lp")
    with pytest.raises(ValueError, match="no such format: `xyz`"):
        carom.read(path, "xyz")
    with pytest.raises(ValueError, match="no such format: `qplib`"):
        carom.Model(q=[1]).write(tmp_path / "a.qplib")
    path.write_text("min x + y st x + y >= 1 bounds x <= 3 x <= 2 end")
    with pytest.warns(UserWarning, match="the last one counts"):
        model = carom.read(path)
    assert model.names == ["x", "y"] and "2 variables" in repr(model) and "x + y" in str(model)


def test_files_may_maximise(tmp_path):
    path = tmp_path / "a.lp"
    path.write_text("maximize 2 a + b subject to limit: a + b <= 3 bounds a <= 2 end")
    result = carom.read(path).solve()
    assert result.objective == pytest.approx(5.0, abs=1e-6) and result.bound >= 5.0 - 1e-6
    assert result.duals.rows == pytest.approx([1.0], abs=1e-6)
    path.write_text("minimize a subject to low: a >= 3 bounds a <= 2 end")
    why = carom.read(path).explain()
    assert "low" in why.names and why.bounds == [0]
    assert np.isinf(carom.read(path).solve().gap)
