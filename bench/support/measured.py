"""CPU time of programs, scenes as the peers read them, and what a JSON file of results says of the machine."""
import json
import math
import os
import pathlib
import platform
import re
import resource
import statistics
import subprocess

import converged

SCENES = ["cornell-box", "living-room", "staircase2", "material-testball", "snooker", "motion"]


def output(command):
    """Runs a program and returns what it prints."""
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def cpu_seconds(command):
    """User and system time of a program and its children; its output is dropped."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    output(command)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def callgrind(out, command, *options):
    """Counts the instructions of a program into the file `out`; what it prints is dropped."""
    done = subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", *options, *map(str, command)],
                          stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace")
    if done.returncode != 0:
        # Valgrind 3.19 knows no VEX move of clang's between registers (66 0F D6), which portable builds do not have.
        hint = ("valgrind does not know an instruction of this build; PRESET=portable ./scripts/build covtrace_program bench, "
                "then set COVTRACE_BUILD=build/portable\n" if "nrecognised instruction" in done.stderr else "")
        raise SystemExit(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{hint or done.stderr}")


def processor():
    found = re.search(r"^model name\s*:\s*(.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.M)
    return found.group(1) if found else platform.processor()


def machine():
    return {"processor": processor(), "cores": os.cpu_count(), "system": platform.platform()}


def commit():
    """The commit of the tree; `+` where it is not clean."""
    done = subprocess.run(["git", "-C", str(converged.ROOT), "describe", "--always", "--dirty=+"],
                          capture_output=True, text=True)
    return done.stdout.strip()


def read_json(path):
    return json.loads(path.read_text())


def write_json(path, name, seed, results):
    """Writes results with machine, commit and seed, on which they depend."""
    path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps({"benchmark": name, "machine": machine(), "commit": commit(), "seed": seed, "results": results},
                      indent=1)
    partial = path.with_suffix(".partial")
    partial.write_text(text + "\n")
    partial.replace(path)


def spread(values):
    """The median, the smallest and the largest of values."""
    return {"median": statistics.median(values), "least": min(values), "most": max(values)}


def geometric_mean(values):
    return math.exp(statistics.fmean(math.log(v) for v in values))


def size(resolution):
    width, height = map(int, resolution.split("x"))
    return width, height


def adapted_scene(path, folder, resolution):
    """A copy of a scene file with the resolution and pbrt's zsobol sampler, beside links to what it names."""
    folder.mkdir(parents=True, exist_ok=True)
    for entry in path.parent.iterdir():
        link = folder / entry.name
        if entry.name != path.name and not link.is_symlink():
            link.symlink_to(entry.resolve())
    width, height = size(resolution)
    text = re.sub(r"#[^\n]*", "", path.read_text())
    for axis, pixels in (("x", width), ("y", height)):
        text = re.sub(rf'("integer {axis}resolution"\s*)(\[\s*\d+\s*\]|\d+)', rf"\g<1>[ {pixels} ]", text)
    text, count = re.subn(r'^\s*Sampler\s+"\w+"', 'Sampler "zsobol"', text, flags=re.M)
    if count == 0:
        text = 'Sampler "zsobol"\n' + text
    copy = folder / path.name
    copy.write_text(text)
    return copy
