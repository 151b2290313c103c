"""Images, metrics, comparisons and experiments."""

import inspect
import json

import numpy as np
import pytest
import relume


def test_metrics_agree_with_their_definitions():
    random = np.random.default_rng(1)
    a = random.random((16, 24, 3), np.float32)
    b = random.random((16, 24, 3), np.float32)
    difference = a.astype(float) - b
    assert relume.metrics.mse(a, b) == pytest.approx((difference**2).mean(), rel=1e-5)
    assert relume.metrics.rel_mse(a, b) == pytest.approx((difference**2 / (b.astype(float) ** 2 + 0.01)).mean(), rel=1e-5)
    assert relume.metrics.mae(a, b) == pytest.approx(abs(difference).mean(), rel=1e-5)
    assert relume.metrics.mape(a, b) == pytest.approx((abs(difference) / (b + 0.01)).mean(), rel=1e-5)
    assert 0 < relume.metrics.flip(a, b) < 1
    assert relume.metrics.flip_map(a, b).mean() == pytest.approx(relume.metrics.flip(a, b), rel=1e-5)
    assert relume.metrics.flip(a, a) == 0
    assert relume.metrics.measure(a, b)["pixels"] == 16 * 24
    with pytest.raises(relume.Error):
        relume.metrics.mse(a, b[:8])
    with pytest.raises(relume.Error, match="height, width, 3"):
        relume.metrics.mse(a[..., 0], b[..., 0])


def test_image_files(tmp_path):
    image = np.random.default_rng(2).random((8, 12, 3), np.float32)
    relume.write_exr(tmp_path / "a.exr", image, {"comment": "random"})
    np.testing.assert_array_equal(relume.read_image(tmp_path / "a.exr"), image)
    channels = relume.read_exr(tmp_path / "a.exr")
    np.testing.assert_array_equal(channels["G"], image[..., 1])
    relume.write_exr(tmp_path / "b.exr", {"depth.Z": image[..., 0]})
    assert list(relume.read_exr(tmp_path / "b.exr")) == ["depth.Z"]
    relume.write_image(tmp_path / "a.png", image)
    np.testing.assert_allclose(relume.read_image(tmp_path / "a.png"), image, atol=5e-3)
    with pytest.raises(relume.Error):
        relume.write_image(tmp_path / "a.tiff", image)
    with pytest.raises(relume.Error, match="height, width"):
        relume.write_exr(tmp_path / "c.exr", {"Z": image})


def test_merging_needs_parts(tmp_path):
    relume.write_exr(tmp_path / "a.exr", np.zeros((4, 4, 3), np.float32))
    with pytest.raises(relume.Error, match="no image that relume rendered"):
        relume.merge([tmp_path / "a.exr"], tmp_path / "out.exr")
    with pytest.raises(relume.Error, match="no part to merge"):
        relume.merge([], tmp_path / "out.exr")
    assert not (tmp_path / "out.exr").exists()


def test_tone_maps():
    image = np.full((2, 2, 3), 0.5, np.float32)
    np.testing.assert_allclose(relume.tone_map(image, "reinhard"), 1 / 3, rtol=1e-5)
    np.testing.assert_allclose(relume.tone_map(image, "none", exposure=-1), 0.25, rtol=1e-5)
    with pytest.raises(relume.Error, match="choose one of none, reinhard"):
        relume.tone_map(image, "filmic")
    assert relume.to_png(image).startswith(b"\x89PNG")


def test_comparisons(tmp_path):
    scene = relume.builtin("cornell")
    scores = relume.compare(scene, {"default": None, "short": {"max_bounces": 0}, "preset": "interactive"}, samples=4, width=24,
                            height=16, repetitions=3, reference_samples=64, reference_folder=tmp_path, threads=2)
    assert [score["name"] for score in scores] == ["default", "short", "preset"]
    assert scores[1]["rel_mse"] > scores[0]["rel_mse"], "it lacks all reflected light"
    assert len(scores[0]["mses"]) == 3
    assert scores.reference.shape == (16, 24, 3)
    assert relume.metrics.mse(scores[0]["image"], scores.reference) == pytest.approx(scores[0]["mses"][0], rel=1e-3)
    scores.save(tmp_path / "page.html")
    assert "<html" in (tmp_path / "page.html").read_text()
    scores.save(tmp_path / "scores.json")
    assert len(json.loads((tmp_path / "scores.json").read_text())["contenders"]) == 3
    assert "short: MSE" in repr(scores)
    again = relume.compare(scene, {"timed": None}, budget="50ms", width=24, height=16, repetitions=1,
                           reference=np.array(scores.reference))
    assert again[0]["time_s"] < 1


def test_comparisons_check_their_arguments(tmp_path):
    scene = relume.builtin("cornell")
    with pytest.raises(relume.Error, match="did you mean 'interactive'"):
        relume.compare(scene, {"a": "interactve"}, reference_folder=tmp_path)
    with pytest.raises(relume.Error, match="did you mean 'max_bounces'"):
        relume.compare(scene, {"a": {"max_bounce": 1}}, reference_folder=tmp_path)
    with pytest.raises(relume.Error, match="'2 parsecs' is not a duration"):
        relume.compare(scene, {"a": None}, budget="2 parsecs", reference_folder=tmp_path)
    with pytest.raises(relume.Error, match="at least one"):
        relume.compare(scene, {}, reference_folder=tmp_path)


def test_scores_become_a_data_frame(tmp_path):
    pytest.importorskip("pandas")
    scores = relume.compare(relume.builtin("cornell"), {"default": None}, samples=2, width=16, height=16, repetitions=1,
                            reference_samples=8, reference_folder=tmp_path)
    frame = scores.to_pandas()
    assert frame.loc[0, "name"] == "default"
    assert "image" not in frame


def test_experiments_run(tmp_path):
    names = relume.experiments()
    assert len(names) > 10
    with pytest.raises(relume.Error, match="no experiment 'mystery'; there are"):
        relume.experiment("mystery", reference_folder=tmp_path)
    report = relume.experiment("guide-cost", quick=True, reference_folder=tmp_path)
    assert report.claims
    assert {claim["verdict"] for claim in report.claims} <= {"holds", "does not hold", "undecided", "not measured"}
    report.save(tmp_path / "page.html")
    assert "<html" in (tmp_path / "page.html").read_text()


def test_parameters_hide_no_settings():
    keywords = {info.keyword for info in relume.settings()} - {"width", "height"}
    for function in (relume.compare, relume.Session.__init__):
        assert not keywords & set(inspect.signature(function).parameters)


def test_settings_of_the_scene_apply_to_comparisons(tmp_path):
    scene = relume.builtin("furnace")
    options = {"samples": 4, "width": 16, "height": 16, "repetitions": 1, "reference_samples": 16, "reference_folder": tmp_path}
    plain = relume.compare(scene, {"a": None}, **options)
    bright = relume.compare(scene, {"a": None}, env="2,2,2", **options)
    assert bright.reference.mean() == pytest.approx(2 * plain.reference.mean(), rel=0.1)
    assert "<table>" in plain._repr_html_()
