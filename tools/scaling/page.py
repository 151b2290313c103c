"""docs/scaling.md and its plot."""

import dataclasses
import math
import pathlib
import sys
import textwrap

from dealers import BLOCK_SAMPLES
from fit import FITTED_RANKS, PREDICTED_RANKS, START, Fit, interval_of_mean
from launch import Costs, Job
from simulation import simulate

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "diagrams"))
from draw import Drawing  # noqa: E402

RANKS = (1, 8, 64, 512)
PLOTTED = tuple(2**i for i in range(10))
SENSITIVE_RANKS = 64
HARMLESS = 0.05

JOBS = (
    Job("1080p, 256 samples", 1920 * 1080, 256),
    Job("8K, 1,024 samples", 7680 * 4320, 1024),
    Job("1,000 frames", 1920 * 1080, 64, frames=1000),
    Job("1,000 frames, warm-up", 1920 * 1080, 64, frames=1000, warmup=8),
)
ASSUMED = Costs(samples_per_s=7.4e6, plane_s=7.5e-8, bandwidth=1.25e9, latency_s=5e-5, cores=16, merge_cores=4, launch_s=1.0,
                launch_per_rank_s=5e-3, load_s=2.0, checkpoint_s=1.5e-7, write_s=1e-7, spread=0.05)  # fmt: skip

# Field of Costs -> what it is, its unit and scale, its source, and its twice as bad value.
COSTS = {
    "samples_per_s": ("speed of a rank", "million samples per second", 1e-6, "assumed: 16 times a core of [Sponza](performance.md#compared-with-cycles)", 0.5),
    "cores": ("processors of a rank", "", 1, "assumed", None),
    "plane_s": ("preparing a result, or adding it to the sums, on one core", "ns per pixel", 1e9, "assumed: 600 bytes of memory traffic", 2),
    "merge_cores": ("cores that adding uses, limited by memory", "", 1, "assumed", None),
    "bandwidth": ("network into rank 0", "GB/s", 1e-9, "assumed: 10 Gbit/s", 0.5),
    "latency_s": ("latency of a message", "µs", 1e6, "assumed", 2),
    "launch_s": ("start of `mpirun`", "s", 1, "assumed", 2),
    "launch_per_rank_s": ("the same, for each rank", "ms", 1e3, "assumed", 2),
    "load_s": ("loading the scene", "s", 1, "assumed", 2),
    "checkpoint_s": ("writing a checkpoint", "ns per pixel", 1e9, "assumed", 2),
    "write_s": ("writing an image", "ns per pixel", 1e9, "assumed", 2),
    "interval_s": ("interval between checkpoints", "s", 1, "default", 0.5),
    "spread": ("standard deviation of the logarithm of ranks' speeds", "", 1, "assumed", 2),
}

INTRO = """\
# Scaling over ranks

How long `mpirun -n N relume render` takes on 1 to 512 ranks, by a model of its [ranks](farm.md).
`tools/scaling_model` writes this page. The parameters of the test machine are fitted to
[measurements](#measurement) with 1 to 4 ranks, and checked with 8. For larger machines, only the
cost of a result comes from the fit; the other values are assumed or defaults. **No time beyond 8
ranks is measured.**

## Model

Discrete events follow `apps/relume/ranks`:

| part | model |
|---|---|
| dealing | rank 0 deals blocks of 4 samples on demand, by the rules of `sample_dealer.cpp`; frames by those of `frame_dealer.cpp` |
| results | 80 bytes per pixel for each deal, 12 for a frame. Rank 0 grants transfers in turn, up to twice the size of its sums, or 256 MiB if that is more |
| network | granted transfers share the link of rank 0 equally |
| reducing | rank 0 alone adds all results, one after another, and deals after each |
| waiting | a rank renders its next deal while one result waits |
| rank 0 | renders as well, slowed by what its other threads do |
| checkpoints | copies of the sums that a thread of rank 0 writes while ranks continue |
| end | rank 0 writes the last checkpoint and the image, while others wait |
| frames | rank 0 writes all images, in order |
| lost ranks | noticed after 20 s without a heartbeat, that of rank 0 after 30 s; the same command then continues at once |

Not modelled: heartbeats and progress messages, which are small; layers, which need 144 bytes per
pixel; the time that a queue takes to start a job again; the reads of scenes from one file server.
"""

MEASURING = """
## Measurement

    tools/measure_ranks --relume build/release/bin/relume
    tools/scaling_model

The first command takes about eleven minutes on an idle machine with two cores, as root. It gives
each rank an equal share of a core by the kernel's quota, so that two cores carry eight ranks.
Repetitions alternate. Three jobs separate the parameters: `start` has next to no work, `render`
has expensive samples of few pixels, and `planes` has cheap samples of many pixels.
"""

NONE = """
No measurement is stored yet. **All times on this page follow from assumed parameters.**
"""


def number(value, digits=3):
    """Three significant digits, with thousands separated."""
    if value == 0:
        return "0"
    rounded = float(f"{value:.{digits}g}")
    if abs(rounded) >= 100:
        return f"{rounded:,.0f}"
    decimals = max(digits - 1 - math.floor(math.log10(abs(rounded))), 0)
    return f"{rounded:.{decimals}f}"


def interval(value, low, high, scale=1.0):
    return f"{number(scale * value)} ({number(scale * low)} to {number(scale * high)})"


def percent(value):
    return f"{100 * value:.0f} %"


def paragraph(text):
    return "\n".join(textwrap.wrap(text, 100, break_long_words=False, break_on_hyphens=False)) + "\n"


def table(heads, rows):
    return f"| {' | '.join(heads)} |\n|{'---|' * len(heads)}\n" + "".join(f"| {' | '.join(map(str, row))} |\n" for row in rows)


def fitted_costs(fit):
    """The assumed parameters, with those that the measurement replaces."""
    return dataclasses.replace(ASSUMED, plane_s=fit.values["plane_s"] * fit.share) if fit else ASSUMED


def conditions(measurement):
    setup = measurement["setup"]
    machine = "; ".join(f"{name}: {value}" for name, value in measurement["machine"].items())
    return "\n" + paragraph(f"The stored run: {setup['share']:g} cores per rank, {setup['repetitions']} repetitions. {machine}.")


def measured(measurement, fit):
    parameters, predictions = fit.intervals()
    text = conditions(measurement) + "\n"
    text += paragraph(f"The parameters are fitted by least squares to {FITTED_RANKS[0]} to {FITTED_RANKS[-1]} ranks, each with its share of a core. Brackets are 95 % bootstrap intervals over repetitions.")
    text += "\n"
    labels = {"start_s": ("start and end of one process, s", 1), "mpi_s": ("additional start and end with MPI, s", 1), "rank_s": ("additional time per rank, s", 1),
              "slowdown": ("slowdown by each further rank on the machine, %", 100), "plane_s": ("a result: preparing or adding it, ns per pixel", 1e9)}  # fmt: skip
    rows = []
    for name, values in parameters.items():
        if name in labels:
            rows.append((labels[name][0], interval(*values, labels[name][1])))
        else:
            rows.append((f"speed of a rank, `{name.split()[1]}`, million samples per second", interval(*map(math.exp, values), 1e-6)))
    text += table(("parameter", "fitted"), rows)
    text += "\nMean measured times with intervals, and times by the model:\n\n"
    rows = []
    for cell in fit.fitted:
        model = fit.seconds(cell, fit.values)
        rows.append((f"`{cell.job.name}`", cell.ranks, interval(*interval_of_mean(cell.seconds)), number(model), f"{100 * (model / cell.mean - 1):+.1f}"))
    text += table(("job", "ranks", "measured, s", "model, s", "error, %"), rows)
    text += f"\n### Prediction for {PREDICTED_RANKS} ranks\n\n"
    text += paragraph("These measurements are not part of the fit. The interval of the error includes the uncertainty of the prediction and of the measurement.") + "\n"
    rows = [(f"`{cell.job.name}`", interval(time, low, high), interval(*interval_of_mean(cell.seconds)), f"{100 * error:+.1f} ({100 * error_low:+.1f} to {100 * error_high:+.1f})")
            for cell, time, low, high, error, error_low, error_high in predictions]  # fmt: skip
    text += table(("job", "predicted, s", "measured, s", "error, %"), rows)
    return text + ratios(measurement)


def ratios(measurement):
    """Of whole jobs, which depend less on the machine than seconds."""
    text = "\nSpeed-up over one rank, by the means of the runs:\n\n"
    counts = [*FITTED_RANKS, PREDICTED_RANKS]
    rows = []
    for job in measurement["jobs"]:
        if job["name"] != START:
            speed_ups = {r["ranks"]: r for r in job["ratios"]}
            rows.append((f"`{job['name']}`", *(number(speed_ups[n]["speed_up"]) for n in counts)))
    return text + table(("job", *(f"{n} rank{'s' if n > 1 else ''}" for n in counts)), rows)


def parameters_table(costs, fit):
    fitted = f"fitted: {number(1e9 * fit.values['plane_s'])} ns with {fit.share:g} cores, times {fit.share:g}" if fit else ""
    rows = []
    for field, (label, unit, scale, source, _) in COSTS.items():
        value = f"{getattr(costs, field) * scale:.3g} {unit}".strip()
        rows.append((label, value, fitted if fit and field == "plane_s" else source))
    return table(("parameter", "value", "source"), rows)


def limit(job, outcome):
    """The largest share of the ranks' time that is no render of the result."""
    by_network = outcome.network >= outcome.coordinator
    names = {
        "start": "start",
        "again": "warm-up" if job.warmup else "samples without a result",
        "copy": "preparing results",
        "answer": "network of rank 0" if by_network else ("rank 0 writes images" if job.frames else "rank 0 adds results"),
        "none": "fewer segments than ranks" if job.frames else "fewer blocks than ranks",
        "end": "rank 0 writes the end",
    }
    state = max(names, key=lambda s: outcome.accounts[s])
    return names[state] if outcome.share(state) > HARMLESS else "render"


def row_of(job, outcome, one_s):
    busiest = max(outcome.network, outcome.coordinator) / outcome.seconds
    return (outcome.ranks, number(outcome.seconds), percent(one_s / (outcome.ranks * outcome.seconds)), percent(outcome.idle), percent(busiest),
            number(outcome.memory / 2**30, 2), limit(job, outcome))  # fmt: skip


HEADS = ("ranks", "time, s", "efficiency", "idle ranks", "load of rank 0", "its memory, GiB", "limit")


def beyond(costs):
    text = """
## One to 512 ranks, by the model

| column | meaning |
|---|---|
| efficiency | time of one rank over ranks × time |
| idle ranks | mean share of ranks that neither render nor prepare a result |
| load of rank 0 | share of the time in which its network, or its thread that adds and writes, is busy: the larger |
| its memory | largest size of sums and results at rank 0, without the scene, with the results that are granted |
| limit | largest part of the ranks' other time, if it exceeds 5 % |
"""
    for job in JOBS:
        text += f"\n### {job.name}\n\n"
        outcomes = [simulate(job, ranks, costs) for ranks in RANKS]
        text += table(HEADS, [row_of(job, o, outcomes[0].seconds) for o in outcomes])
        if not job.frames:
            text += "\n" + paragraph(f"The image has {job.samples // BLOCK_SAMPLES} blocks of {BLOCK_SAMPLES} samples, so at most as many ranks can render at a time. Rank 0 holds its sums, the "
                                     "results of other ranks up to its limit, and up to two of its own.")  # fmt: skip
        elif job.warmup:
            text += "\n" + paragraph("Techniques that use earlier frames render eight frames before each segment. Segments become shorter with more ranks, so that the "
                                     "images that wait at rank 0 take at most about 2 GiB, or two images per rank if that is more.")  # fmt: skip
    return text


def worse(costs, field):
    return dataclasses.replace(costs, **{field: getattr(costs, field) * COSTS[field][4]})


def sensitivity(costs):
    text = f"\n## Parameters that matter\n\nMore time with {SENSITIVE_RANKS} ranks if one parameter is twice as bad, in percent, by the model:\n\n"
    base = [simulate(job, SENSITIVE_RANKS, costs).seconds for job in JOBS]
    rows = []
    for field, (label, *_, factor) in COSTS.items():
        if factor:
            changed = worse(costs, field)
            ratios_to_base = [simulate(job, SENSITIVE_RANKS, changed).seconds / b for job, b in zip(JOBS, base)]
            rows.append((label, *(f"{round(100 * (r - 1)):+d}" for r in ratios_to_base)))
    return text + table(("twice as bad", *(job.name for job in JOBS)), rows)


def lost_ranks(costs):
    text = "\n## Lost ranks\n\n"
    text += paragraph(f"Time with {SENSITIVE_RANKS} ranks, by the model, if a rank is lost after half of it. The job then starts again, so all ranks lose their deals in progress.") + "\n"
    rows = []
    for job in JOBS:
        whole = simulate(job, SENSITIVE_RANKS, costs).seconds
        lost = [simulate(job, SENSITIVE_RANKS, costs, losses=[(whole / 2, rank)]).seconds for rank in (1, 0)]
        rows.append((job.name, number(whole), *(f"{number(t)} (+{number(t - whole)})" for t in lost)))
    return text + table(("job", "no loss, s", "another rank, s", "rank 0, s"), rows)


def plot(costs):
    width, height, left, bottom, right = 640, 360, 56, 316, 460
    d = Drawing(width, height, "Speed-up by the number of ranks, by the model")
    span = math.log(PLOTTED[-1])

    def at(ranks, speed_up):
        return left + math.log(ranks) / span * (right - left), bottom - math.log(speed_up) / span * (bottom - 24)

    for value in (1, 8, 64, 512):
        d.line(at(value, 1), at(value, 512), role="faint", width=0.5)
        d.line(at(1, value), at(512, value), role="faint", width=0.5)
        d.text(at(value, 1)[0], bottom + 18, str(value), role="faint", anchor="middle", style="small")
        d.text(left - 8, at(1, value)[1] + 5, str(value), role="faint", anchor="end", style="small")
    d.text((left + right) / 2, bottom + 38, "ranks", role="faint", anchor="middle", style="small")
    d.text(left, 12, "speed-up over one rank", role="faint", style="small")
    d.line(at(1, 1), at(512, 512), role="faint", dashed=True)
    lines = []
    for job, role, dashed in zip(JOBS, ("blue", "green", "orange", "orange"), (False, False, False, True)):
        seconds = [simulate(job, ranks, costs).seconds for ranks in PLOTTED]
        points = [at(n, max(seconds[0] / s, 1)) for n, s in zip(PLOTTED, seconds)]
        d.line(*points, role=role, width=2, dashed=dashed)
        lines.append((points[-1][1], job.name, role))
    last = -math.inf
    for y, name, role in sorted(lines):
        last = max(y + 5, last + 18)
        d.text(right + 8, last, name, role=role, style="small")
    return d.svg()


def page(measurement):
    """(text of the page, its plot)."""
    fit = Fit(measurement) if measurement else None
    costs = fitted_costs(fit)
    text = INTRO + MEASURING + (measured(measurement, fit) if fit else NONE)
    text += "\n## Parameters of the model\n\nOf machines with 16 cores and one rank each:\n\n" + parameters_table(costs, fit)
    text += beyond(costs) + "\n![Speed-up by the number of ranks](images/scaling.svg)\n" + sensitivity(costs) + lost_ranks(costs)
    text += "\nOther machines and jobs: `tools/scaling_model --job 8K --ranks 16,32 --set bandwidth=12.5e9`.\n"
    return text, plot(costs)
