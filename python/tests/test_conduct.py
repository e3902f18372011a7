"""Callbacks, interrupts, threads, forks and memory."""

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import carom
import numpy as np
import pytest
from programs import market_split, random_integer_program


def test_a_callback_sees_every_best_point():
    seen = []
    result = carom.solve(**market_split(3), node_limit=2000, callback=seen.append)
    assert seen and seen[-1].objective == pytest.approx(result.objective, abs=1e-6)
    assert [best.objective for best in seen] == sorted((best.objective for best in seen), reverse=True)
    assert seen[-1].x.shape == result.x.shape and seen[-1].seconds >= 0.0 and "Incumbent" in repr(seen[0])


def test_a_callback_is_called_on_the_thread_that_called():
    threads = []
    carom.solve(**market_split(3), node_limit=500, callback=lambda best: threads.append(threading.get_ident()))
    assert set(threads) == {threading.get_ident()}


def test_a_callback_ends_the_search():
    result = carom.solve(**market_split(), time_limit=60, callback=lambda best: True)
    assert result.status == "interrupted" and result.x is not None and result.bound <= result.objective


def test_an_exception_of_a_callback_is_raised():
    def broken(best):
        raise KeyError("no")

    began = time.monotonic()
    with pytest.raises(KeyError, match="no"):
        carom.solve(**market_split(), time_limit=60, callback=broken)
    assert time.monotonic() - began < 30
    assert carom.solve(q=[1.0], lb=0).status == "optimal"


def test_limits_keep_the_best_point():
    result = carom.solve(**market_split(), time_limit=1)
    assert result.status == "time_limit" and result.x is not None and result.gap > 0
    assert carom.solve(**market_split(), node_limit=10).status == "node_limit"


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_an_interrupt_ends_the_search_and_keeps_the_best_point():
    # A shell starts programs in the background deaf to Ctrl-C.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(1.0, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    began = time.monotonic()
    try:
        result = carom.solve(**market_split(), time_limit=60)
    finally:
        signal.signal(signal.SIGINT, before)
    assert result.status == "interrupted" and result.x is not None, (result, time.monotonic() - began)
    assert time.monotonic() - began < 10
    timer.join()


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_an_exception_of_a_handler_is_raised():
    def handler(number, frame):
        raise TimeoutError("too long")

    before = signal.signal(signal.SIGALRM, handler)
    signal.setitimer(signal.ITIMER_REAL, 0.5)
    try:
        with pytest.raises(TimeoutError, match="too long"):
            carom.solve(**market_split(), time_limit=60)
    finally:
        signal.signal(signal.SIGALRM, before)


def test_threads_solve_at_once_while_others_run():
    programs = [random_integer_program(seed, variables=6, quadratic=True) for seed in range(4)]
    alone = [carom.solve(**program).objective for program in programs]
    found = [[] for _ in programs]

    def work(k):
        for _ in range(20):
            found[k].append(carom.solve(**programs[k]).objective)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(len(programs))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [[best] * 20 for best in alone]

    ticks, done = [], threading.Event()
    long = threading.Thread(target=lambda: (carom.solve(**market_split(), time_limit=1), done.set()))
    long.start()
    while not done.is_set():
        ticks.append(time.monotonic())
        time.sleep(0.01)
    long.join()
    # The interpreter is free during the solve.
    assert len(ticks) > 20


def test_a_search_on_several_threads():
    one, two = (carom.solve(**market_split(3), threads=threads, time_limit=20) for threads in (1, 2))
    assert two.bound <= one.objective + 1e-6 and one.bound <= two.objective + 1e-6


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_fork_solves_too():
    prepared = carom.Prepared(q=[1, 3], A=[[1, 2]], l=4, lb=0, ub=[3, 9], integrality=[1, 1], ranges={"l": (0, 15)})
    assert prepared.solve(l=5).objective == 6.0
    child = os.fork()
    if child == 0:
        signal.alarm(30)
        fine = prepared.solve(l=11).objective == 15.0 and carom.solve(q=[1.0], lb=2).objective == 2.0
        os._exit(0 if fine else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    assert prepared.solve(l=4).objective == 5.0


MEMORY = """
    import resource, carom, numpy
    arguments = {"q": [-1, -2, 1], "A": [[1, 2, 0], [0, 1, 1]], "u": [3, 2], "lb": 0, "ub": 4, "integrality": [1, 1, 0]}
    prepared = carom.Prepared(**arguments, ranges={"u": (0, 9)})

    def resident():
        return int(open("/proc/self/statm").read().split()[1]) * resource.getpagesize()

    def solve(times):
        for k in range(times):
            result = carom.solve(**arguments, callback=lambda best: None, start=[0, 0, 0])
            result.x, result.statistics
            prepared.solve(u=[3, 1 + k % 5]).x
            try:
                carom.solve(q=[float("nan")])
            except ValueError:
                pass

    solve(1000)
    before = resident()
    solve(9000)
    print((resident() - before) / 2**20)
"""


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="memory is read from /proc")
def test_memory_is_flat_over_many_solves():
    said = subprocess.run([sys.executable, "-c", textwrap.dedent(MEMORY)], capture_output=True, text=True, check=True)
    grown = float(said.stdout)
    print(f"after 10,000 solves, each also prepared: {grown:.2f} MiB more than after 1,000")
    assert grown < 3.0


def test_callbacks_of_prepared_programs():
    prepared = carom.Prepared(**market_split(3), ranges={})
    with pytest.raises(ZeroDivisionError):
        prepared.solve(node_limit=500, callback=lambda best: 1 / 0)
    assert prepared.solve(node_limit=500).x is not None
    said = []

    def again(best):
        with pytest.raises(RuntimeError, match="is being solved"):
            prepared.solve()
        said.append(best)
        return True

    assert prepared.solve(callback=again).status == "interrupted" and said
    assert isinstance(said[0].x, np.ndarray)
