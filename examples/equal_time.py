#!/usr/bin/env python3
"""Compares light sampling at equal time. Writes the page equal_time.html and, with matplotlib, equal_time.png."""

import relume

CONTENDERS = {
    "uniform": {"lights": "uniform"},
    "power": {"lights": "power"},
    "light-tree": {"lights": "light-tree"},
    "vlc": {"lights": "vlc"},
}


def plot(scores: relume.Comparison, file: str) -> None:
    try:
        from matplotlib import pyplot
    except ImportError:
        print("matplotlib is not installed; no plot")
        return
    figure, axes = pyplot.subplots(figsize=(6, 3), layout="constrained")
    names = [score["name"] for score in scores]
    axes.bar(names, [score["mse"] for score in scores])
    for position, score in enumerate(scores):
        axes.plot([position] * len(score["mses"]), score["mses"], "k.", markersize=3)
    axes.set_yscale("log")
    axes.set_ylabel("MSE at equal time")
    figure.savefig(file, dpi=150)


def main() -> None:
    scores = relume.compare(relume.builtin("warehouse"), CONTENDERS, budget="300ms", width=160, height=90, repetitions=5,
                            reference_samples=256, progress=True)
    print(scores)
    scores.save("equal_time.html")
    plot(scores, "equal_time.png")


if __name__ == "__main__":
    main()
