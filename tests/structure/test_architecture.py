"""The source keeps to the table of folders in the documents: what may include what, and how large a file may grow."""
import os
import pathlib
import re
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["COVTRACE_SOURCE"])
MOST_LINES, MOST_SOURCES = 400, 30
SUFFIXES = {".cpp", ".h", ".hpp", ".py", ".js", ".mjs"}


def table_of(root):
    """Folder to the folders that its row of the table names."""
    [document] = [d for d in root.rglob("architecture.md") if "docs" in d.relative_to(root).parts]
    rows = re.findall(r"^\| `([\w/]+)` \|.*\|([^|]*)\|$", document.read_text(), re.M)
    return {folder: re.findall(r"`([\w/]+)`", uses) for folder, uses in rows}


def reachable(table):
    """Folder to all that it may include, itself among them. Raises ValueError for circles and unknown folders."""
    found = {}

    def visit(folder, above):
        if folder in above:
            raise ValueError("circle: " + " -> ".join([*above, folder]))
        if folder not in table:
            raise ValueError(f"{above[-1]} may use {folder}, which has no row")
        if folder not in found:
            found[folder] = {folder}.union(*(visit(use, [*above, folder]) for use in table[folder]))
        return found[folder]

    for folder in table:
        visit(folder, [])
    return found


def folder_of(path, table):
    """The row that a path below the root belongs to: the longest one; None outside of all."""
    return next((str(p) for p in [path, *path.parents] if str(p) in table), None)


def included_file(root, source, name):
    """The file below the root that `#include "name"` in `source` names; None for other projects' headers and made
    ones."""
    for base in (source.parent, root / "src", root / "studies", root, root / "covariance/include"):
        if (base / name).is_file():
            return (base / name).resolve().relative_to(root.resolve())
    return None


def wrong_arrows(root):
    """Lines of `file includes file` that the table does not allow."""
    table = table_of(root)
    allowed = reachable(table)
    wrong = []
    for folder in table:
        for source in sorted(f for f in (root / folder).rglob("*") if f.suffix in {".cpp", ".h", ".hpp"}):
            below = source.relative_to(root)
            # Tests, examples and benchmarks of a folder are no part of what others include.
            if folder_of(below, table) != folder or {"tests", "examples", "bench"} & set(below.parts):
                continue
            for name in re.findall(r'^\s*#\s*include "([^"]+)"', source.read_text(), re.M):
                target = included_file(root, source, name)
                if target and folder_of(target, table) not in allowed[folder]:
                    wrong.append(f"{below} includes {target}")
    return wrong


def link_arrows(root):
    """Folder to the folders behind the DEPENDS of its covtrace_library."""
    folders, depends = {}, {}
    for file in sorted(root.rglob("CMakeLists.txt")):
        call = re.search(r"covtrace_library\((\w+)(.*?)\)", file.read_text(), re.S)
        if not call or {"build", "out"} & set(file.relative_to(root).parts[:1]):
            continue
        folder = str(file.parent.relative_to(root))
        folders[call.group(1)] = folder
        names = re.search(r"\bDEPENDS\s+(.*?)(?=PRIVATE_DEPENDS|$)", call.group(2), re.S)
        depends[folder] = names.group(1).split() if names else []
    folders["covtrace::covariance"] = "covariance"
    return {folder: {folders[n] for n in names if n in folders} for folder, names in depends.items()}


class Architecture(unittest.TestCase):
    def test_no_folder_includes_what_the_table_does_not_name(self):
        self.assertEqual([], wrong_arrows(SOURCE))

    def test_every_folder_of_the_source_has_a_row(self):
        folders = [d for parent in ("src", "studies") for d in (SOURCE / parent).iterdir()
                   if any(d.rglob("*.cpp"))]
        self.assertEqual(set(), {str(d.relative_to(SOURCE)) for d in folders} - set(table_of(SOURCE)))

    def test_libraries_link_what_the_table_names(self):
        table = table_of(SOURCE)
        for folder, links in link_arrows(SOURCE).items():
            with self.subTest(folder):
                self.assertEqual(set(table[folder]), links)

    def test_no_folder_has_too_many_sources(self):
        for folder in (SOURCE / "src").iterdir():
            with self.subTest(folder.name):
                self.assertLessEqual(len(list(folder.glob("*.cpp"))), MOST_SOURCES)

    def test_no_file_is_too_long(self):
        long = []
        for folder in [*table_of(SOURCE), "bench", "fuzz", "tests", "scenes", "scripts", "packaging"]:
            for file in (SOURCE / folder).rglob("*"):
                if file.suffix in SUFFIXES and "generated" not in file.parts and "node_modules" not in file.parts:
                    lines = file.read_text(errors="replace").count("\n")
                    if lines > MOST_LINES:
                        long.append(f"{file.relative_to(SOURCE)}: {lines} lines")
        self.assertEqual([], sorted(set(long)))


class TheCheckItself(unittest.TestCase):
    """A new arrow, a circle and a folder without a row are found."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.write("docs/internals/architecture.md", "| `src/low` | a | |\n| `src/high` | b | `src/low` |\n")
        self.write("src/low/low.h", "")
        self.write("src/high/high.cpp", '#include "low/low.h"\n')

    def write(self, name, text):
        (self.root / name).parent.mkdir(parents=True, exist_ok=True)
        (self.root / name).write_text(text)

    def test_allowed_arrows_pass(self):
        self.assertEqual([], wrong_arrows(self.root))

    def test_an_arrow_upwards_is_told(self):
        self.write("src/high/high.h", "")
        self.write("src/low/low.h", '#include "high/high.h"\n')
        self.assertEqual(["src/low/low.h includes src/high/high.h"], wrong_arrows(self.root))

    def test_a_circle_in_the_table_is_told(self):
        self.write("docs/internals/architecture.md", "| `src/low` | a | `src/high` |\n| `src/high` | b | `src/low` |\n")
        with self.assertRaisesRegex(ValueError, "circle: src/low -> src/high -> src/low"):
            wrong_arrows(self.root)

    def test_a_folder_without_a_row_is_told(self):
        self.write("docs/internals/architecture.md", "| `src/high` | b | `src/low` |\n")
        with self.assertRaisesRegex(ValueError, "src/low, which has no row"):
            wrong_arrows(self.root)


if __name__ == "__main__":
    unittest.main()
