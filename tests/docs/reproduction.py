#!/usr/bin/env python3
"""The tables of docs/results/reproduction.md, made from the numbers of `covtrace reproduce`.

    tests/docs/reproduction.py DIR/results.json

holds the claims of a run of one's own against the published numbers, docs/results/reproduction.json, by tolerances,
and writes nothing. Exit codes: 0 all within, 1 some are not, or are missing, or an experiment failed, 2 nothing can be
compared (another size). For maintainers:

    tests/docs/reproduction.py --publish DIR/results.json [...]
    tests/docs/reproduction.py

The first takes the experiments of these files into docs/results/reproduction.json, in the place of older ones of the
same name, and their figures into docs/images/reproduction (with /usr/bin/python3, which has numpy); both write the
tables between the document's marks anew. The text around the marks is written by hand."""

import json
import pathlib
import re
import shutil
import sys

import reproduction_verdicts
import wrap_prose

DOCS = pathlib.Path(__file__).resolve().parents[2] / "docs"
DOCUMENT, NUMBERS = DOCS / "results/reproduction.md", DOCS / "results/reproduction.json"
PICTURES = DOCS / "images/reproduction"
# Experiments in the order of the page, and the figures of each that stand on it. Those of lines and letters are SVG.
FIGURES = {
    "pipeline": ["pipeline.png", "pipeline-filters.png"],
    "slice": ["slice.svg"],
    "sampling": ["sampling.svg"],
    "lens": ["lens.png"],
    "motion": ["motion.png"],
    "shininess": ["shininess.png"],
    "snooker": ["snooker.png", "snooker-insets.png"],
    "helicopter": ["helicopter.png", "helicopter-insets.png"],
    "table": [],
    "voxels": ["voxels.png"],
    "progressive": ["progressive.png"],
}
ORDER = list(FIGURES)
METHODS = {
    "covariance": "`covariance`: the thesis' prediction; occluders, lobes, and counts and filters by what samples tell are ours",
    "covariance on demand": "`covariance --progressive`: the same, up to four samples by the planner of `hybrid`",
    "hybrid": "`hybrid`: not the thesis'",
    "covariance, predicted filters alone": "`covariance --density tempered --filter predicted`: nothing that samples tell",
}
FOLDER = "out/thesis"  # of a run, in the commands of the page
MARK = re.compile(r"<!-- tables: ([\w-]+) -->\n.*?<!-- end of tables -->", re.DOTALL)
# How far the same claim may be from the published one: what depends on CPU seconds, on a busy machine, an angle that is
# 0 but for rounding (in degrees), and what depends on the samples, which other processors round differently. Relative,
# then absolute: small claims are of 1e-4 and more.
TOLERANCES = [
    (re.compile("equal_error|equal_time|share|thesis_choices|progressive"), 0.3, 0.002),
    (re.compile("motion_direction"), 0.05, 0.05),
    (re.compile(""), 0.05, 1e-4),
]


def as_on_the_page(command, folder):
    """A command with the folder of its run named as on the page, wherever that was."""
    return re.sub(rf"(?<!\S){re.escape(folder)}(?=[/\s]|$)", FOLDER, command) if folder else command


def digest(results):
    """The part of one results.json that the document needs, by experiment."""
    program = results["facts"]["program"]
    commit = re.search(r"\(([^()]*)\)$", program)
    written_to = re.search(r" -o (\S+)", results["command"])
    folder = written_to and written_to[1].rstrip("/")
    return {
        name: {
            "title": experiment["title"],
            "thesis": experiment["thesis"],
            "size": results["size"],
            "pixels": experiment["resolution"],
            "counts": experiment["counts"],
            "commit": commit[1] if commit else program,
            "command": as_on_the_page(re.sub(r"^\S+", "covtrace", results["command"]), folder),  # wherever the program is
            "seconds_cpu": round(experiment["seconds_cpu"]),
            "claims": {key: {**c, "command": as_on_the_page(c["command"], folder)} for key, c in experiment["claims"].items()},
            "captions": {pathlib.Path(f["file"]).stem: f["caption"] for f in experiment["figures"]},
            "tables": [{"caption": t["caption"], "columns": t["columns"], "rows": t["rows"]} for t in experiment["tables"]],
            "notes": experiment["notes"],
            "variants": experiment["data"].get("variants", {}),
        }
        for name, experiment in results["experiments"].items()
        if "failure" not in experiment
    }


def failures(results):
    """Errors of the experiments of one results.json that could not be run, by experiment."""
    return {name: experiment["failure"] for name, experiment in results["experiments"].items() if "failure" in experiment}


def cell(text):
    """Text that a table's cell may hold."""
    return " ".join(text.split()).replace("|", "\\|")


def table(columns, rows):
    lines = [columns, ["---"] * len(columns), *rows]
    return "\n".join("| " + " | ".join(map(cell, line)) + " |" for line in lines) + "\n"


def paragraph(text):
    return wrap_prose.wrap(" ".join(text.split()) + "\n")


def size_of(experiment):
    return f"`{experiment['size']}`, " + "x".join(map(str, experiment["pixels"]))


def verdicts(experiments):
    return table(["thesis", "experiment", "reproduced?", "by how much", "why"], reproduction_verdicts.rows(dict(experiments)))


def held(claims):
    judged = [c for c in claims.values() if c["holds"] is not None]
    if judged:
        return f"{sum(c['holds'] for c in judged)} of {len(judged)}" + (f", {len(claims) - len(judged)} not judged" if len(judged) < len(claims) else "")
    return f"none judged at this size ({len(claims)} printed)" if claims else "none"


def runs(experiments):
    return table(
        ["experiment", "pixels", "samples and seeds", "CPU seconds", "claims that hold"],
        [
            [
                f"`{name}`", "x".join(map(str, e["pixels"])), e["counts"], str(e["seconds_cpu"]), held(e["claims"]),
            ]
            for name, e in experiments
        ],
    ) + "\n" + paragraph("Size and commit: " + "; ".join(sorted({f"`{e['size']}`, {e['commit']}" for _, e in experiments})) + ".")


def claims(experiments):
    words = {True: "holds", False: "**does not hold**", None: "not judged at this size"}
    return table(
        ["experiment", "claim", "thesis", "asked for, by us", "found", "verdict"],
        [
            [f"`{name}`", c["statement"], c["thesis"], c["required"], c["found"], words[c["holds"]]]
            for name, e in experiments
            for c in e["claims"].values()
        ],
    )


def ratio(experiments):
    """Ratios of times at equal error, each method in a row of its own."""
    wanted = ["samples per pixel", "seconds", "error", "path tracer, same error", "ratio of times"]
    rows = []
    for name, e in experiments:
        if name not in ("snooker", "helicopter"):
            continue
        comparison = e["tables"][0]
        at = [comparison["columns"].index(column) for column in wanted]
        for row in comparison["rows"]:
            rows.append([name, METHODS.get(row[0], row[0]), *(row[i] for i in at)])
    return table(["scene", "method", *wanted], rows) if rows else "Not among these runs.\n"


def experiments(all_of_them):
    """Every experiment: what Belcour 2012 shows, pictures with their captions, tables, notes."""
    parts = []
    for name, e in all_of_them:
        parts.append(f"### {e['title']}\n")
        size = "" if e["size"] == "full" else f" --{e['size']}"
        parts.append(paragraph(f"{e['thesis']} Here: `covtrace reproduce {name}{size} -o DIR`, {size_of(e).split(', ')[1]} pixels, {e['counts']}."))
        for file in FIGURES[name]:
            stem = pathlib.Path(file).stem
            parts.append(f"![{e['title'].partition(': ')[2]}](../images/reproduction/{file})\n")
            parts.append(paragraph(e["captions"][stem]))
        for t in e["tables"]:
            parts.append(paragraph(t["caption"].rstrip(".") + ":") + "\n" + table(t["columns"], t["rows"]))
        parts += [paragraph(note) for note in e["notes"]]
    return "\n".join(parts)


PARTS = {"verdicts": verdicts, "runs": runs, "claims": claims, "ratio": ratio, "experiments": experiments}


def written(document, numbers):
    """The document's text with the tables that these numbers make."""
    ordered = sorted(numbers.items(), key=lambda item: ORDER.index(item[0]))
    return MARK.sub(lambda m: f"<!-- tables: {m[1]} -->\n\n{PARTS[m[1]](ordered)}\n<!-- end of tables -->", document)


def published():
    return json.loads(NUMBERS.read_text()) if NUMBERS.exists() else {}


def compare(numbers, own, failed):
    """Lines that hold the claims of one's own experiments against the published ones, and the exit code. What failed, and
    claims that are published and missing in an experiment of one's own, are faults."""
    lines = [f"{name}: FAILED: {failure}" for name, failure in failed.items()]
    differ, missing, compared = 0, 0, 0
    for name, e in own.items():
        if name not in numbers or numbers[name]["size"] != e["size"]:
            lines.append(f"{name}: not published at the size {e['size']}")
            continue
        lost = [key for key in numbers[name]["claims"] if key not in e["claims"]]
        lines += [f"{key}: published and MISSING here" for key in lost]
        missing += len(lost)
        for key in e["claims"]:
            if key not in numbers[name]["claims"]:
                lines.append(f"{key}: not published")
                continue
            there, here = (n["claims"][key] for n in (numbers[name], e))
            relative, absolute = next((r, a) for pattern, r, a in TOLERANCES if pattern.search(key))
            a, b = there["value"], here["value"]
            within = a == b or None not in (a, b) and abs(a - b) <= absolute + relative * abs(a)
            worse = there["holds"] is True and here["holds"] is False
            compared += 1
            differ += not within or worse
            word = "holds there and not here" if worse else "within" if within else "NOT within"
            lines.append(f"{key}: published {a}, here {b}, {word} {100 * relative:.0f} % and {absolute:g}")
    lines.append(f"{compared} claims compared, {differ} differ, {missing} missing, {len(failed)} experiments failed")
    return lines, 1 if differ or missing or failed else 2 if compared == 0 else 0


def publish(names):
    import small_png

    numbers = published()
    for name in map(pathlib.Path, names):
        taken = digest(json.loads(name.read_text()))
        numbers.update(taken)
        PICTURES.mkdir(exist_ok=True)
        for file in (file for experiment in taken for file in FIGURES[experiment]):
            if file.endswith(".png"):
                small_png.shrink(name.parent / "figures" / file, PICTURES / file)
            else:
                shutil.copyfile(name.parent / "figures" / file, PICTURES / file)
    NUMBERS.write_text(json.dumps(numbers, indent=1, sort_keys=True, ensure_ascii=False) + "\n")


def main(arguments):
    if arguments and arguments[0] != "--publish":
        if len(arguments) != 1 or arguments[0].startswith("-"):
            print(__doc__)
            return 0 if arguments[0] in ("-h", "--help") else 2
        results = json.loads(pathlib.Path(arguments[0]).read_text())
        lines, code = compare(published(), digest(results), failures(results))
        print("\n".join(lines))
        return code
    if arguments:
        publish(arguments[1:])
    DOCUMENT.write_text(written(DOCUMENT.read_text(), published()))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
