"""The page of gpu_check, and the aims of the design. scripts/gpu_bundle copies it beside gpu_check."""

import html
import re

# Aims of the design, in Sponza, on a GPU of the class of an H100. Largest times of a frame and of a pass, milliseconds:
FRAME_AIMS_MS = {("path", "1920x1080"): 16, ("interactive", "1920x1080"): 30, ("bdpt", "1280x720"): 16.7}
PASS_AIMS_MS = {("bmfr", "1920x1080"): ("bmfr", 3)}  # all passes named bmfr-…
# Technique -> passes, and the largest percentage of a frame that they take together.
SHARE_AIMS = {
    "psf": (("cells", "resolve"), 20),
    "apg": (("cells", "resolve"), 20),
    "vlc+cdq": (("lights", "octree", "vlc", "cdq"), 10),
}
# Kind of rays -> least rate, Mrays/s.
RAY_AIMS = {"camera rays": 2000, "shadow rays and first bounces": 1000}


def time_of(row, names):
    """Milliseconds of the passes with these names, and of their parts, which are named NAME-… or NAME.…."""
    return sum(ms for name, ms in row["passes_ms"].items() if re.split("[-.]", name)[0] in names)


def aims(report):
    """The measured values for which the design has an aim."""
    rows = []

    def add(row, what, value, unit, at_most=None, at_least=None):
        met = value <= at_most if at_least is None else value >= at_least
        aim = f"at most {at_most}" if at_least is None else f"at least {at_least}"
        rows.append({"scene": row["scene"], "size": row["size"], "what": what, "value": value, "aim": aim, "unit": unit, "met": met})

    for row in report.get("times", []):
        technique, key = row["technique"], (row["technique"], row["size"])
        if key in FRAME_AIMS_MS:
            add(row, f"frame of {technique}", row["frame_ms"], "ms", at_most=FRAME_AIMS_MS[key])
        if key in PASS_AIMS_MS:
            name, most = PASS_AIMS_MS[key]
            add(row, f"passes of {name}", time_of(row, (name,)), "ms", at_most=most)
        if technique in SHARE_AIMS:
            names, most = SHARE_AIMS[technique]
            share = 100 * time_of(row, names) / row["frame_ms"]
            add(row, f"passes {', '.join(names)} of {technique}", share, "% of the frame", at_most=most)
    for row in report.get("rays", []):
        if row["kind"] in RAY_AIMS and row["mrays_per_s"] is not None:
            add(row, row["kind"], row["mrays_per_s"], "Mrays/s of the pass", at_least=RAY_AIMS[row["kind"]])
    return rows


def verdict(report):
    """The result in a few words."""
    text = "no problem" if report["ok"] else "problems"
    if "bits" not in report:
        return text
    counts = {key: len(names) for key, names in report["bits"].items()}
    return f"{text}, {counts['equal'] + counts['different']} of {sum(counts.values())} cases compared"


def mib(count):
    return f"{count / 2**20:.1f}"


def table(head, rows):
    def line(tag, cells):
        return "<tr>" + "".join(f"<{tag}>{html.escape(str(cell))}</{tag}>" for cell in cells) + "</tr>"

    return f"<table>{line('th', head)}{''.join(line('td', row) for row in rows)}</table>"


STYLE = """:root{color-scheme:light dark}body{font:15px/1.5 sans-serif;max-width:70em;margin:2em auto;padding:0 1em}
table{border-collapse:collapse;margin:1em 0}th,td{border:1px solid #8886;padding:.2em .6em;text-align:left;vertical-align:top}pre{overflow-x:auto}"""


def page(report):
    """The report as one HTML file."""
    place = "the processor" if report["device"] == "cpu" else "a GPU"
    parts = [f"<h1>relume on {place}: {verdict(report)}</h1>"]
    parts.append(f"<p>{html.escape(report['relume'])}, --device {html.escape(report['device'])}, {report['date']}</p>")
    parts.append(table(["step", "seconds", "problems"], [[s["name"], f"{s['seconds']:.1f}", "; ".join(s["problems"]) or "none"] for s in report["steps"]]))
    if "devices" in report:
        found = report["devices"]
        parts.append("<h2>Machine</h2><pre>" + html.escape("\n".join([*found["relume"], found["system"], *found["nvidia-smi"]])) + "</pre>")
    if "start" in report:
        parts.append("<h2>Start</h2><p>First start {first_s:.2f} s, with the driver's compiler; second start {second_s:.2f} s.</p>".format(**report["start"]))
    if "bits" in report:
        bits = report["bits"]
        parts.append("<h2>Bits</h2>" + table(["result", "cases"], [[key.replace("_", " "), len(bits[key])] for key in bits]))
        rows = [[one["name"], f"frame {one['first_frame']} differs", one["equals_processor_here"], one["processor_here_equals_bundle"]] for one in bits["different"]]
        rows += [[one["name"], one["problem"], "", ""] for one in bits["failed"]]
        if rows:
            parts.append(table(["case", "problem", "equals the processor here", "the processor here equals the bundle"], rows))
    times = report.get("times", [])
    if times:
        head = ["scene", "size", "technique", "frames", "ms per frame", "Mrays/s", "slowest passes, ms per frame"]
        rows = [[r["scene"], r["size"], r["technique"], f"{r['frames']:.0f}", f"{r['frame_ms']:.2f}", f"{r['mrays_per_s']:.1f}", ", ".join(f"{n} {ms:.2f}" for n, ms in list(r["passes_ms"].items())[:6])] for r in times]
        parts.append("<h2>Times</h2>" + table(head, rows) + "<h2>Slowest passes</h2>" + table(["pass", "technique", "size", "ms per frame", "share of the frame"], slowest_passes(times)))
        rows = [[r["technique"], r["size"], *(mib(r["memory"][key]) for key in ("scene_bytes", "buffer_bytes", "technique_bytes")), *device_memory(r["memory"]["device"])] for r in times]
        parts.append("<h2>Memory, MiB</h2>" + table(["technique", "size", "scene", "buffers", "techniques", "used on the GPU", "limit"], rows))
    if report.get("rays"):
        rows = [[r["scene"], r["size"], r["kind"], r["rays"], "" if r["mrays_per_s"] is None else f"{r['mrays_per_s']:.1f}"] for r in report["rays"]]
        parts.append("<h2>Rays</h2>" + table(["scene", "size", "kind", "rays", "Mrays/s of the pass"], rows))
    if report["aims"]:
        rows = [[r["what"], r["scene"], r["size"], f"{r['value']:.1f} {r['unit']}", r["aim"], "yes" if r["met"] else "no"] for r in report["aims"]]
        parts.append("<h2>Aims, for Sponza and a GPU like an H100</h2>" + table(["of", "scene", "size", "measured", "aim", "met"], rows))
    return f"<!doctype html><html lang=en><meta charset=utf-8><title>relume on a GPU</title><style>{STYLE}</style>{''.join(parts)}</html>\n"


def slowest_passes(times):
    """The twelve slowest, over all techniques and sizes."""
    rows = [(ms, name, r) for r in times for name, ms in r["passes_ms"].items()]
    rows.sort(key=lambda row: -row[0])
    return [[name, r["technique"], r["size"], f"{ms:.2f}", f"{ms / r['frame_ms']:.0%}"] for ms, name, r in rows[:12]]


def device_memory(device):
    return [mib(device["memory_used_bytes"]), mib(device["memory_limit_bytes"])] if device else ["", ""]
