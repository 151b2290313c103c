"""Drawn cells vote for lights with their weights; a light tree has a fixed share. A hidden light fades in its cell."""

from draw import Drawing

FLOOR = 210
LIGHTS = ((120, 56), (250, 56), (470, 56))
X = (190, FLOOR)


def draw():
    d = Drawing(620, 330, "Light selection from Markov chains: drawn cells vote for lights that contributed nearby, and a light tree has the rest")
    for i, (x, y) in enumerate(LIGHTS):
        d.circle(x, y, 9, fill=("ink", 0.12))
        d.text(x, y - 18, str(i + 1), anchor="middle")
    d.rectangle(352, 76, 14, FLOOR - 76, fill=("ink", 0.15))
    d.line((24, FLOOR), (600, FLOOR), width=2)
    for i, left in enumerate((108, 142, 176, 210, 244)):
        d.rectangle(left - 15, FLOOR - 15, 30, 30, role="orange", fill=("orange", 0.16))
        d.text(left, FLOOR + 6, "11213"[i], role="orange", anchor="middle")
    d.arrow(X, (126, 68), role="green", width=4, head=12)
    d.arrow(X, (246, 68), role="green", width=2)
    d.arrow(X, (350, 140), role="faint", dashed=True)
    d.dot(*X)
    d.text(150, 130, "s₁ + s₂ + s₄", role="green", anchor="end")
    d.text(240, 130, "s₃", role="green")
    d.text(376, 160, "light 3 is hidden:", role="faint")
    d.text(376, 182, "its weight fades", role="faint")
    d.text(24, 262, "five drawn cells, each with a light and its mean contribution", role="orange")
    d.text(24, 288, "1 − γ: these lights, by their weights; γ: the light tree, which reaches every light", role="faint")
    d.text(24, 314, "a visible light replaces others in proportion to its contribution", role="green")
    return d
