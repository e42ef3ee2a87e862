"""Each comment can be read alone: it names its subject first, and cites what a reader can look up."""
import ast
import collections
import io
import os
import pathlib
import re
import tempfile
import tokenize
import unittest

SOURCE = pathlib.Path(os.environ["COVTRACE_SOURCE"])
CPP, PYTHON = {".h", ".hpp", ".cpp"}, {".py"}
# Directories that hold no source of this project: builds, results, downloads, files made by scripts.
FOREIGN = {".git", ".venv", "build", "out", "node_modules", "generated", "__pycache__"}

# "Of both: ..." and "What it gives" make sense only beside the line above them.
NO_SUBJECT = re.compile(r"(Of|What)\b")
# Nobody can look up "chapter 2.3 of the text" where it is not told which: author, year and section can be found.
NO_SOURCE = re.compile(r"\bSPEC\b|\b[Tt]he (contract|thesis|paper)\b")

# Comments in the first group. Literals are matched, too, so that "//" inside them starts no comment.
CPP_TOKEN = re.compile(r"""
    R"(?P<end>[^()\\\s]*)\(.*?\)(?P=end)"   # raw string
    | "(?:\\.|[^"\\\n])*"
    | (?<![0-9A-Fa-f])'(?:\\.|[^'\\\n])+'   # not the separators of 1'000
    | (?P<comment>//[^\n]*|/\*.*?\*/)""", re.X | re.S)


def cpp_comments(text):
    """(line, column, text without marks, whether the line holds nothing else) of each comment."""
    for match in CPP_TOKEN.finditer(text):
        if not match["comment"]:
            continue
        start = text.rfind("\n", 0, match.start()) + 1
        words = re.sub(r"^(///<|//!<|///|//!|//|/\*+)\s*", "", match["comment"])
        alone = not text[start:match.start()].strip()
        yield text.count("\n", 0, match.start()) + 1, match.start() - start, words, alone


def python_comments(text):
    """Comments of Python as cpp_comments gives them; strings that document a module, class or function are comments,
    too."""
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            alone = not token.line[:token.start[1]].strip()
            yield token.start[0], token.start[1], token.string.lstrip("#! "), alone
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)) and ast.get_docstring(node):
            yield node.body[0].lineno, -1, ast.get_docstring(node), True


def blocks(comments):
    """(line, text) of each run of comments: a wrapped sentence goes on where its column does on the next line."""
    found, last = [], None
    for line, column, words, alone in comments:
        if last == (line - 1, column) and alone:
            found[-1][1] += " " + words
        else:
            found.append([line, words])
        last = (line, column)
    return found


def faults_of(path):
    """`line: comment` of each block in the file that has no subject or cites what nobody can look up."""
    comments = cpp_comments if path.suffix in CPP else python_comments
    return [f"{line}: {words[:70]}" for line, words in blocks(comments(path.read_text(errors="replace")))
            if NO_SUBJECT.match(words) or NO_SOURCE.search(words)]


def faults(root):
    """`file:line: comment` of each such block below the root."""
    found = []
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(f for f in folders if f not in FOREIGN)
        for path in (pathlib.Path(folder, n) for n in sorted(names)):
            if path.suffix in CPP | PYTHON:
                found += [f"{path.relative_to(root)}:{fault}" for fault in faults_of(path)]
    return found


def count_by_folder(found):
    """`folder: number` for each folder of the tree, those of src, studies and tests one by one."""
    def folder(fault):
        parts = fault.split(":")[0].split("/")[:-1]
        return "/".join(parts[:2 if parts[:1] in (["src"], ["studies"], ["tests"]) else 1]) or "."
    return [f"{name}: {n}" for name, n in sorted(collections.Counter(map(folder, found)).items())]


class Comments(unittest.TestCase):
    def test_every_comment_can_be_read_alone(self):
        found = faults(SOURCE)
        if found:
            self.fail("\n" + "\n".join(found + count_by_folder(found)))


class TheCheckItself(unittest.TestCase):
    """Comments of every kind are found, and nothing but comments."""

    def told(self, name, text):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "src/a").mkdir(parents=True)
            (pathlib.Path(folder) / "src/a" / name).write_text(text)
            return [fault.split(": ")[0] for fault in faults(pathlib.Path(folder))]

    def test_comments_without_a_subject_are_told(self):
        self.assertEqual(["src/a/a.h:1"], self.told("a.h", "/// Of both.\nint a;\n"))
        self.assertEqual(["src/a/a.h:2"], self.told("a.h", "int a;\nint b;  ///< What it gives.\n"))
        self.assertEqual(["src/a/a.cpp:1"], self.told("a.cpp", "/* What it gives. */\n"))
        self.assertEqual(["src/a/a.py:1"], self.told("a.py", "# Of both.\n"))
        self.assertEqual(["src/a/a.py:2"], self.told("a.py", 'def f():\n    """What it gives."""\n'))

    def test_sources_that_nobody_can_look_up_are_told(self):
        for words in ("As in SPEC 2.3", "The thesis has it", "part of the contract", "the paper's eq. 3"):
            self.assertEqual(["src/a/a.h:1"], self.told("a.h", f"// The gain.\n// {words}.\n"), words)

    def test_the_second_line_of_a_sentence_may_begin_with_any_word(self):
        self.assertEqual([], self.told("a.h", "/// The mean\n/// Of all.\nint a;  ///< the sum\n        ///< What\n"))
        self.assertEqual([], self.told("a.py", "# The mean\n# What\n"))

    def test_a_comment_under_code_begins_anew(self):
        self.assertEqual(["src/a/a.h:3"], self.told("a.h", "// The mean.\nint a;\n// Of both.\n"))
        self.assertEqual(["src/a/a.h:2"], self.told("a.h", "int a;  // the mean\n// Of both.\n"))

    def test_literals_and_names_are_no_comments(self):
        self.assertEqual([], self.told("a.cpp", 'auto a = "// What"; int b = 1\'000; auto c = R"(// Of)";\n'))
        self.assertEqual([], self.told("a.h", "// Offsets of thesis and specular.\n"))
        self.assertEqual([], self.told("a.py", 'a = "# What"\n'))

    def test_faults_are_counted_by_folder(self):
        self.assertEqual(["cli: 2", "src/light: 1"], count_by_folder(["cli/a.h:1: x", "cli/b.h:2: x", "src/light/a.h:1: x"]))


if __name__ == "__main__":
    unittest.main()
