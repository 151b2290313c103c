"""All leaves of a quadtree over the square of directions are equally likely, so finer leaves mean a higher density. A migration
splits the leaf with the most light and merges the four with the least. The tree takes one bit per node."""

from draw import Drawing

SIZE = 168
TOP = 48
LEAF = SIZE / 4
SAMPLES = ((0.53, 0.3), (0.57, 0.42), (0.62, 0.33), (0.67, 0.45), (0.7, 0.39), (0.55, 0.46), (0.66, 0.28), (0.86, 0.18), (0.2, 0.3), (0.62, 0.8))


def tree(d, x, split):
    """`split`: (column, row, depth) of the squares that are divided below the root."""
    d.rectangle(x + 2 * LEAF, TOP + LEAF, LEAF, LEAF, role="orange", fill=("orange", 0.3))
    d.rectangle(x, TOP + 2 * LEAF, 2 * LEAF, 2 * LEAF, role="faint", fill=("faint", 0.25))
    d.rectangle(x, TOP, SIZE, SIZE, stroke=2)
    for column, row, depth in ((0, 0, 0), *split):
        edge = SIZE / 2**depth
        left, top = x + column * edge, TOP + row * edge
        d.line((left + edge / 2, top), (left + edge / 2, top + edge))
        d.line((left, top + edge / 2), (left + edge, top + edge / 2))


def draw():
    d = Drawing(620, 320, "Compressed directional quadtree: four leaves move to the directions in which samples found most light")
    before, after = 24, 304
    tree(d, before, ((1, 0, 1), (0, 1, 1)))
    tree(d, after, ((1, 0, 1), (2, 1, 2)))
    for u, v in SAMPLES:
        d.dot(before + u * SIZE, TOP + v * SIZE, role="blue", radius=3)
    d.text(before, 32, "samples by direction", role="blue")
    d.text(after, 32, "the next frame")
    d.step(before + SIZE + 12, after - 12, 106, "split most", role="orange")
    d.step(before + SIZE + 12, after - 12, 176, "join least", role="faint")
    d.text(after + SIZE + 14, 106, "each leaf is", role="green")
    d.text(after + SIZE + 14, 126, "equally likely", role="green")
    for x, bits in ((before, ("0110", "0000", "0000")), (after, ("0100", "0010", "0000"))):
        for i, group in enumerate(bits):
            d.text(x + 58 * i + 26, 246, group, anchor="middle", style="code")
    d.text(24, 284, "one bit per node, breadth first: 1 inner, 0 leaf")
    d.text(24, 306, "12 bits: 10 leaves, always", role="faint")
    return d
