"""Shell completion and the manual page know every option of the parser."""

import os
import pathlib
import pty
import re
import select
import shutil
import subprocess
import time
import unittest

from support import DONE, USAGE, CliTest

COMMANDS = ["render", "merge", "measure", "compare", "inspect", "info", "reproduce", "completion"]
MANUAL = pathlib.Path(os.environ.get("COVTRACE_SOURCE", pathlib.Path(__file__).parents[2])) / "docs/covtrace.1.in"


class Completion(CliTest):
    def script(self, shell):
        result = self.run_program("completion", shell)
        self.assertEqual((result.code, result.stderr), (DONE, ""), result)
        return result.stdout

    def options(self, command):
        return set(re.findall(r"(?<=[ ,])--[a-z][a-z-]*", self.run_program(command, "--help").stdout))

    def complete(self, *words):
        """The words that bash offers for the last word."""
        quoted = " ".join(f"'{w}'" for w in words)
        command = f"source completion.bash; COMP_WORDS=({quoted}); COMP_CWORD={len(words) - 1}; _covtrace 2>/dev/null; printf '%s\\n' \"${{COMPREPLY[@]}}\""
        self.write("completion.bash", self.script("bash"))
        return subprocess.run(["bash", "-c", command], cwd=self.folder, capture_output=True, text=True, check=True).stdout.split()

    def test_bash(self):
        self.assertLessEqual(set(COMMANDS), set(self.complete("covtrace", "")))
        self.assertEqual(self.complete("covtrace", "rend"), ["render"])
        for command in COMMANDS:
            self.assertLessEqual(self.options(command), set(self.complete("covtrace", command, "-")))
        self.assertEqual(self.complete("covtrace", "render", "--layer-n"), ["--layer-names"])
        self.assertLessEqual({"uniform", "covariance"}, set(self.complete("covtrace", "render", "--method", "")))
        self.assertEqual(self.complete("covtrace", "render", "--progress", "per"), ["percent"])
        self.assertEqual(self.complete("covtrace", "render", "-o", ""), [])  # bash itself offers files

    @unittest.skipUnless(shutil.which("fish"), "fish is not installed")
    def test_fish(self):
        self.write("completion.fish", self.script("fish"))

        def complete(line):
            script = f"source completion.fish; complete -C'{line}'"
            text = subprocess.run(["fish", "--no-config", "-c", script], cwd=self.folder, capture_output=True, text=True, check=True).stdout
            return {l.split("\t")[0] for l in text.splitlines()}

        self.assertLessEqual(set(COMMANDS), complete("covtrace "))
        self.assertLessEqual({"uniform", "covariance"}, complete("covtrace render --method "))
        self.assertLessEqual(self.options("inspect"), complete("covtrace inspect --"))

    @unittest.skipUnless(shutil.which("zsh"), "zsh is not installed")
    def test_zsh(self):
        path = self.write("_covtrace", self.script("zsh"))
        subprocess.run(["zsh", "-n", path], check=True)
        # A terminal is made, as zsh completes at a terminal only.
        leader, follower = pty.openpty()
        shell = subprocess.Popen(["zsh", "-f", "-i"], cwd=self.folder, stdin=follower, stdout=follower, stderr=follower,
                                 env=dict(os.environ, TERM="dumb", PS1="> ", HOME=self.folder), start_new_session=True)
        os.close(follower)
        self.addCleanup(os.close, leader)
        self.addCleanup(shell.wait)
        self.addCleanup(shell.kill)

        def wait_for(text):
            seen, end = "", time.monotonic() + 30
            while text not in seen and time.monotonic() < end:
                if select.select([leader], [], [], 1)[0]:
                    seen += os.read(leader, 4096).decode(errors="replace")
            self.assertIn(text, seen)

        os.write(leader, b"fpath=($PWD $fpath); autoload -Uz compinit; compinit -u -D; covtrace() print -r \"<$*>\"; covtrace\n")
        wait_for("<>")
        for typed, completed in (("rend", "render"), ("render --layer-n", "render --layer-names"),
                                 ("render --progress per", "render --progress percent"), ("render --method unif", "render --method uniform")):
            os.write(leader, b"covtrace " + typed.encode() + b"\t\n")
            wait_for(f"<{completed}>")

    def test_unknown_shell(self):
        self.assert_fails(self.run_program("completion", "tcsh"), USAGE, "tcsh")


class Manual(CliTest):
    def test_every_command_and_option_is_in_the_manual(self):
        text = MANUAL.read_text().replace("\\-", "-")
        for command in COMMANDS:
            self.assertIn(f"covtrace {command}", text)
            for option in set(re.findall(r"(?<=[ ,])--[a-z][a-z-]*", self.run_program(command, "--help").stdout)) - {"--help"}:
                self.assertIn(option, text, f"{command} {option}")


if __name__ == "__main__":
    unittest.main()
