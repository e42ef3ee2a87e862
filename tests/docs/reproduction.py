#!/usr/bin/env python3
"""The tables of docs/results/reproduction.md, made from the numbers of `covtrace reproduce`.

    tests/docs/reproduction.py [DIR/results.json ...]

takes the experiments of these files, in the order that they are given, into docs/results/reproduction.json, in the
place of older ones of the same name, and writes the tables between the document's marks anew. Without a file it only
writes the tables. The text around the marks is written by hand."""

import json
import pathlib
import re
import sys

import wrap_prose

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "docs/results"
DOCUMENT, NUMBERS = FOLDER / "reproduction.md", FOLDER / "reproduction.json"
# Experiments in the order of the page.
ORDER = ["pipeline", "slice", "sampling", "lens", "motion", "shininess", "snooker", "helicopter", "table", "voxels", "progressive"]
METHODS = {
    "covariance": "`covariance`, the thesis' method",
    "covariance on demand": "`covariance --progressive`, as the thesis proposes",
    "hybrid": "`hybrid`, what goes past it",
}
MARK = re.compile(r"<!-- tables: ([\w-]+) -->\n.*?<!-- end of tables -->", re.DOTALL)


def digest(results):
    """The part of one results.json that the document needs, by experiment."""
    program = results["facts"]["program"]
    commit = re.search(r"\(([^()]*)\)$", program)
    return {
        name: {
            "size": results["size"],
            "pixels": experiment["resolution"],
            "seeds": results["facts"]["seeds"],
            "commit": commit[1] if commit else program,
            "command": re.sub(r"^\S+", "covtrace", results["command"]),  # wherever the program is
            "seconds_cpu": round(experiment["seconds_cpu"]),
            "claims": experiment["claims"],
            "tables": [{"caption": t["caption"], "columns": t["columns"], "rows": t["rows"]} for t in experiment["tables"]],
        }
        for name, experiment in results["experiments"].items()
        if "failure" not in experiment
    }


def cell(text):
    """Text that a table's cell may hold."""
    return " ".join(text.split()).replace("|", "\\|")


def table(columns, rows):
    lines = [columns, ["---"] * len(columns), *rows]
    return "\n".join("| " + " | ".join(map(cell, line)) + " |" for line in lines) + "\n"


def size_of(experiment):
    return f"`{experiment['size']}`, " + "x".join(map(str, experiment["pixels"]))


def runs(experiments):
    return table(
        ["experiment", "size", "seeds", "commit", "CPU seconds", "claims that hold"],
        [
            [
                f"`{name}`", size_of(e), e["seeds"], e["commit"], str(e["seconds_cpu"]),
                f"{sum(c['holds'] is True for c in e['claims'].values())} of {sum(c['holds'] is not None for c in e['claims'].values())}",
            ]
            for name, e in experiments
        ],
    )


def claims(experiments):
    verdicts = {True: "holds", False: "**does not hold**", None: "not judged"}
    return table(
        ["experiment", "claim", "thesis", "asked for", "found", "", "size"],
        [
            [f"`{name}`", c["statement"], c["thesis"], c["required"], c["found"], verdicts[c["holds"]], size_of(e)]
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
            method = METHODS.get(row[0], row[0])
            rows.append([name, method, *(row[i] for i in at), size_of(e)])
    return table(["scene", "method", *wanted, "size"], rows) if rows else "Not among these runs.\n"


def tables(experiments):
    parts = []
    for name, e in experiments:
        for t in e["tables"]:
            parts.append(wrap_prose.wrap(f"`{name}` ({size_of(e)}). {t['caption'].rstrip('.')}:\n") + "\n" + table(t["columns"], t["rows"]))
    return "\n".join(parts)


PARTS = {"runs": runs, "claims": claims, "ratio": ratio, "tables": tables}


def written(document, numbers):
    """The document's text with the tables that these numbers make."""
    experiments = sorted(numbers.items(), key=lambda item: ORDER.index(item[0]))
    return MARK.sub(lambda m: f"<!-- tables: {m[1]} -->\n\n{PARTS[m[1]](experiments)}\n<!-- end of tables -->", document)


def main():
    numbers = json.loads(NUMBERS.read_text()) if NUMBERS.exists() else {}
    for name in sys.argv[1:]:
        numbers.update(digest(json.loads(pathlib.Path(name).read_text())))
    if sys.argv[1:]:
        NUMBERS.write_text(json.dumps(numbers, indent=1, sort_keys=True, ensure_ascii=False) + "\n")
    DOCUMENT.write_text(written(DOCUMENT.read_text(), numbers))


if __name__ == "__main__":
    main()
