"""Scenes by name, and converged images of them that are made once: what the benchmarks share."""
import json
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("COVTRACE_BUILD", ROOT / "build/release"))
SHARED = pathlib.Path(os.environ.get("COVTRACE_SHARED", ROOT.parent / "shared"))
COVTRACE = BUILD / "covtrace"
PREDICTED_LAYERS = "all,inview,inviewfilter,scatteredcov,scatteredcovweight"  # of predicted_image.h
SEEDS = (1000, 1001)  # of the two halves; measured renders have small seeds


def add_arguments(parser, scenes):
    parser.add_argument("scenes", nargs="*", default=scenes, metavar="SCENE",
                        help="generated scenes, scenes of ../shared, or .pbrt files (default: %(default)s)")
    parser.add_argument("--reference-spp", type=int, default=4096, help="of both halves together (default: %(default)s)")
    parser.add_argument("--resolution", default="320x180")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/quality")


def tool(name):
    """The path of a program of the target `bench`."""
    path = BUILD / "bench" / name
    if not path.exists():
        sys.exit(f"{path} is missing: run ./scripts/build bench")
    return path


class Scene:
    """A scene with a size and the folder for its images."""

    def __init__(self, name, resolution, out):
        self.path = self._find(name)
        self.label = self.path.parent.name if self.path.stem == "scene" else self.path.stem
        self.resolution, self.out = resolution, out
        out.mkdir(parents=True, exist_ok=True)

    @staticmethod
    def _find(name):
        if name.endswith(".pbrt"):
            return pathlib.Path(name)
        shared = SHARED / "scenes" / name / "scene.pbrt"
        if shared.exists():
            return shared
        subprocess.run([sys.executable, str(ROOT / "scenes/generate.py"), name], check=True, stdout=subprocess.DEVNULL)
        return ROOT / "scenes/generated" / name / "scene.pbrt"

    def render(self, tag, *options):
        """Renders to OUT/label-tag.exr; returns the file and the statistics."""
        image = self.out / f"{self.label}-{tag}.exr"
        stats = image.with_suffix(".json")
        subprocess.run([str(COVTRACE), "render", str(self.path), "-o", str(image), "--png", str(image.with_suffix(".png")),
                        "--stats", str(stats), "--progress", "none", "--quiet", "--resolution", self.resolution,
                        *map(str, options)], check=True)
        return image, json.loads(stats.read_text())

    def halves(self, spp):
        """Two converged images by `uniform`, `spp` samples together; kept until the scene changes."""
        files = []
        for seed in SEEDS:
            tag = f"converged-{self.resolution}-{spp // 2}-{seed}"
            image = self.out / f"{self.label}-{tag}.exr"
            if not image.exists() or info(image, "covtrace:sceneHash") != info(self.path, "hash"):
                self.render(tag, "--method", "uniform", "--spp", spp // 2, "--seed", seed, "--layers", "variance,inview")
            files.append(image)
        return files

    def pixels(self, like, every, spp):
        """A pixel of every block of so many squared of the image by converged_pixels; kept until the scene changes."""
        tag = f"pixels-{self.resolution}-{every}-{spp}-{info(self.path, 'hash')}"
        image = self.out / f"{self.label}-{tag}.exr"
        if not image.exists():
            subprocess.run([str(tool("converged_pixels")), "--every", str(every), "--spp", str(spp), str(self.path), str(like), str(image)], check=True)
        return image


def info(path, key, value=r"\w+"):
    """The value that `covtrace info` prints after a key, and that looks like `value`."""
    done = subprocess.run([str(COVTRACE), "info", str(path)], check=True, capture_output=True, text=True)
    found = re.search(rf"{key}\W+({value})", done.stdout)
    return found.group(1).strip('"') if found else None
