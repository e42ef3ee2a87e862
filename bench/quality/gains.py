"""Gains: ratios of errors, their bounds over seeds and their means over scenes."""
import math
import statistics
import typing


def mean(values):
    return sum(values) / len(values)


def means(lists):
    """The means of several lists item by item; not a number where one of the items is null."""
    return [mean([math.nan if v is None else v for v in item]) for item in zip(*lists)]


def by_brightness(ratios):
    """The ratios of the ten groups as text, and the one that is furthest off."""
    off = {k + 1: 100 * (ratio - 1) for k, ratio in enumerate(ratios) if math.isfinite(ratio)}
    worst = max(off, key=lambda k: abs(off[k]), default=None)
    text = " ".join(f"{ratio:.3f}" for ratio in ratios)
    return text if worst is None else f"{text}  worst {off[worst]:+.1f} % (decile {worst})"


class Gain(typing.NamedTuple):
    """How many times larger one column's measure is than another's."""
    name: str
    measure: str
    worse: str
    better: str

    def log(self, row):
        """The logarithm of the gain of a row; not a number where an error is not one, or is below the reference's noise."""
        worse, better = (row["measures"][c][self.measure] for c in (self.worse, self.better))
        return math.log(worse / better) if worse > 0 and better > 0 else math.nan

    def text(self, rows):
        logs = [self.log(row) for row in rows]
        if not math.isnan(mean(logs)):
            return bounds(logs)
        is_left_out = any(math.isnan(row["measures"][self.worse][self.measure]) for row in rows)
        return "(left out)" if is_left_out else "(below the reference's noise)"


def gains_among(columns, has_flip):
    """The gains that can be told from the columns, in the order in which they are printed."""
    ours = "hybrid" if "hybrid" in columns else "covariance"
    pairs = [("over oidn", "oidn"), ("over oidn, same time", "oidntime"), ("equal counts", "uniform"), ("equal time", "time")]
    if ours == "hybrid":
        pairs += [("planner", "even"), ("nfor", "nfor"), ("denoiser", "none")]
    else:
        pairs += [("over smoothed", "smoothed")]
    gains = [Gain(name, "relmse_trimmed", worse, ours) for name, worse in pairs]
    if has_flip:
        gains += [Gain(f"FLIP {name}", "flip", worse, ours) for name, worse in pairs[:2]]
    return [g for g in gains if {g.worse, g.better} <= set(columns)]


def over_scenes(gain, rows_of):
    """The geometric mean over the scenes, and the least. `rows_of`: rows of the same seeds by scene."""
    logs = {scene: [gain.log(row) for row in rows] for scene, rows in rows_of.items()}
    told = {scene: g for scene, g in logs.items() if not math.isnan(mean(g))}
    if not told:
        return "of no scene"
    least = min(told, key=lambda scene: mean(told[scene]))
    return (f"{bounds([mean(of_seed) for of_seed in zip(*told.values())])}, the least {math.exp(mean(told[least])):.2f} ({least})"
            + (f"; of {len(told)} of {len(logs)} scenes" if len(told) < len(logs) else ""))


def bounds(logs):
    """The geometric mean of gains, given as logarithms, and its 95 % bounds by Student's t."""
    middle = mean(logs)
    if len(logs) < 2:
        return f"{math.exp(middle):.2f}"
    t = {2: 12.71, 3: 4.30, 4: 3.18, 5: 2.78, 6: 2.57, 7: 2.45, 8: 2.36}.get(len(logs), 2.0)
    half = t * statistics.stdev(logs) / math.sqrt(len(logs))
    return f"{math.exp(middle):.2f} [{math.exp(middle - half):.2f}, {math.exp(middle + half):.2f}]"
