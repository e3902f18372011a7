"""Verdicts over a folder with `answers.csv`: is what carom says about each file right?

The columns `file`, `status` and `objective` are read, others are not; a column `name` without the
extension of the file does as well. The table may also stand beside the folder. A status is
`optimal` (with an objective), `feasible` (any point will do), `infeasible`, `unbounded`, `refused` (a
typed error is the right answer), or `refused_or_VALUE` (an error, or that objective). Any other word
is an open question, and the file is only run.
"""
import csv
import os

# Relative to max(1, |objective|), as for all listed answers.
TOLERANCE = 1e-6

# The same for conic files: their listed answers are what conic solvers agree on.
CONIC_TOLERANCE = 1e-4

EXTENSIONS = (".mps", ".lp", ".cbf", ".mps.gz", ".lp.gz", ".cbf.gz")

# What counts against the crate. `limit` does not: it depends on the machine and the time given.
FAILURES = ("wrong", "refused", "stalled", "broken", "missing")
VERDICTS = ("right", *FAILURES, "limit", "open")


def tolerance(file):
    return CONIC_TOLERANCE if file.endswith((".cbf", ".cbf.gz")) else TOLERANCE


def close(one, other, allowed=TOLERANCE):
    return abs(one - other) <= allowed * max(1.0, abs(other))


def stem(path):
    """The path without the extension of a model file, also a compressed one."""
    for extension in sorted(EXTENSIONS, key=len, reverse=True):
        if path.endswith(extension):
            return path.removesuffix(extension)
    return os.path.splitext(path)[0]


def number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return None


def listed(folder):
    """The rows of `answers.csv`, by file; `None` if there is no such table."""
    for place in (folder, os.path.dirname(os.path.normpath(os.path.abspath(folder)))):
        path = os.path.join(place, "answers.csv")
        if not os.path.exists(path):
            continue
        rows = {}
        with open(path, newline="") as file:
            for row in csv.DictReader(file):
                if "file" in row:
                    names = [row["file"]]
                elif row.get("name") and row.get("status"):
                    names = [row["name"] + extension for extension in EXTENSIONS]
                else:
                    continue
                found = [name for name in names if os.path.exists(os.path.join(folder, name))]
                # What is listed beside other files is missing if it is not there.
                if found or place == folder:
                    rows[(found or names)[0]] = row
        if rows:
            return rows
    return None


def allowed(row):
    """The right statuses, and the right objective where there is one."""
    status, objective = (row.get("status") or "").strip(), number(row.get("objective"))
    if status.startswith("refused_or_"):
        return ("refused", "optimal"), number(status.removeprefix("refused_or_"))
    if status == "feasible":
        return ("optimal", "feasible"), None
    if status in ("infeasible", "unbounded", "refused"):
        return (status,), None
    return (("optimal",), objective) if status == "optimal" and objective is not None else ((), None)


def contradicts(said, statuses, objective, allowed=TOLERANCE):
    """Whether a stopped search claims what cannot be: a point of an infeasible program, or an optimum
    outside of what lies between its point and its bound. Which side the bound is on tells the sense."""
    point, bound = said["objective"], said["bound"]
    if point is None:
        return False
    if statuses == ("infeasible",):
        return True
    if objective is None or bound is None:
        return False
    low, high = min(point, bound), max(point, bound)
    return not (low <= objective <= high or close(low, objective, allowed) or close(high, objective, allowed))


def verdict(row, said, near=TOLERANCE):
    """One of `VERDICTS`. `said`: `status` as the example `solve` prints it, or `refused` or `broken`;
    `stalled`; `objective` and `bound`, `None` if there is none."""
    statuses, objective = allowed(row)
    status = said["status"]
    if status == "broken" or not statuses:
        return "broken" if status == "broken" else "open"
    if status in statuses:
        right = status in ("refused", "infeasible", "unbounded") or objective is None
        return "right" if right or close(said["objective"], objective, near) else "wrong"
    if status == "refused":
        return "refused"
    if status in ("optimal", "infeasible", "unbounded") or contradicts(said, statuses, objective, near):
        return "wrong"
    return "stalled" if said["stalled"] else "limit"


def shown(row):
    status, objective = row.get("status") or "?", row.get("objective")
    return f"{status} {objective}" if objective else status


def report(title, rows, outcomes):
    """Prints the verdicts; returns the number of failures."""
    verdicts = {}
    for file, row in rows.items():
        verdicts[file] = verdict(row, outcomes[file], tolerance(file)) if file in outcomes else "missing"
    count = {word: list(verdicts.values()).count(word) for word in VERDICTS}
    print(f"Verdicts, {title}:\n\n| file | right answer | carom | seconds | verdict |\n| --- | --- | --- | --- | --- |")
    for file, word in verdicts.items():
        said = outcomes.get(file, {"status": "-", "objective": None, "seconds": 0.0, "note": ""})
        value = "" if said["objective"] is None else f" {said['objective']:.12g}"
        mark = f"**{word}**" if word in FAILURES else word
        note = f": {said['note']}" if word != "right" and said["note"] else ""
        print(f"| {file} | {shown(rows[file])} | {said['status']}{value} | {said['seconds']:.3f} | {mark}{note} |")
    failures = sum(count[word] for word in FAILURES)
    summary = ", ".join(f"{number} {word}" for word, number in count.items() if number)
    print(f"\n{len(verdicts)} files: {summary or 'none'}. {failures} failures.\n")
    return failures
