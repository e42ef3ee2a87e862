"""The documents: every link leads somewhere, every command is one that the program understands, constants are those of the
code, prose is wrapped, the decisions' index lists each record, the reproduction's tables are those of its numbers."""

import contextlib
import functools
import io
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import unittest
from urllib.parse import unquote

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import decisions
import markdown
import reproduction
import reproduction_verdicts
import wrap_prose

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("COVTRACE", str(ROOT / "build/release/covtrace"))
# Folders that hold no documents of the project.
NOT_OURS = {"build", "out", ".git", "node_modules"}
OPTION = re.compile(r"(?<![\w-])(--?[a-zA-Z][\w-]*)")
SOURCE = re.compile(r"(?:src|studies|cli|covariance|viewer|python|blender|tests)/[\w./-]*\w/?$|[a-z]+/\w+\.(?:h|hpp|cpp)$")
SCRIPT = re.compile(r"(?:\./)?((?:scripts|bench|tests|scenes|fuzz|packaging)/[\w./-]*[\w])$")
BENCHMARK = re.compile(r"(?:\./)?build/release/bench/([\w-]+)$")


def documents():
    return sorted(file for file in ROOT.rglob("*.md") if not NOT_OURS & set(file.relative_to(ROOT).parts))


def sources():
    """Text files beside the documents, in which comments name documents."""
    endings = {".h", ".hpp", ".cpp", ".py", ".in", ".txt", ".cmake", ".pbrt", ".js", ".html", ""}
    for folder in ("src", "studies", "cli", "covariance", "viewer", "python", "blender", "bench", "tests", "scenes", "scripts", "fuzz", "cmake", "docs", "packaging"):
        for file in (ROOT / folder).rglob("*"):
            parts = set(file.relative_to(ROOT).parts)
            if file.is_file() and file.suffix in endings and not parts & (NOT_OURS | {"generated", "corpus", "__pycache__"}):
                yield file


@functools.cache
def help_of(*command):
    result = subprocess.run([*command, "--help"], capture_output=True, text=True, timeout=120)
    return result.stdout if result.returncode == 0 else None


@functools.cache
def text_of(file):
    return file.read_text(errors="replace")


@functools.cache
def options_of_all():
    """The help of the program's commands, and that of all scripts."""
    commands = re.findall(r"(?m)^  ([a-z]+)  ", help_of(PROGRAM).partition("Subcommands:")[2])
    scripts = [file for folder in ("bench", "scripts", "scenes") for file in (ROOT / folder).rglob("*")
               if file.is_file() and file.suffix in ("", ".py")]
    return "\n".join([*(help_of(PROGRAM, command) for command in commands), *map(text_of, scripts)])


def statements(code):
    """Shell statements of a block: lines joined at their backslashes, without comments, split at ; && || |."""
    joined = re.sub(r"\\\n\s*", " ", "\n".join(code))
    for line in joined.split("\n"):
        try:
            lexer = shlex.shlex(line, posix=True, punctuation_chars=";&|")
            lexer.whitespace_split = True
            words = list(lexer)
        except ValueError:
            continue  # an open quotation: text of another language
        statement = []
        for word in words + [";"]:
            if set(word) <= set(";&|"):
                if statement:
                    yield statement
                statement = []
            else:
                statement.append(word)


def command_of(statement):
    """A statement without the words before its command: assignments, `sudo`, the `do` of a loop."""
    words = list(statement)
    while words and (re.match(r"\w+=(?!\$\()", words[0]) or words[0] in ("sudo", "do")):
        words.pop(0)
    return words


class Documents(unittest.TestCase):
    maxDiff = None

    def report(self, faults):
        self.assertEqual(faults, [], "\n" + "\n".join(faults))

    def test_links_lead_somewhere(self):
        faults, followed = [], 0
        for file in documents():
            for number, target in markdown.links(text_of(file)):
                if re.match(r"[a-z]+:", target):
                    continue
                followed += 1
                name, _, anchor = unquote(target).partition("#")
                to = (file.parent / name).resolve() if name else file
                where = f"{file.relative_to(ROOT)}:{number}: {target}"
                if not to.exists():
                    faults.append(f"{where}: there is no such file")
                elif ROOT not in to.parents:
                    faults.append(f"{where}: leads out of the project")
                elif anchor and anchor not in markdown.anchors(text_of(to)):
                    faults.append(f"{where}: there is no such heading")
        self.report(faults)
        self.assertGreater(followed, 300)

    def test_sources_name_documents_that_exist(self):
        faults, named = [], 0
        for file in sources():
            for name in re.findall(r"(?<![\w/.])docs/[\w./-]*\w", text_of(file)):
                named += 1
                is_record = re.search(r"/\d{4}$", name)
                if not (list(ROOT.glob(f"{name}-*.md")) if is_record else (ROOT / name).exists()):
                    faults.append(f"{file.relative_to(ROOT)}: {name} does not exist")
        self.report(faults)
        self.assertGreater(named, 30)

    def check(self, where, statement):
        """The fault of a command, or None; counts those that it understands."""
        words = command_of(statement)
        if not words:
            return None
        name, arguments = words[0], words[1:]
        if name.startswith("--"):  # options alone: of some command of ours
            text, arguments = options_of_all(), words
        elif re.fullmatch(r"(?:\S*/)?covtrace", name) and arguments and re.fullmatch(r"[a-z]+", arguments[0]):
            text = help_of(PROGRAM, arguments[0])
            if text is None:
                return f"{where}: 'covtrace {arguments[0]}' is no command"
        elif SCRIPT.match(name):
            script = ROOT / SCRIPT.match(name)[1]
            if not script.is_file():
                return f"{where}: there is no {name}"
            text = help_of(str(script)) if os.access(script, os.X_OK) and "bench" in script.relative_to(ROOT).parts else None
            text = text or text_of(script)  # those that have no help, or not with this Python, hold their options as text
        elif BENCHMARK.match(name):
            if not list((ROOT / "bench").rglob(BENCHMARK.match(name)[1] + ".cpp")):
                return f"{where}: there is no {name}"
            self.commands += 1
            return None
        else:
            return None
        for argument in arguments:
            option = OPTION.match(argument)
            if argument.startswith("-") and option and not re.search(rf"(?<![\w-]){re.escape(option[1])}(?![\w-])", text):
                return f"{where}: {' '.join(words[:2])} has no {option[1]}"
        self.commands += 1
        return None

    def test_commands_are_understood(self):
        self.commands = 0
        faults = []
        for file in documents():
            if file.name == "CHANGELOG.md" or file.parent.name == "archive":
                continue  # of their day
            name = file.relative_to(ROOT)
            for number, language, code in markdown.blocks(text_of(file)):
                if language in ("", "bash", "sh"):
                    faults += [self.check(f"{name}:{number}", s) for s in statements(code)]
            for number, code in markdown.code_spans(text_of(file)):
                if " " in code:
                    faults += [self.check(f"{name}:{number}", s) for s in statements([code])]
                elif SOURCE.match(code):
                    bases = (ROOT, ROOT / "src", ROOT / "studies", ROOT / "covariance/include", file.parent)
                    if not any((base / code).exists() for base in bases):
                        faults.append(f"{name}:{number}: there is no {code}")
                elif (path := SCRIPT.match(code)) and not re.search(r"[A-Z]{3}|generated", code):
                    places = [ROOT / path[1], file.parent / path[1], ROOT / f"{path[1]}.cpp"]
                    if not any(place.exists() for place in places):
                        faults.append(f"{name}:{number}: there is no {code}")
        self.report([fault for fault in faults if fault])
        self.assertGreater(self.commands, 150)

    def test_constants_are_those_of_the_code(self):
        file = ROOT / "docs/internals/hybrid.md"
        rows = re.findall(r"(?m)^\| `(\w+)` \| (\S.*?) \| \[`[^`]+`\]\(([^)]+)\)", text_of(file))
        faults = []
        for name, value, target in rows:
            source = (file.parent / target).resolve()
            number = r"f?(?![\w.])" if re.fullmatch(r"[\d.e-]+", value) else ""
            wanted = rf"\b{name}\s*=?\s*{re.escape(value)}{number}"
            if not source.exists() or not re.search(wanted, text_of(source)):
                faults.append(f"{name} is not {value} in {target}")
        self.report(faults)
        self.assertGreater(len(rows), 40)

    def test_names_stand_in_the_files_beside_them(self):
        """Where a row or paragraph on the inside names a function or type and links files, one of these has it."""
        faults, looked_for = [], 0
        everything = "\n".join(text_of(f) for f in sources() if f.suffix in {".h", ".hpp", ".cpp", ".py"})
        for document in ("architecture", "follow-one-sample", "follow-one-covariance", "hybrid", "prediction"):
            file = ROOT / f"docs/internals/{document}.md"
            for block in re.split(r"\n(?=\||- |\d+\. |#|\n)", markdown.prose(text_of(file))):
                targets = [(file.parent / target.partition("#")[0]).resolve() for _, target in markdown.links(block)
                           if not re.match(r"[a-z]+:", target)]
                files = [f for target in targets for f in (target.glob("*.*") if target.is_dir() else [target])
                         if f.suffix in {".h", ".hpp", ".cpp", ".py"}]
                text = "\n".join(map(text_of, files)) or everything
                for _, code in markdown.code_spans(block):
                    if not re.fullmatch(r"[A-Za-z]\w*(?:[A-Z_]|::)\w*", code) or re.fullmatch(r"[A-Z_]+", code):
                        continue  # methods, layers, variables of the environment
                    looked_for += 1
                    if not all(re.search(rf"\b{part}\b", text) for part in code.split("::")):
                        faults.append(f"{file.name}: {code} stands in none of {', '.join(f.name for f in files) or 'the sources'}")
        self.report(faults)
        self.assertGreater(looked_for, 90)

    def test_prose_is_wrapped(self):
        faults = []
        for file in documents():
            for line in markdown.lines(text_of(file)):
                if line.kind != "prose" or len(line.text) <= wrap_prose.WIDTH or re.search(r"\]\(|https?:", line.text):
                    continue
                faults.append(f"{file.relative_to(ROOT)}:{line.number}: {len(line.text)} columns (tests/docs/wrap_prose.py wraps)")
        self.report(faults)

    def test_tables_have_heads(self):
        """Without a first row above its line of dashes a table is shown as text."""
        faults, tables = [], 0
        for file in documents():
            lines = markdown.lines(text_of(file))
            for above, line, below in zip(lines, lines[1:], lines[2:]):
                if line.kind != "table" or above.kind == "table":
                    continue
                tables += 1
                cells = len(re.findall(r"(?<!\\)\|", line.text))
                if not re.fullmatch(r" *\|(?: *:?-+:? *\|)+ *", below.text) or below.text.count("|") != cells:
                    faults.append(f"{file.relative_to(ROOT)}:{line.number}: the table has no head, or its second line no dashes")
        self.report(faults)
        self.assertGreater(tables, 50)

    def test_readme_is_short(self):
        self.assertLessEqual(len(text_of(ROOT / "README.md").splitlines()), 70)

    def test_decisions_have_one_form_and_an_index(self):
        faults, numbers = [], set()
        for record in decisions.records():
            name = record.file.relative_to(ROOT)
            if not record.number or not record.file.name.startswith(record.number):
                faults.append(f"{name}: expected '# NNNN: title' with the file's number")
            elif record.status is None:
                faults.append(f"{name}:3: expected 'Status: in force. Area: …' or living, superseded by, folded into")
            elif re.match("in force|living", record.status) and not {"Question", "Decision"} <= set(record.sections):
                faults.append(f"{name}: lacks a section Question or Decision")
            elif re.match("superseded|folded", record.status) and not record.later():
                faults.append(f"{name}:3: by which record? expected a link")
            elif record.archived != bool(re.match("superseded|folded", record.status)):
                faults.append(f"{name}: the archive holds what is superseded or folded, and nothing else does")
            if record.number in numbers:
                faults.append(f"{name}: the number is taken")
            numbers.add(record.number)
        self.report(faults)
        self.assertEqual(text_of(decisions.FOLDER / "README.md"), decisions.index(),
                         "the index is not that of the records: tests/docs/decisions.py --write")

    def test_reproduction_is_made_from_its_numbers(self):
        numbers = json.loads(text_of(reproduction.NUMBERS))
        document = text_of(reproduction.DOCUMENT)
        self.assertEqual(document, reproduction.written(document, numbers),
                         "its tables are not those of its numbers: tests/docs/reproduction.py")
        self.assertEqual([part for part in reproduction.PARTS if f"<!-- tables: {part} -->" not in document], [])
        self.assertLessEqual(set(numbers), set(reproduction.ORDER))
        self.assertGreater(document.count("| holds |"), 10)
        # Every claim of every experiment stands there, with its bound and what was found.
        for experiment in numbers.values():
            for claim in experiment["claims"].values():
                for text in (claim["statement"], claim["required"], claim["found"]):
                    self.assertIn(reproduction.cell(text), document)

    def test_a_run_is_held_against_the_published_numbers(self):
        numbers = json.loads(text_of(reproduction.NUMBERS))

        def outcome(change):
            own = json.loads(text_of(reproduction.NUMBERS))
            change(own)
            return reproduction.compare(numbers, own, {})[1]

        def scaled(experiment, claim, factor):
            def change(own):
                own[experiment]["claims"][claim]["value"] *= factor
            return change

        self.assertEqual(outcome(lambda own: None), 0)
        # An error may be off by 5 %, what depends on seconds by 30 %.
        self.assertEqual(outcome(scaled("pipeline", "pipeline_equation_5_7", 1.04)), 0)
        self.assertEqual(outcome(scaled("pipeline", "pipeline_equation_5_7", 1.2)), 1)
        self.assertEqual(outcome(scaled("snooker", "snooker_equal_error_hybrid", 1.2)), 0)
        self.assertEqual(outcome(scaled("snooker", "snooker_equal_error_hybrid", 0.6)), 1)
        # Small claims are not lost in what is allowed absolutely; an angle that is rounding may be another.
        for experiment, own in numbers.items():
            for claim in own["claims"]:
                factor = 10 if own["claims"][claim]["value"] < 0.1 else 2
                self.assertEqual(outcome(scaled(experiment, claim, factor)), 1, claim)
        self.assertEqual(outcome(scaled("sampling", "sampling_beyond", 1.04)), 0)
        self.assertEqual(outcome(scaled("motion", "motion_direction", 2)), 0)
        self.assertEqual(outcome(lambda own: own["voxels"]["claims"]["voxels_query"].update(holds=False)), 1)
        self.assertEqual(outcome(lambda own: [e.update(size="tiny") for e in own.values()]), 2)
        # Nothing is written, whatever comes of it.
        before = {file: file.stat().st_mtime_ns for file in (reproduction.NUMBERS, reproduction.DOCUMENT)}
        with tempfile.TemporaryDirectory() as folder:
            run = pathlib.Path(folder) / "results.json"
            run.write_text(json.dumps({"command": "covtrace reproduce", "size": "tiny", "facts": {"program": "covtrace"}, "experiments": {}}))
            with contextlib.redirect_stdout(io.StringIO()):
                self.assertEqual(reproduction.main([str(run)]), 2)
        self.assertEqual(before, {file: file.stat().st_mtime_ns for file in before})

    def test_what_is_missing_in_a_run_is_a_fault(self):
        numbers = json.loads(text_of(reproduction.NUMBERS))
        own = json.loads(text_of(reproduction.NUMBERS))
        del own["lens"]["claims"]["lens_grows"]
        lines, code = reproduction.compare(numbers, own, {})
        self.assertEqual(code, 1)
        self.assertIn("lens_grows: published and MISSING here", lines)
        # An experiment that was not asked for is no fault, one that failed is, with others and alone.
        del own["lens"]
        self.assertEqual(reproduction.compare(numbers, own, {})[1], 0)
        failed = {"claims": {}, "failure": "foliage/scene.pbrt: cannot be read"}
        self.assertEqual(reproduction.compare(numbers, own, {"lens": failed["failure"]})[1], 1)
        with tempfile.TemporaryDirectory() as folder:
            run = pathlib.Path(folder) / "results.json"
            run.write_text(json.dumps({"command": "covtrace reproduce", "size": "quick", "facts": {"program": "covtrace"}, "experiments": {"voxels": failed}}))
            with contextlib.redirect_stdout(io.StringIO()) as said:
                self.assertEqual(reproduction.main([str(run)]), 1)
        self.assertIn("voxels: FAILED: foliage/scene.pbrt: cannot be read", said.getvalue())

    def test_verdicts_on_the_reproduction(self):
        def held(*holds):
            return reproduction_verdicts.held({"claims": {str(i): {"holds": h} for i, h in enumerate(holds)}})

        self.assertEqual([held(), held(None), held(True, None), held(True, False), held(False, None)],
                         ["not judged", "not judged", "reproduced", "in part", "**not**"])

        # Table 5.1 prints 5.8 times: less, but more than 1, is a part of that.
        numbers = json.loads(text_of(reproduction.NUMBERS))
        chosen = numbers["snooker"]["variants"]["budget_matched"]

        def table(ratio):
            chosen["uniform_cpu_same_error"] = ratio and ratio * chosen["cpu"]
            return next(row for row in reproduction_verdicts.rows(numbers) if row[1] == "`table`")

        self.assertEqual([table(ratio)[2] for ratio in (5.9, None, 5.7, 1.1)], ["reproduced", "reproduced", "in part", "in part"])
        self.assertIn("**not**", table(0.9)[2])
        # The number of `hybrid` is that of the run.
        rows = numbers["snooker"]["tables"][0]
        next(row for row in rows["rows"] if row[0] == "hybrid")[rows["columns"].index("ratio of times")] = "4.25 (4.20 to 4.30)"
        self.assertIn("`hybrid`, which has 4.25 there", table(0.9)[4])

    def test_authorities_exist(self):
        """Works are named by author, title, year; no document is cited that readers do not have."""
        faults = []
        for file in documents():
            text = markdown.prose(text_of(file))
            if file.parent.name == "archive":
                continue
            for match in re.finditer(r"\bSPEC\b[ §\d]|\b[Tt]he (?:contract|specification|brief)\b", text):
                faults.append(f"{file.relative_to(ROOT)}: '{match[0]}' is no document of the project")
            if re.search(r"\b[Tt]he thesis\b", text) and "glossary.md#whose" not in text and not re.search(
                    r"A\s+Frequency\s+Analysis\s+of\s+Light\s+Transport", text):
                faults.append(f"{file.relative_to(ROOT)}: which thesis? cite it, or link the glossary's 'Whose'")
        self.report(faults)


if __name__ == "__main__":
    unittest.main()
