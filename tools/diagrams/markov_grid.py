"""A vertex draws cells of two grids: adaptive ones of several levels, and static ones. Many records may want one slot of the
table; the least key wins."""

from draw import Drawing

FLOOR = 150
X = (210, FLOOR)
ROW = 236
SLOT = 44


def draw():
    d = Drawing(620, 372, "Markov grid: a vertex draws cells of several sizes, and one of the records for a slot writes it")
    for left, edge in ((196, 28), (182, 56), (154, 112)):
        d.rectangle(left, FLOOR - edge / 2, edge, edge, role="orange", fill=("orange", 0.08))
    d.rectangle(176, FLOOR - 40, 80, 80, role="blue", dashed=True)
    d.line((24, FLOOR), (400, FLOOR), width=2)
    d.dot(*X)
    d.camera(40, 44, angle=32)
    d.line((40, 44), X, role="faint")
    d.text(216, FLOOR - 8, "x", style="italic")
    d.text(24, 24, "camera", role="faint")
    d.text(290, 60, "adaptive cells: edges of 1, 2, 4, …", role="orange")
    d.text(290, 82, "with probability 1/2, 1/4, 1/8, …", role="orange")
    d.text(290, 112, "static cell", role="blue")

    d.text(24, ROW + 26, "table")
    for i in range(11):
        taken = i in (2, 5, 8)
        role = "blue" if i == 8 else "orange" if taken else "ink"
        d.rectangle(90 + SLOT * i, ROW, SLOT, 40, role=role, fill=(role, 0.16) if taken else None)
    for slot, x in ((2, 160), (5, 230), (8, 256)):
        role = "blue" if slot == 8 else "orange"
        d.arrow((x, 208), (90 + SLOT * slot + 22, ROW - 2), role=role)
    d.arrow((260, 330), (318, ROW + 44), role="faint", dashed=True)
    d.arrow((332, 330), (332, ROW + 44), role="green", width=2.5)
    d.arrow((404, 330), (346, ROW + 44), role="faint", dashed=True)
    d.text(332, 352, "records of this frame: the least key writes the slot", role="green", anchor="middle")
    return d
