"""Scenes: built-in ones, files, arrays, animation."""

import copy
import math
import os
import pickle

import numpy as np
import pytest
import relume


def test_builtin_scenes_are_listed_and_built():
    assert "cornell" in relume.builtin_scenes()
    scene = relume.builtin("cornell")
    assert len(scene.meshes) > 3
    assert "triangles" in repr(scene)
    with pytest.raises(relume.Error, match="did you mean 'cornell'") as caught:
        relume.builtin("cornel")
    assert caught.value.code == "not-found"
    assert caught.value.remedy == "did you mean 'cornell'?"


def test_files_keep_the_scene(tmp_path, box):
    assert box.save(tmp_path / "box.glb") == []
    loaded = relume.load(tmp_path / "box.glb")
    assert loaded.source_files
    np.testing.assert_array_equal(loaded.meshes[0].positions, box.meshes[0].positions)
    images = [relume.Session(scene, 24, 16, preset=None) for scene in (box, loaded)]
    for session in images:
        session.render(2)
    np.testing.assert_allclose(images[0].image, images[1].image, rtol=1e-5, atol=1e-6)


def test_files_keep_visible_sets(tmp_path):
    base = relume.builtin("base-1")
    assert len(base.visible_sets) >= 40
    low, high, visible = base.visible_sets[0]
    assert high[0] - low[0] >= 3 and 0 in visible
    base.save(tmp_path / "base.glb")
    assert relume.load(tmp_path / "base.glb").visible_sets == base.visible_sets
    base.visible_sets[0] = (low, high, [1000])
    with pytest.raises(relume.Error, match="visible set 0 refers to the missing set 1000"):
        base.validate()


def test_scenes_are_written_for_pbrt(tmp_path, box):
    box.crop = (0.25, 0, 0.75, 0.5)
    box.save(tmp_path / "box.pbrt")
    box.crop = (0, 0, 1, 1)
    assert relume.load(tmp_path / "box.pbrt").crop == pytest.approx((0.25, 0, 0.75, 0.5), abs=1e-3)
    with pytest.raises(relume.Error, match="written as .gltf, .glb or .pbrt"):
        box.save(tmp_path / "box.xml")
    box.save(tmp_path / "capitals.PBRT")
    assert len(relume.load(tmp_path / "capitals.PBRT").meshes) == len(relume.load(tmp_path / "box.pbrt").meshes)
    assert relume.load(tmp_path / "box.pbrt").meshes


def test_missing_and_malformed_files_are_errors(tmp_path):
    with pytest.raises(relume.Error) as caught:
        relume.load(tmp_path / "none.glb")
    assert "none.glb" in str(caught.value)
    (tmp_path / "bad.glb").write_bytes(b"glTF....")
    with pytest.raises(relume.Error):
        relume.load(tmp_path / "bad.glb")


def test_arrays_have_the_shapes_that_errors_ask_for(box):
    mesh = box.meshes[0]
    assert mesh.positions.shape == (4, 3)
    assert mesh.positions.dtype == np.float32
    assert mesh.triangles.dtype == np.uint32
    with pytest.raises(ValueError):
        mesh.positions[0, 0] = 1  # a read-only copy
    copy = mesh.copy()
    with pytest.raises(relume.Error, match=r"positions has the shape \(4, 2\); give an array of shape \(n, 3\)"):
        copy.positions = np.zeros((4, 2))
    copy.positions = 2 * mesh.positions
    assert box.meshes[0].positions[2, 0] == 1


def test_attributes_are_checked():
    with pytest.raises(TypeError, match="did you mean 'roughness'"):
        relume.Material(roughnes=0.5)
    with pytest.raises(relume.Error, match="alpha_mode cannot be 'msk'; choose one of opaque, mask, blend"):
        relume.Material(alpha_mode="msk")
    material = relume.Material(base_color=np.array([0.5, 0.25, 0.125]), alpha_mode="mask")
    assert material.base_color == (0.5, 0.25, 0.125)
    assert material.alpha_mode == "mask"


def test_parts_are_values(box):
    assert relume.Material() == relume.Material()
    assert relume.Material(roughness=0.5) != relume.Material()
    assert repr(relume.Material(roughness=0.5)) == "relume.Material(roughness=0.5)"
    assert relume.Material.__module__ == "relume"
    for copied in (copy.deepcopy(box), pickle.loads(pickle.dumps(box)), box.copy()):
        assert copied.materials == box.materials
        assert copied.meshes == box.meshes
        assert copied.nodes == box.nodes
        assert copied.environment == box.environment
        copied.materials[0].roughness = 0.1
        assert box.materials[0].roughness == 1
    environment = relume.Environment(map=np.ones((2, 4, 3), np.float32))
    environment.kind = "none"
    assert pickle.loads(pickle.dumps(environment)).kind == "none"
    with pytest.raises(AttributeError):
        box.material = []
    with pytest.raises(ValueError):
        relume.camera_pose((0, 0, 1), (0, 0, 0)).to_world[0, 3] = 9


def test_values_of_the_wrong_type_are_errors(box):
    mesh = box.meshes[0].copy()
    with pytest.raises(relume.Error, match="triangles has elements of type float64; give integers"):
        mesh.triangles = [[0.9, 1.9, 2.9]]
    with pytest.raises(relume.Error, match="triangles has the element -1"):
        mesh.triangles = [[0, 1, -1]]
    with pytest.raises(TypeError, match="Material.base_color cannot be 0.5"):
        relume.Material(base_color=0.5)
    scene = relume.Scene()
    with pytest.raises(relume.Error, match="type int64"):
        scene.add_texture(np.zeros((2, 2, 3), np.int64))
    with pytest.raises(ValueError):
        scene.add_light("point", (0, 0))
    assert not scene.lights
    with pytest.raises(relume.Error, match="give 4 numbers per key"):
        scene.animate(scene.add_node(), "rotation", [0], [[0, 0, 0]])
    with pytest.raises(relume.Error, match="needs a relume.Scene, not 'cornell'"):
        relume.Session("cornell")


def test_joints_and_weights_go_together():
    mesh = relume.Mesh(joints=np.zeros((2, 4), int), weights=np.full((2, 4), 0.25))
    assert len(mesh.joints) == len(mesh.weights) == 8
    with pytest.raises(relume.Error, match="weights has 4 elements, but the mesh has 8 influences"):
        mesh.weights = [1, 1, 1, 1]


def test_texture_formats_fit_their_texels():
    texture = relume.Texture(texels=np.zeros((2, 2, 4), np.float32))
    with pytest.raises(relume.Error, match="rgba32-float"):
        texture.format = "rgba8-srgb"
    pickled = pickle.loads(pickle.dumps(np.zeros((2, 2, 3), np.uint8)))
    data = relume.Texture(format="rgba8-linear", texels=pickled)
    assert data.format == "rgba8-linear"
    assert data.texels.dtype == np.uint8


def test_names_may_have_other_encodings(tmp_path):
    (tmp_path / "a.mtl").write_bytes(b"newmtl glac\xe9\nKd 1 0 0\n")
    (tmp_path / "a.obj").write_bytes(b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl glac\xe9\nf 1 2 3\n")
    assert any(material.name.startswith("glac") for material in relume.load(tmp_path / "a.obj").materials)
    with pytest.raises(relume.Error):
        relume.load(os.fsdecode(b"b\xfc.obj"))


def test_invalid_references_are_errors(box):
    scene = relume.Scene("broken")
    scene.add_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 3]])
    with pytest.raises(relume.Error, match="broken"):
        scene.validate()
    with pytest.raises(relume.Error):
        relume.Session(scene, 16, 16)
    scene.materials.append("red")
    with pytest.raises(relume.Error, match=r"scene.materials\[0\] is of type str; give a Material"):
        scene.validate()


def test_textures_take_bytes_and_floats():
    scene = relume.Scene()
    colours = np.arange(2 * 3 * 3, dtype=np.uint8).reshape(2, 3, 3)
    texture = scene.textures[scene.add_texture(colours)]
    assert texture.format == "rgba8-srgb"
    assert texture.texels.shape == (2, 3, 4)
    np.testing.assert_array_equal(texture.texels[:, :, :3], colours)
    assert (texture.texels[:, :, 3] == 255).all()
    floats = scene.textures[scene.add_texture(np.full((4, 4, 4), 0.5))]
    assert floats.format == "rgba32-float"
    assert (floats.texels == 0.5).all()
    with pytest.raises(relume.Error, match="height, width"):
        scene.add_texture(np.zeros(3))


def test_transforms_and_cameras():
    transform = relume.look_at((0, 0, 5), (5, 0, 5))
    assert transform.translation == (0, 0, 5)
    pose = relume.camera_pose((0, 1, 5), (5, 1, 5), fov_degrees=90)
    np.testing.assert_allclose(pose.to_world @ [0, 0, -1, 0], [1, 0, 0, 0], atol=1e-6)
    np.testing.assert_allclose(pose.to_world[:3, 3], [0, 1, 5], atol=1e-6)
    assert pose.camera.fov_y_rad == pytest.approx(math.pi / 2)


def test_animation_moves_nodes():
    scene = relume.Scene()
    node = scene.add_node(name="lift")
    scene.animate(node, "translation", [0, 2], [[0, 0, 0], [0, 4, 0]])
    assert scene.animation_end_s == 2
    assert scene.world_matrices(1)[node][1, 3] == pytest.approx(2)
    assert scene.find_node("lift") == node
    with pytest.raises(relume.Error, match="no node 'stairs'"):
        scene.find_node("stairs")


def test_environment_maps_are_arrays():
    environment = relume.Environment()
    environment.map = np.ones((8, 16, 3), np.float32)
    assert environment.kind == "map"
    assert environment.map.shape == (8, 16, 3)
    with pytest.raises(relume.Error, match="height, width, 3"):
        environment.map = np.ones((8, 16, 4), np.float32)
