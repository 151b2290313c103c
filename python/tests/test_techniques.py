"""The state of techniques, and techniques written in Python."""

import numpy as np
import pytest
import relume


@pytest.fixture(scope="module")
def learning():
    session = relume.Session(relume.builtin("warehouse"), 64, 36, preset=None, lights="vlc", guide="cdq")
    session.render(4)
    return session


def test_records_are_structured_arrays(learning):
    assert {"octree.leaves", "cdq.leaves", "vlc.lights"} <= set(learning.record_tables)
    leaves = learning.records("octree.leaves")
    assert leaves.dtype.names == ("region", "corner", "edge")
    assert leaves["corner"].shape == (len(leaves), 3)
    low = leaves["corner"].min(0)
    high = (leaves["corner"] + leaves["edge"][:, None]).max(0)
    assert (leaves["edge"].astype(float) ** 3).sum() == pytest.approx(float(np.prod(high - low)), rel=1e-4)
    quadtrees = learning.records("cdq.leaves")
    areas = np.bincount(quadtrees["region"], quadtrees["edge"].astype(float) ** 2)
    np.testing.assert_array_equal(areas[areas > 0], 1)
    assert set(np.unique(learning.records("vlc.lights")["region"])) <= set(leaves["region"])
    with pytest.raises(relume.Error) as caught:
        learning.records("cells.cells")
    assert caught.value.code == "not-found"


def test_hooks_read_and_write_buffers():
    scene = relume.builtin("cornell")
    plain = relume.Session(scene, 32, 24, preset=None)
    plain.render(2)
    session = relume.Session(scene, 32, 24, preset=None)
    assert ("trace", "trace") in session.passes
    seen = []

    def halve(s):
        radiance = s.buffer("radiance")
        seen.append(radiance.shape)
        s.write_buffer("radiance", radiance / 2)

    remove = session.after("trace", halve)
    session.render(2)
    assert seen == [(24, 32, 3)] * 2
    np.testing.assert_allclose(session.image, plain.image / 2, rtol=1e-6)
    remove()
    session.render(1)
    assert len(seen) == 2
    with pytest.raises(relume.Error, match="did you mean 'trace'"):
        session.after("trce", halve)
    with pytest.raises(relume.Error, match=r"shape \(24, 32, 3\)"):
        session.write_buffer("radiance", np.zeros((2, 2, 3)))


def test_denoisers_written_in_python_replace_the_image(cornell):
    def blur(session):
        mean = session.buffer("mean")
        padded = np.pad(mean, ((1, 1), (1, 1), (0, 0)), "edge")
        session.replace_image(sum(padded[y : y + 24, x : x + 32] for y in range(3) for x in range(3)) / 9)

    cornell.render(2)
    noisy = np.array(cornell.image)
    cornell.after("present", blur)
    cornell.render(1)
    assert np.abs(np.diff(cornell.image, axis=1)).mean() < 0.5 * np.abs(np.diff(noisy, axis=1)).mean()
    assert cornell.samples == 3


def test_hooks_cannot_change_the_session(cornell):
    changes = [lambda s: s.restart(), lambda s: s.set(seed=3), lambda s: s.set_camera(s.camera), lambda s: s.render(),
               lambda s: s.set_material(0, relume.Material()), lambda s: s.save_checkpoint("none")]
    refused = []

    def change(session):
        for action in changes:
            try:
                action(session)
            except relume.Error:
                refused.append(action)

    cornell.after("trace", change)
    cornell.render()
    assert refused == changes
    assert cornell.settings["seed"] == "0"


def test_hooks_may_remove_themselves(cornell):
    seen = []

    def once(_session):
        seen.append("once")
        remove()

    remove = cornell.after("trace", once)
    cornell.after("trace", lambda _session: seen.append("always"))
    cornell.render(2)
    assert seen == ["once", "always", "always"]
    remove()


def test_hooks_of_a_stage_follow_its_passes():
    session = relume.Session(relume.builtin("cornell"), 16, 16, preset=None, denoise="svgf")
    seen = []
    session.after("denoise", lambda s: seen.append(s.settings["denoise"]))
    session.render()
    session.set(denoise="bmfr")
    session.render()
    assert seen == ["svgf", "bmfr"]


def test_exceptions_of_hooks_reach_the_caller(cornell):
    cornell.render(2)
    before = np.array(cornell.image)

    def fail(_session):
        raise ZeroDivisionError("in the hook")

    remove = cornell.after("trace", fail)
    with pytest.raises(ZeroDivisionError, match="in the hook"):
        cornell.render(1)
    remove()
    np.testing.assert_array_equal(cornell.image, before)
    assert cornell.render(1) == 1


def test_hooks_cannot_render(cornell):
    cornell.after("trace", lambda session: session.render(1))
    with pytest.raises(relume.Error, match="hook"):
        cornell.render(1)
