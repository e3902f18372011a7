"""What `compare.py` says about its runs: tables, ratios, families, factors for performance profiles."""
import math

# Added to every time before a geometric mean of a family, so that milliseconds do not decide.
SHIFT = 0.01

# By how much an objective may differ from the listed one, relative to it.
TOLERANCE = 1e-6


def solved(answer):
    return answer[0] in ("optimal", "infeasible")


def agrees(answer, truth):
    """Whether a claim is the listed one: the same status, the objective up to the tolerance."""
    status, _, _, objective = answer
    if truth is None or not solved(answer):
        return True
    if truth == "infeasible" or status == "infeasible":
        return status == truth
    return abs(objective - truth) <= TOLERANCE * max(1.0, abs(truth))


def geometric_mean(values):
    return math.exp(sum(math.log(max(v, 1e-6)) for v in values) / len(values)) if values else math.nan


def cell(answer, truth):
    status, seconds, nodes, objective = answer
    if not solved(answer):
        return f"> {seconds:.0f}" if status == "limit" else {"no MIQP": "no MIQP", "no cones": "no cones", "too large": ""}.get(status, "-" if status.startswith("error") else status)
    mark = "" if agrees(answer, truth) else f" **{status if objective is None else f'{objective:.8g}'}**"
    return f"{seconds:.3f} ({nodes}){mark}"


def table(results, names, truths):
    print("| file | status, objective | " + " | ".join(names) + " |")
    print("| --- " * (2 + len(names)) + "|")
    for file, answers in results.items():
        truth = truths.get(file)
        shown = truth if isinstance(truth, str) else "?" if truth is None else f"{truth:.8g}"
        print(f"| {file} | {shown} | " + " | ".join(cell(answers[name], truth) for name in names) + " |")
    print()


def ratios(results, ours, others, truths, files, title):
    """Geometric means over the files that both solve to the listed answer."""
    lines = []
    for other in others:
        pairs = []
        beyond = 0
        for file in files:
            mine, theirs = results[file][ours], results[file][other]
            if not (solved(mine) and agrees(mine, truths.get(file))):
                continue
            if solved(theirs) and agrees(theirs, truths.get(file)):
                pairs.append((mine[1], theirs[1]))
            elif theirs[0] == "limit":
                # A lower bound of what the other one needs.
                pairs.append((mine[1], theirs[1]))
                beyond += 1
        if pairs:
            mine, theirs = (geometric_mean(column) for column in zip(*pairs))
            note = f" ({beyond} at the limit, counted with it)" if beyond else ""
            lines.append(f"| {ours} | {other} | {len(pairs)}{note} | {mine:.4f} | {theirs:.4f} | {mine / theirs:.3f} |")
    if lines:
        print(f"{title}:\n\n| | beside | files | seconds | seconds beside | ratio |\n| --- | --- | --- | --- | --- | --- |")
        print("\n".join(lines) + "\n")


def charged(answer, truth, limit):
    """The seconds that count: the limit for whoever does not solve the file, or solves it wrongly."""
    return min(answer[1], limit) if solved(answer) and agrees(answer, truth) else limit


def was_asked(answer):
    """Whether the solver could read the file and its licence covers it."""
    return solved(answer) or answer[0] == "limit"


def shifted_mean(values):
    return geometric_mean([value + SHIFT for value in values]) - SHIFT


def families(results, names, truths, limit):
    """Per family (folder): how many files each solver solves, and its shifted geometric mean; beside
    others, over the files that both were asked."""
    groups = {}
    for file in results:
        groups.setdefault(file.rpartition("/")[0] or "all", []).append(file)
    ours = names[0]
    print(f"Per family: files solved, and the geometric mean of seconds (shifted by {SHIFT:g} s; {limit:g} s for what is "
          f"not solved); beside another solver, the ratio of {ours}'s mean to its mean over the files it could read.\n")
    print("| family | files | " + " | ".join(names) + " |")
    print("| --- " * (2 + len(names)) + "|")
    for family, files in groups.items():
        cells = []
        for name in names:
            asked = [file for file in files if was_asked(results[file][name])]
            if not asked:
                cells.append("-")
                continue
            done = sum(solved(results[file][name]) and agrees(results[file][name], truths.get(file)) for file in asked)
            mean = shifted_mean([charged(results[file][name], truths.get(file), limit) for file in asked])
            text = f"{done} of {len(asked)}, {mean:.3f}"
            if name != ours:
                mine = shifted_mean([charged(results[file][ours], truths.get(file), limit) for file in asked])
                text += f" ({(mine + SHIFT) / (mean + SHIFT):.2f})"
            cells.append(text)
        print(f"| {family} | {len(files)} | " + " | ".join(cells) + " |")
    print()


def profile(path, results, names, truths, limit):
    """The factors of the best time for a performance profile, as CSV; the example `profile` draws it.
    Only files that every solver could read count (Dolan and More, 2002)."""
    files = [file for file in results if all(was_asked(results[file][name]) for name in names)]
    files = [file for file in files if any(solved(results[file][name]) for name in names)]
    if not files:
        return 0
    factors = {name: [] for name in names}
    for file in files:
        times = {name: results[file][name][1] + SHIFT for name in names
                 if solved(results[file][name]) and agrees(results[file][name], truths.get(file))}
        best = min(times.values(), default=math.inf)
        for name in names:
            factors[name].append(times[name] / best if name in times else math.inf)
    with open(path, "w") as file:
        file.write("solver,factor\n")
        for name in names:
            for factor in factors[name]:
                file.write(f"{name},{'' if factor == math.inf else f'{factor:.4g}'}\n")
    return len(files)
