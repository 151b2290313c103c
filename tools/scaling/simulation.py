"""A discrete-event model of `mpirun -n N relume render`. The same arguments give the same outcome."""

import random

from launch import Outcome
from sequence import Sequence
from still_image import StillImage


def simulate(job, ranks, costs, seed=1, losses=()):
    """The outcome of a job. `losses`: (seconds since the first start, rank) of ranks that are lost; the same command then
    continues at once with as many ranks."""
    random_numbers = random.Random(seed)
    speeds = [random_numbers.lognormvariate(0, costs.spread) for _ in range(ranks)]
    outcome = Outcome(ranks)
    left = job.frames or job.samples
    kind = Sequence if job.frames else StillImage
    while True:
        begun = outcome.seconds
        launch = kind(job, costs, speeds, outcome, [(t - begun, r) for t, r in losses if t >= begun and r < ranks], left)
        launch.run()
        if launch.complete() and not launch.ranks[0].lost:
            return outcome
        left = launch.left
        outcome.restarts += 1


def random_losses(ranks, days_between, seconds, seed=1):
    """Losses of the first `seconds`, if each rank is lost once in `days_between` days on average."""
    random_numbers = random.Random(seed)
    losses = []
    for rank in range(ranks):
        time = random_numbers.expovariate(1 / (86400 * days_between))
        while time < seconds:
            losses.append((time, rank))
            time += random_numbers.expovariate(1 / (86400 * days_between))
    return sorted(losses)
