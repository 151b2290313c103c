"""Fits the model to measured times with few ranks, and predicts the times with more.

A measurement has ranks on one machine, each with an equal share of a processor. Transfers between them are copies in
memory, so that the seconds per plane of sums contain them.
"""

import dataclasses
import math
import random

from launch import Costs, Job
from simulation import simulate

FITTED_RANKS = (1, 2, 3, 4)
PREDICTED_RANKS = 8
RESAMPLES = 1000
START = "start"  # the job without work, for the time of start and end

# Name -> first guess, and the step of its derivative.
PARAMETERS = {
    "start_s": (1.0, 0.02),  # of one process, up to its end
    "mpi_s": (0.5, 0.02),  # more, with more than one rank
    "rank_s": (0.05, 0.01),  # more, for each rank
    "slowdown": (0.02, 0.005),
    "plane_s": (3e-7, 3e-8),
}


@dataclasses.dataclass
class Cell:
    """Times of a job with a number of ranks, by repetition."""

    job: Job
    ranks: int
    seconds: list

    @property
    def mean(self):
        return sum(self.seconds) / len(self.seconds)


def cells_of(measurement):
    cells = []
    for job in measurement["jobs"]:
        described = Job(job["name"], job["width"] * job["height"], job["samples"])
        by_ranks = {}
        for run in sorted(job["runs"], key=lambda r: r["repetition"]):
            by_ranks.setdefault(run["ranks"], []).append(run["seconds"])
        cells += [Cell(described, ranks, seconds) for ranks, seconds in sorted(by_ranks.items())]
    return cells


def speed_name(job):
    return f"samples_per_s {job.name}"


def predicted(job, ranks, values, interval_s):
    """Seconds of a run. A speed is given as its natural logarithm."""
    v = {name: max(value, 0.0) for name, value in values.items()}
    speed = math.exp(v[speed_name(job)]) if speed_name(job) in v else math.exp(max(v[n] for n in v if n not in PARAMETERS))
    costs = Costs(speed, v["plane_s"], math.inf, 0.0, launch_s=v["start_s"] + (v["mpi_s"] if ranks > 1 else 0),
                  launch_per_rank_s=v["rank_s"], interval_s=interval_s, slowdown=v["slowdown"])
    return simulate(job, ranks, costs).seconds


def solve(matrix, right):
    """Solution of a linear system, by elimination with pivots."""
    n = len(right)
    rows = [[*row, value] for row, value in zip(matrix, right)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda r: abs(rows[r][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        for r in range(i + 1, n):
            factor = rows[r][i] / rows[i][i]
            for c in range(i, n + 1):
                rows[r][c] -= factor * rows[i][c]
    solution = [0.0] * n
    for i in reversed(range(n)):
        solution[i] = (rows[i][n] - sum(rows[i][c] * solution[c] for c in range(i + 1, n))) / rows[i][i]
    return solution


class Fit:
    """Least squares of relative differences, by Levenberg and Marquardt. `values`: the parameters."""

    def __init__(self, measurement):
        self.interval_s = measurement["setup"]["checkpoint_interval_s"]
        self.share = measurement["setup"]["share"]
        self.cells = cells_of(measurement)
        self.fitted = [c for c in self.cells if c.ranks in FITTED_RANKS]
        self.steps = {name: step for name, (_, step) in PARAMETERS.items()}
        self.values = {name: guess for name, (guess, _) in PARAMETERS.items()}
        for cell in self.fitted:
            if cell.ranks == 1 and cell.job.name != START:
                self.steps[speed_name(cell.job)] = 0.005
                self.values[speed_name(cell.job)] = math.log(cell.job.samples * cell.job.pixels / cell.mean)
        self.names = list(self.steps)
        self.minimise()
        self.jacobian = [self.gradient(c, self.values) for c in self.fitted]

    def seconds(self, cell, values):
        return predicted(cell.job, cell.ranks, values, self.interval_s)

    def residuals(self, values):
        return [self.seconds(c, values) / c.mean - 1 for c in self.fitted]

    def gradient(self, cell, values):
        """Derivatives of the relative time. Deals are whole blocks, so a difference over a step is an average."""
        row = []
        for name in self.names:
            up, down = ({**values, name: max(values[name] + sign * self.steps[name], 0.0)} for sign in (1, -1))
            row.append((self.seconds(cell, up) - self.seconds(cell, down)) / (up[name] - down[name]) / cell.mean)
        return row

    def change(self, jacobian, residuals, damping):
        """The step of the parameters that reduces the residuals."""
        n = len(self.names)
        scaled = [[row[i] * self.steps[name] for i, name in enumerate(self.names)] for row in jacobian]
        matrix = [[sum(row[i] * row[j] for row in scaled) for j in range(n)] for i in range(n)]
        largest = max(matrix[i][i] for i in range(n))
        for i in range(n):
            matrix[i][i] += damping * matrix[i][i] + 1e-9 * largest
        right = [-sum(row[i] * r for row, r in zip(scaled, residuals)) for i in range(n)]
        return [d * self.steps[name] for d, name in zip(solve(matrix, right), self.names)]

    def minimise(self):
        damping, residuals = 1e-2, self.residuals(self.values)
        for _ in range(30):
            jacobian = [self.gradient(c, self.values) for c in self.fitted]
            cost = sum(r * r for r in residuals)
            while damping < 1e4:
                change = self.change(jacobian, residuals, damping)
                values = {n: max(self.values[n] + d, 0.0) for n, d in zip(self.names, change)}
                trial = self.residuals(values)
                if sum(r * r for r in trial) < cost:
                    break
                damping *= 4
            else:
                return
            self.values, residuals, damping = values, trial, max(damping / 8, 1e-6)
            if cost - sum(r * r for r in residuals) < 1e-6 * cost:
                return

    def intervals(self):
        """(value, low, high) by name, and (cell, prediction, low, high, error, low, high) of each predicted cell. The
        intervals hold 95 % of resampled repetitions. Parameters follow them linearly."""
        random_numbers = random.Random(1)
        repetitions = min(len(c.seconds) for c in self.cells)
        cells = [c for c in self.cells if c.ranks == PREDICTED_RANKS]
        predictions = [self.seconds(c, self.values) for c in cells]
        gradients = [self.gradient(c, self.values) for c in cells]
        count = len(self.fitted)
        columns = [self.change(self.jacobian, [float(i == k) for i in range(count)], 0.0) for k in range(count)]
        shifts, times, errors = [], [[] for _ in cells], [[] for _ in cells]
        for _ in range(RESAMPLES):
            chosen = [random_numbers.randrange(repetitions) for _ in range(repetitions)]
            moved = [1 - sum(c.seconds[i] for i in chosen) / len(chosen) / c.mean for c in self.fitted]
            shift = [sum(steps) for steps in zip(*([step * m for step in column] for column, m in zip(columns, moved)))]  # linear in `moved`
            shifts.append(shift)
            for k, cell in enumerate(cells):
                time = predictions[k] + cell.mean * sum(g * d for g, d in zip(gradients[k], shift))
                times[k].append(time)
                errors[k].append(time / (sum(cell.seconds[i] for i in chosen) / len(chosen)) - 1)
        parameters = {}
        for i, name in enumerate(self.names):
            low, high = middle([self.values[name] + s[i] for s in shifts])
            parameters[name] = (self.values[name], max(low, 0.0), high)
        return parameters, [(c, p, *middle(t), p / c.mean - 1, *middle(e)) for c, p, t, e in zip(cells, predictions, times, errors)]


def middle(values):
    """Ends of the middle 95 %."""
    ordered = sorted(values)
    return ordered[round(0.025 * (len(ordered) - 1))], ordered[round(0.975 * (len(ordered) - 1))]


def interval_of_mean(values):
    """(mean, low, high) by resampling."""
    random_numbers = random.Random(1)
    means = [sum(random_numbers.choices(values, k=len(values))) / len(values) for _ in range(RESAMPLES)]
    return sum(values) / len(values), *middle(means)
