"""Files of nonlinear programs in AMPL's text form, solved by `carom`, SCIP and Gurobi on one thread each.

    cargo build --release -p carom-cli
    python benches/minlp.py FOLDER ANSWERS [--carom PROGRAM] [--limit SECONDS] [--solvers carom,scip,gurobi] [NAME ...]

FOLDER has files `NAME.nl`, and ANSWERS is the list of optima of MINLPLib (`minlplib.solu`, lines `=opt= NAME VALUE`
or `=best= NAME VALUE`). Each solver stops at a relative gap of 1e-4. Seconds are those of the processor. An answer is
`wrong` if a claimed optimum, or a bound, misses the listed value by more than 2e-4 of it. Needs casadi, pyscipopt and
gurobipy.
"""
import argparse
import json
import math
import os
import re
import resource
import struct
import subprocess
import sys
import tempfile

GAP = 1e-4


def by_carom(path, limit, program):
    run = subprocess.run([program, path, "--quiet", "--time-limit", str(limit), "--gap", str(GAP)],
                         capture_output=True, text=True)
    lines = run.stdout.splitlines()
    fields = dict(part.split("=", 1) for part in lines[-1].split()) if lines else {}
    if "status" not in fields:
        return {"status": "refused", "why": run.stderr.strip()[:200]}
    number = lambda name: None if fields[name] == "-" else float(fields[name])
    return {"status": fields["status"], "objective": number("objective"), "bound": number("bound"),
            "nodes": int(fields["nodes"])}


def by_scip(path, limit, _):
    from pyscipopt import Model
    model = Model()
    model.hideOutput()
    model.readProblem(path)
    model.setParam("limits/time", limit)
    model.setParam("limits/gap", GAP)
    model.setParam("timing/clocktype", 1)
    model.optimize()
    status = model.getStatus()
    return {"status": "optimal" if status in ("optimal", "gaplimit") else status,
            "objective": model.getObjVal() if model.getNSols() else None, "bound": model.getDualbound(),
            "nodes": model.getNTotalNodes()}


# Operators of NL files with two arguments, and those with a list.
BINARY = {0, 1, 2, 3, 4, 5, 6, 48, 55, 56, 57, 58, 75, 76}
LISTS = {11, 12, 54, 59, 60, 61}


def with_doubles(path):
    """The path of a file whose constants in expressions are all floats, because the reader of casadi misreads
    integers in binary files."""
    content = open(path, "rb").read()
    if content[:1] != b"b":
        return path
    at = 0
    for _ in range(10):
        at = content.index(b"\n", at) + 1
    parts = [content[:at]]

    def take(count):
        nonlocal at
        at += count
        return content[at - count:at]

    def expression():
        kind = take(1)
        if kind in (b"s", b"l"):
            value, = struct.unpack("<h", take(2)) if kind == b"s" else struct.unpack("<i", take(4))
            parts.append(b"n" + struct.pack("<d", value))
        elif kind == b"n":
            parts.append(kind + take(8))
        elif kind == b"v":
            parts.append(kind + take(4))
        elif kind == b"o":
            raw = take(4)
            parts.append(kind + raw)
            code, = struct.unpack("<i", raw)
            count = 2 if code in BINARY else 1
            if code in LISTS:
                raw = take(4)
                parts.append(raw)
                count, = struct.unpack("<i", raw)
            for _ in range(count):
                expression()
        else:
            raise ValueError(f"{path}: an expression begins with {kind!r}")

    while content[at:at + 1] in (b"C", b"O", b"V"):
        kind = take(1)
        parts.append(kind + take({b"C": 4, b"O": 8, b"V": 12}[kind]))
        if kind == b"V":
            parts.append(take(12 * struct.unpack("<3i", parts[-1][1:])[1]))
        expression()
    with tempfile.NamedTemporaryFile(suffix=".nl", delete=False) as file:
        file.write(b"".join(parts) + content[at:])
    return file.name


def by_gurobi(path, limit, _):
    import casadi
    import gurobipy
    from gurobipy import GRB, nlfunc
    problem = casadi.NlpBuilder()
    problem.import_nl(with_doubles(path), {})
    x = casadi.vertcat(*problem.x)
    function = casadi.Function("f", [x], [casadi.vertcat(problem.f, *problem.g)]).expand()
    environment = gurobipy.Env(params={"OutputFlag": 0})
    model = gurobipy.Model(env=environment)
    model.Params.TimeLimit, model.Params.Threads, model.Params.MIPGap = limit, 1, GAP
    finite = lambda value: max(-GRB.INFINITY, min(GRB.INFINITY, value))
    variables = [model.addVar(lb=finite(low), ub=finite(high), vtype="I" if whole else "C")
                 for low, high, whole in zip(problem.x_lb, problem.x_ub, problem.discrete or [False] * x.numel())]
    unary = {casadi.OP_NEG: lambda a: -a, casadi.OP_EXP: nlfunc.exp, casadi.OP_LOG: nlfunc.log,
             casadi.OP_SQRT: nlfunc.sqrt, casadi.OP_SQ: lambda a: a * a, casadi.OP_TWICE: lambda a: 2 * a,
             casadi.OP_SIN: nlfunc.sin, casadi.OP_COS: nlfunc.cos, casadi.OP_TAN: nlfunc.tan,
             casadi.OP_TANH: nlfunc.tanh, casadi.OP_INV: lambda a: 1 / a, casadi.OP_ASSIGN: lambda a: a}
    binary = {casadi.OP_ADD: lambda a, b: a + b, casadi.OP_SUB: lambda a, b: a - b,
              casadi.OP_MUL: lambda a, b: a * b, casadi.OP_DIV: lambda a, b: a / b,
              casadi.OP_POW: lambda a, b: a ** b, casadi.OP_CONSTPOW: lambda a, b: a ** b}

    def named(value):
        """A variable for a value that is not a number."""
        if isinstance(value, (float, gurobipy.Var)):
            return value
        variable = model.addVar(lb=-GRB.INFINITY)
        model.addConstr(variable == value)
        return variable

    work, rows = {}, {}
    for k in range(function.n_instructions()):
        kind, at, to = function.instruction_id(k), function.instruction_input(k), function.instruction_output(k)
        if kind == casadi.OP_INPUT:
            work[to[0]] = variables[at[1]]
        elif kind == casadi.OP_CONST:
            work[to[0]] = float(function.instruction_constant(k))
        elif kind == casadi.OP_OUTPUT:
            rows[to[1]] = work[at[0]]
        elif kind in unary:
            a = work[at[0]]
            try:
                work[to[0]] = unary[kind](a)
            except Exception:
                work[to[0]] = unary[kind](named(a))
        elif kind in binary:
            a, b = work[at[0]], work[at[1]]
            try:
                work[to[0]] = binary[kind](a, b)
            except Exception:
                work[to[0]] = binary[kind](named(a), named(b))
        else:
            return {"status": "refused", "why": f"operator {kind}"}
    # The reader turns an objective that is to be large into its negative.
    sign = -1.0 if maximised(path) else 1.0
    objective = rows.pop(0)
    try:
        model.setObjective(objective, GRB.MINIMIZE)
    except Exception:
        model.setObjective(named(objective), GRB.MINIMIZE)
    for row, value in rows.items():
        low, high = problem.g_lb[row - 1], problem.g_ub[row - 1]
        if isinstance(value, float):
            continue
        linear = isinstance(value, (gurobipy.LinExpr, gurobipy.QuadExpr, gurobipy.Var))
        value = value if linear else named(value)
        if low == high:
            model.addConstr(value == low)
            continue
        if low > -1e30:
            model.addConstr(value >= low)
        if high < 1e30:
            model.addConstr(value <= high)
    model.optimize()
    names = {GRB.OPTIMAL: "optimal", GRB.TIME_LIMIT: "timelimit", GRB.INFEASIBLE: "infeasible"}
    return {"status": names.get(model.Status, str(model.Status)),
            "objective": sign * model.ObjVal if model.SolCount else None, "bound": sign * model.ObjBound,
            "nodes": int(model.NodeCount)}


SOLVERS = {"carom": by_carom, "scip": by_scip, "gurobi": by_gurobi}


def one(solver, path, limit, program):
    """An answer and the seconds of the processor that it took, from a process of its own."""
    run = subprocess.run([sys.executable, __file__, "--one", solver, path, str(limit), program],
                         capture_output=True, text=True, timeout=10 * limit + 60)
    if run.returncode != 0:
        return {"status": "failed", "why": run.stderr.strip()[-300:], "seconds": math.nan}
    return json.loads(run.stdout.splitlines()[-1])


def alone(solver, path, limit, program):
    if solver != "carom":  # Imports are not part of a solve.
        import casadi, gurobipy, pyscipopt
    used = lambda: sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    before = used()
    answer = SOLVERS[solver](path, float(limit), program)
    answer["seconds"] = used() - before
    print(json.dumps(answer))


def optima(path):
    """The listed values, and whether each is proved."""
    values = {}
    for line in open(path):
        kind, name, *value = line.split()
        if kind in ("=opt=", "=best=") and (kind == "=opt=" or name not in values):
            values[name] = float(value[0])
    return values


def verdict(answer, value, maximise):
    status, objective, bound = answer["status"], answer.get("objective"), answer.get("bound")
    slack = 2 * GAP * max(1.0, abs(value))
    if status in ("refused", "failed"):
        return status
    if status == "infeasible" or (status == "unbounded"):
        return "wrong"
    if bound is not None and (bound < value - slack if maximise else bound > value + slack):
        return "wrong"
    if objective is not None and (objective > value + slack if maximise else objective < value - slack):
        return "better"
    if status == "optimal":
        return "right" if abs(objective - value) <= slack else "wrong"
    return "open"


def maximised(path):
    """Whether the segment of the first objective, in text or in binary form, asks for the largest value."""
    content = open(path, "rb").read()
    found = re.search(rb"\nO0 ([01])", content) or re.search(rb"O\0{4}([\0\1])\0{3}[ovnsl]", content)
    return found is not None and found[1] in (b"1", b"\1")


def main():
    if sys.argv[1:2] == ["--one"]:
        return alone(*sys.argv[2:6])
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("answers")
    parser.add_argument("names", nargs="*")
    parser.add_argument("--carom", default="target/release/carom")
    parser.add_argument("--limit", type=float, default=60.0)
    parser.add_argument("--solvers", default="carom,scip,gurobi")
    options = parser.parse_intermixed_args()
    values = optima(options.answers)
    solvers = options.solvers.split(",")
    counts = {solver: {} for solver in solvers}
    logs = {}
    for name in options.names or sorted(f[:-3] for f in os.listdir(options.folder) if f.endswith(".nl")):
        path = os.path.join(options.folder, name + ".nl")
        cells, results = [], {}
        for solver in solvers:
            answer = one(solver, path, options.limit, options.carom)
            word = verdict(answer, values[name], maximised(path)) if name in values else answer["status"]
            counts[solver][word] = counts[solver].get(word, 0) + 1
            results[solver] = (word, answer["seconds"])
            objective, bound = answer.get("objective"), answer.get("bound")
            gap = "" if word != "open" or objective is None else f" gap {abs(objective - bound) / max(1e-9, abs(objective)):.1e}"
            why = f" {answer['why'][-80:]!r}" if "why" in answer else ""
            cells.append(f"{solver} {word} {answer['seconds']:.2f}{gap}{why}")
        print(f"{name:24} {values.get(name, math.nan):<14.8g} " + " | ".join(cells), flush=True)
        for other in solvers[1:]:
            if results[solvers[0]][0] == "right" == results[other][0]:
                logs.setdefault(other, []).append(math.log(max(0.01, results[solvers[0]][1]) / max(0.01, results[other][1])))
    for solver in solvers:
        print(solver, counts[solver])
    for other, ratios in logs.items():
        print(f"{solvers[0]} / {other} where both end: {math.exp(sum(ratios) / len(ratios)):.2f} ({len(ratios)} files)")


if __name__ == "__main__":
    main()
