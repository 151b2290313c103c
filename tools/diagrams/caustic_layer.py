"""Light paths add to a separate layer; signs of two halves of the paths show its noise. It is filtered apart from the rest, and added."""

from draw import Drawing


def draw():
    d = Drawing(632, 300, "Caustic layer: light paths have a separate layer, which is filtered by the noise of light paths and added to the denoised rest")
    d.line((24, 236), (226, 236), width=2.5)
    d.line((102, 40), (140, 40), role="orange", width=4)
    d.circle(120, 128, 32, role="ink", fill=("blue", 0.08))
    for offset, role in ((-16, "blue"), (-6, "orange"), (6, "blue"), (16, "orange")):
        d.arrow((120 + 0.4 * offset, 42), (120 + offset, 100), (120 + 0.6 * offset, 158), (120 - 0.4 * offset, 233), role=role, width=1.5)
    d.camera(40, 70, angle=60)
    d.line((48, 82), (113, 230), role="faint", dashed=True)
    d.text(150, 45, "lamp", role="orange")
    d.text(160, 134, "glass")
    d.text(24, 260, "light paths of two halves: ", role="ink")
    d.text(24, 282, "sum +", role="blue")
    d.text(84, 282, "and sum −", role="orange")
    d.box(262, 24, 156, 40, "caustic layer", fill=("ink", 0.06))
    d.text(262, 82, "sum of both halves", style="small")
    d.box(262, 102, 156, 40, "noise", fill=("ink", 0.06))
    d.text(262, 160, "(their difference)²", style="small")
    d.box(262, 206, 156, 40, "rest of the image", fill=("ink", 0.06))
    d.arrow((226, 216), (240, 216), (240, 44), (258, 44), width=2)
    d.arrow((240, 122), (258, 122), width=2)
    d.box(458, 58, 150, 48, "à-trous filter", role="orange", fill=("orange", 0.12))
    d.arrow((418, 44), (436, 44), (436, 72), (454, 72), width=2)
    d.arrow((418, 122), (436, 122), (436, 92), (454, 92), width=2)
    d.box(458, 206, 150, 40, "denoiser", role="orange", fill=("orange", 0.12))
    d.arrow((418, 226), (454, 226), width=2)
    d.box(494, 140, 78, 32, "+", role="green", fill=("green", 0.12))
    d.arrow((533, 106), (533, 136), role="green", width=2)
    d.arrow((533, 206), (533, 176), role="green", width=2)
    d.text(580, 162, "image", role="green")
    return d
