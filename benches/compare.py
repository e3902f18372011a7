#!/usr/bin/env python3
"""Times carom beside other solvers on the same files, in turn, on the same machine.

    cargo run --release --example table -- --write target/instances
    python3 benches/compare.py target/instances            # everything, about 10 minutes
    python3 benches/compare.py target/instances --only wall boxes --rounds 3 --limit 20

The other solvers are optional Python packages: highspy, pyscipopt, gurobipy, cplex, xpress, daqp
(numpy and scipy with the last). What is not installed, or refuses a file for its licence's size
limit, is left out of that line. Each solver reads the file itself; seconds are those of its search,
without reading. Per file the solvers take turns, `--rounds` times, and the median counts; whoever
meets the limit is not asked again. The table goes to standard output as Markdown, progress to
standard error.

A folder with an `answers.csv` (see `judge.py`) is also judged: right, wrong, refused, stalled, broken
or limit for every listed file. A refusal is a failure unless the table says so. If there is a failure,
the exit code is 1. Verdicts alone, of one run a file without other solvers:

    python3 benches/compare.py ../cases --judge --limit 20

Conic programs are CBF files. The others get them as MPS files with QCMATRIX that carom writes. Files may
be compressed (`.gz`).

A folder may hold folders, each a family of files, and several folders can be given. Answers are
checked against `answers.txt` or `answers.csv` in the given folder; without either, against what most
solvers claim. `--profile FILE.csv` writes by which factors solvers are slower than the best, for `cargo run --example
profile -- FILE.csv PICTURE.svg`:

    python3 benches/compare.py ../programs --rounds 1 --limit 15 --profile target/profile.csv

Further variants of carom are compared by `--variant NAME=ARGUMENTS`, for example
`--variant "2 threads=--threads 2"`; an ablation is a list of variants, see `--ablation`.
"""
import argparse
import functools
import gzip
import importlib.util
import json
import math
import os
import re
import select
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

import judge
import report
from report import agrees, families, profile, ratios, solved, table

GAP = 1e-6

# What seconds are measured with; `--cpu` changes it.
clock = time.perf_counter


def gurobi(path, limit, threads):
    import gurobipy as gp
    env = gp.Env(empty=True)
    env.setParam("OutputFlag", 0)
    env.start()
    model = gp.read(path, env)
    model.Params.TimeLimit, model.Params.Threads, model.Params.MIPGap = limit, threads, GAP
    start = clock()
    model.optimize()
    seconds = clock() - start
    status = {2: "optimal", 3: "infeasible", 4: "infeasible", 9: "limit"}.get(model.Status, str(model.Status))
    return status, seconds, int(model.NodeCount), model.ObjVal if model.SolCount else None


def cplex(path, limit, threads):
    import cplex as library
    model = library.Cplex()
    for mute in (model.set_log_stream, model.set_results_stream, model.set_warning_stream, model.set_error_stream):
        mute(None)
    model.read(path)
    model.parameters.timelimit.set(limit)
    model.parameters.threads.set(threads)
    model.parameters.mip.tolerances.mipgap.set(GAP)
    start = clock()
    model.solve()
    seconds = clock() - start
    code = model.solution.get_status()
    status = {101: "optimal", 102: "optimal", 103: "infeasible", 119: "infeasible", 107: "limit", 108: "limit"}
    objective = model.solution.get_objective_value() if code in (101, 102, 107) else None
    return status.get(code, str(code)), seconds, model.solution.progress.get_num_nodes_processed(), objective


def xpress(path, limit, threads):
    import warnings
    warnings.filterwarnings("ignore")
    import xpress as library
    model = library.problem()
    model.setOutputEnabled(False)
    model.readProb(path, "")
    model.controls.timelimit, model.controls.threads, model.controls.miprelstop = limit, threads, GAP
    start = clock()
    model.optimize()
    seconds = clock() - start
    code = model.attributes.solstatus.name
    status = {"OPTIMAL": "optimal", "INFEASIBLE": "infeasible"}.get(code, "limit" if seconds > limit else code.lower())
    objective = model.attributes.objval if code in ("OPTIMAL", "FEASIBLE") else None
    return status, seconds, model.attributes.nodes, objective


def highs(path, limit, threads):
    import highspy
    if conic(path):
        return "no cones", 0.0, 0, None
    model = highspy.Highs()
    model.setOptionValue("output_flag", False)
    model.readModel(path)
    for option, value in (("threads", threads), ("time_limit", float(limit)), ("mip_rel_gap", GAP)):
        model.setOptionValue(option, value)
    if model.getModel().hessian_.dim_:
        return "no MIQP", 0.0, 0, None
    start = clock()
    model.run()
    seconds = clock() - start
    text = model.modelStatusToString(model.getModelStatus())
    status = {"Optimal": "optimal", "Infeasible": "infeasible", "Time limit reached": "limit"}.get(text, text)
    info = model.getInfo()
    return status, seconds, info.mip_node_count, info.objective_function_value if status == "optimal" else None


def scip(path, limit, _threads):
    from pyscipopt import Model
    model = Model()
    model.hideOutput()
    model.readProblem(path)
    model.setParam("limits/time", limit)
    model.setParam("limits/gap", GAP)
    start = clock()
    model.optimize()
    seconds = clock() - start
    text = model.getStatus()
    status = {"gaplimit": "optimal", "timelimit": "limit"}.get(text, text)
    return status, seconds, model.getNNodes(), model.getObjVal() if model.getNSols() else None


def daqp(path, _limit, _threads):
    """Dense, so only small programs with a quadratic objective; its matrices are read by HiGHS."""
    import daqp as library
    import highspy
    import numpy as np
    from scipy.sparse import csc_matrix
    if conic(path):
        return "no cones", 0.0, 0, None
    reader = highspy.Highs()
    reader.setOptionValue("output_flag", False)
    reader.readModel(path)
    model = reader.getModel()
    lp, hessian = model.lp_, model.hessian_
    n, m = lp.num_col_, lp.num_row_
    if n > 250 or not hessian.dim_:
        return "too large", 0.0, 0, None
    square = csc_matrix((hessian.value_, hessian.index_, hessian.start_), (n, n)).toarray()
    square = square + square.T - np.diag(np.diag(square)) + 1e-9 * np.eye(n)
    rows = csc_matrix((lp.a_matrix_.value_, lp.a_matrix_.index_, lp.a_matrix_.start_), (m, n)).toarray()
    upper = np.minimum(np.concatenate([lp.col_upper_, lp.row_upper_]), 1e20)
    lower = np.maximum(np.concatenate([lp.col_lower_, lp.row_lower_]), -1e20)
    sense = np.zeros(n + m, dtype=np.int32)
    for j, kind in enumerate(lp.integrality_):
        if kind == highspy.HighsVarType.kInteger:
            sense[j] = 16
    equal = (lower == upper) & (sense == 0)
    sense[equal] = 5
    start = clock()
    _, objective, flag, info = library.solve(square, np.array(lp.col_cost_), rows, upper, lower, sense)
    seconds = clock() - start
    status = {1: "optimal", -1: "infeasible"}.get(flag, f"flag {flag}")
    return status, seconds, info.get("nodes", 0), objective if flag == 1 else None


PEERS = {
    "cplex": (cplex, "cplex"),
    "gurobi": (gurobi, "gurobipy"),
    "xpress": (xpress, "xpress"),
    "highs": (highs, "highspy"),
    "scip": (scip, "pyscipopt"),
    "daqp": (daqp, "daqp"),
}


def serve(name):
    """Answers one line of JSON per line of JSON: what crashes, crashes here."""
    out = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # whatever the libraries print is no answer
    for line in sys.stdin:
        try:
            answer = PEERS[name][0](*json.loads(line))
        except Exception as error:  # a licence, a missing feature
            answer = (f"error: {type(error).__name__} {str(error)[:60]}", 0.0, 0, None)
        print(json.dumps(answer), file=out, flush=True)


@functools.cache
def folder_of_copies():
    """A folder that goes when the program ends."""
    return tempfile.TemporaryDirectory()


@functools.cache
def plain(path):
    """The path of the file, or of a copy that is not compressed."""
    if not path.endswith(".gz"):
        return path
    name = os.path.abspath(path).removesuffix(".gz").replace(os.sep, "_")
    copy = os.path.join(folder_of_copies().name, name)
    with gzip.open(path, "rb") as packed, open(copy, "wb") as file:
        shutil.copyfileobj(packed, file)
    return copy


@functools.cache
def as_mps(path, program):
    """The path of the same program as MPS, written by carom; `None` if it cannot."""
    copy = os.path.join(folder_of_copies().name, os.path.abspath(path).replace(os.sep, "_") + ".mps")
    run = subprocess.run([program, plain(path), "--write", copy], capture_output=True)
    return copy if run.returncode == 0 and os.path.exists(copy) else None


class Peer:
    """Another solver in a process of its own, started anew when it breaks or hangs."""

    def __init__(self, name, threads, program):
        self.name, self.threads, self.program, self.process = name, threads, program, None

    def solve(self, path, limit):
        path = as_mps(path, self.program) if ".cbf" in os.path.basename(path) else plain(path)
        if path is None:
            return "error: the file cannot be written as MPS", 0.0, 0, None
        if self.process is None or self.process.poll() is not None:
            command = [sys.executable, __file__, "--serve", self.name]
            if clock is time.process_time:
                command.append("--cpu")
            self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        request = [path, limit, self.threads]
        try:
            self.process.stdin.write(json.dumps(request) + "\n")
            self.process.stdin.flush()
            ready, _, _ = select.select([self.process.stdout], [], [], 2 * limit + 30)
            line = self.process.stdout.readline() if ready else ""
            if line:
                return tuple(json.loads(line))
        except BrokenPipeError:
            pass
        self.process.kill()
        self.process.wait()
        return "error: crashed or hung", 0.0, 0, None


class Carom:
    """The example `solve`, with further arguments."""

    def __init__(self, name, program, arguments):
        self.name, self.command = name, [program, *arguments]
        # What it said last about each path, for verdicts.
        self.said = {}

    def solve(self, path, limit):
        said = self.said[path] = self.ask(path, limit)
        if said["status"] in ("refused", "broken"):
            return "error: " + said["note"][:60], 0.0, 0, None
        status = {"feasible": "limit"}.get(said["status"], said["status"])
        return status, said["seconds"], said["nodes"], said["objective"]

    def ask(self, path, limit):
        command = [self.command[0], plain(path), "--time-limit", str(limit), *self.command[1:]]
        nothing = {"stalled": False, "objective": None, "bound": None, "seconds": 0.0, "nodes": 0}
        try:
            run = subprocess.run(command, capture_output=True, text=True, timeout=2 * limit + 30)
        except subprocess.TimeoutExpired:
            return {**nothing, "status": "broken", "note": "hung"}
        found = dict(re.findall(r"(\w+)=(\S+)", run.stdout))
        lines = [line for line in run.stderr.splitlines() if line and not line.startswith("warning: ")]
        note = lines[-1] if lines else ""
        if run.returncode != 0 or "status" not in found:
            refused = run.returncode == 1 and note.startswith("solve: ")
            return {**nothing, "status": "refused" if refused else "broken", "note": note.removeprefix("solve: ")}
        return {
            "status": found["status"],
            "stalled": any(line.startswith("stalled") for line in lines),
            "objective": None if found["objective"] == "-" else float(found["objective"]),
            "bound": judge.number(found["bound"]),
            "seconds": float(found["cpu" if clock is time.process_time else "seconds"]),
            "nodes": int(found["nodes"]),
            "note": note,
        }


def measure(path, solvers, rounds, limit):
    """Per solver: status, median of seconds, nodes, objective."""
    runs = {solver.name: [] for solver in solvers}
    for turn in range(rounds):
        order = solvers[turn % len(solvers):] + solvers[:turn % len(solvers)]
        for solver in order:
            earlier = runs[solver.name]
            if earlier and earlier[0][0] not in ("optimal", "infeasible"):
                continue
            earlier.append(solver.solve(path, limit))
    answers = {}
    for name, found in runs.items():
        seconds = statistics.median(run[1] for run in found)
        statuses = {run[0] for run in found}
        status = found[0][0] if len(statuses) == 1 else "varies: " + ", ".join(sorted(statuses))
        answers[name] = (status, seconds, found[-1][2], found[-1][3])
    return answers


def conic(path):
    """Whether rows have squares or products, as far as the format tells."""
    path = plain(path)
    if path.endswith(".cbf"):
        return True
    with open(path) as file:
        return any(line.startswith("QCMATRIX") for line in file)


def quadratic(path):
    """Whether the objective has squares or products: a section in MPS, brackets in LP."""
    path = plain(path)
    with open(path) as file:
        return any(line.startswith(("QUADOBJ", "QMATRIX")) or ("]" in line and path.endswith(".lp")) for line in file)


def value_of(answer):
    """A listed answer: an objective or `infeasible`; `None` if it is an open question."""
    # A file without an objective is a question of feasibility: any point will do.
    words = {"infeasible": "infeasible", "feasible": 0.0}
    try:
        return words.get(answer, None) if answer in words else float(answer)
    except ValueError:
        return None


def answers_of(folder):
    """`answers.txt` in the folder, with a name and an objective or `infeasible` a line, or
    `answers.csv` with the columns file, status and objective."""
    truths = {}
    path = os.path.join(folder, "answers.txt")
    if os.path.exists(path):
        with open(path) as file:
            lines = [line.split()[:2] for line in file if line.strip() and not line.startswith("#")]
            truths = {name: value_of(answer) for name, answer in lines}
    for file, row in (judge.listed(folder) or {}).items():
        answer = row["objective"] if row["status"] == "optimal" else row["status"]
        truths[judge.stem(file)] = value_of(answer)
    return {name: answer for name, answer in truths.items() if answer is not None}


def files_of(folder, only):
    """Names, without extension and relative to the folder, and paths of all MPS, LP and CBF files."""
    for parent, folders, entries in os.walk(folder):
        folders.sort()
        for entry in sorted(entries):
            name = judge.stem(os.path.relpath(os.path.join(parent, entry), folder))
            if entry.endswith(judge.EXTENSIONS) and (not only or any(part in name for part in only)):
                yield name, os.path.join(parent, entry)


def verdicts(folders, carom, limit, ask):
    """Judges all folders with an `answers.csv`; returns the number of failures. Files are run here if
    `ask`, otherwise what was said about them before counts."""
    failures = 0
    for folder in folders:
        rows = judge.listed(folder)
        if rows is None:
            continue
        outcomes = {}
        for file in rows:
            path = os.path.join(folder, file)
            if ask and os.path.exists(path):
                carom.solve(path, limit)
                print(f"{file}: {carom.said[path]['note']}", file=sys.stderr, flush=True)
            if path in carom.said:
                outcomes[file] = carom.said[path]
        failures += judge.report(folder, rows, outcomes)
    return failures


def agreed(answers):
    """Without a listed answer: what most of those who claim one claim; `None` if nobody does."""
    claims = [answer for answer in answers.values() if solved(answer)]
    votes = [(sum(agrees(other, value) for other in claims), value)
             for value in ("infeasible" if claim[0] == "infeasible" else claim[3] for claim in claims)]
    return max(votes, key=lambda vote: vote[0])[1] if len(votes) > 1 else None


def installed(package):
    return importlib.util.find_spec(package) is not None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="*", help="folders of *.mps, *.lp, *.cbf and answers.txt or answers.csv")
    parser.add_argument("--only", nargs="*", default=[], help="parts of names of files")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--limit", type=float, default=40.0, help="seconds a solve")
    parser.add_argument("--threads", type=int, default=2, help="threads of the other solvers")
    parser.add_argument("--peers", nargs="*", default=list(PEERS), help="other solvers: " + ", ".join(PEERS))
    parser.add_argument("--solve", default="target/release/examples/solve", help="carom's example")
    parser.add_argument("--variant", action="append", default=[], metavar="NAME=ARGUMENTS")
    parser.add_argument("--ablation", metavar="FILE", help="a file of variants, one `NAME=ARGUMENTS` a line; no other solver")
    parser.add_argument("--judge", action="store_true", help="only verdicts over answers.csv: one run a file, no other solver")
    parser.add_argument("--profile", metavar="FILE", help="also write the factors of a performance profile there, as CSV")
    parser.add_argument("--cpu", action="store_true", help="processor seconds, with one thread: for a machine with other work")
    parser.add_argument("--json", metavar="FILE", help="also write all answers there")
    parser.add_argument("--serve", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.cpu:
        global clock
        clock = time.process_time
        arguments.threads = 1
    if arguments.serve:
        return serve(arguments.serve)
    if not arguments.folders:
        parser.error("a folder of files is needed")

    if arguments.judge:
        for folder in arguments.folders:
            if judge.listed(folder) is None:
                parser.error(f"{folder} has no answers.csv")
        carom = Carom("carom 1", arguments.solve, ["--threads", "1"])
        return 1 if verdicts(arguments.folders, carom, arguments.limit, True) else 0

    variants = list(arguments.variant)
    if arguments.ablation:
        with open(arguments.ablation) as file:
            variants += [line.strip() for line in file if line.strip() and not line.startswith("#")]
    ours = [Carom("carom 1", arguments.solve, ["--threads", "1"])]
    if not arguments.ablation and not arguments.cpu:
        ours.append(Carom("carom 2", arguments.solve, ["--threads", "2"]))
    for variant in variants:
        name, _, words = variant.partition("=")
        ours.append(Carom(name.strip(), arguments.solve, words.split()))
    peers = []
    if not arguments.ablation:
        peers = [Peer(name, arguments.threads, arguments.solve) for name in arguments.peers if installed(PEERS[name][1])]
    solvers = ours + peers
    names = [solver.name for solver in solvers]

    truths, results, squares, cones = {}, {}, [], []
    for folder in arguments.folders:
        listed = answers_of(folder)
        for name, path in files_of(folder, arguments.only):
            # Files of several folders are told apart by the folder's name.
            file = name if len(arguments.folders) == 1 else f"{os.path.basename(os.path.normpath(folder))}/{name}"
            results[file] = measure(path, solvers, arguments.rounds, arguments.limit)
            truth = listed[name] if name in listed else agreed(results[file])
            if truth is not None:
                truths[file] = truth
            if path.endswith((".cbf", ".cbf.gz")):
                report.TOLERANCE = judge.CONIC_TOLERANCE
            if conic(path):
                cones.append(file)
            elif quadratic(path):
                squares.append(file)
            shown = " | ".join(f"{name} {results[file][name][0]} {results[file][name][1]:.3f}" for name in names)
            print(f"{file}: {shown}", file=sys.stderr, flush=True)

    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else math.nan
    unit = "Processor seconds" if arguments.cpu else "Seconds"
    print(f"{unit} (nodes); median of {arguments.rounds}, in turn; limit {arguments.limit:g} s; gap {GAP:g}; "
          f"{os.cpu_count()} processors, load {load:.1f} at the end. Bold: a claim that is not the listed answer.\n")
    table(results, names, truths)
    families(results, names, truths, arguments.limit)
    if arguments.profile:
        count = profile(arguments.profile, results, names, truths, arguments.limit)
        print(f"Profile over the {count} files that all of these could read: {arguments.profile}\n")
    linear = [file for file in results if file not in squares and file not in cones]
    baseline = names[0] if arguments.ablation else None
    for one in ([solver.name for solver in ours[1:]] if baseline else [solver.name for solver in ours]):
        others = [baseline] if baseline else [peer.name for peer in peers]
        ratios(results, one, others, truths, squares, f"{one}, files with a quadratic objective")
        ratios(results, one, others, truths, linear, f"{one}, linear files")
        ratios(results, one, others, truths, cones, f"{one}, files with cones")
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump({"results": results, "answers": truths}, file, indent=1)
    return 1 if verdicts(arguments.folders, ours[0], arguments.limit, False) else 0


if __name__ == "__main__":
    sys.exit(main())
