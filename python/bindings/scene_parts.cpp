// Meshes, lights, cameras and nodes.

#include "names.h"
#include "properties.h"
#include "scene.h"

namespace relume::python {
namespace {

/// An array of shape (n) of all elements.
py::object flat(const py::object& values) { return py::module_::import("numpy").attr("ravel")(values); }

/// Joints and weights of a mesh have the same size; an empty array removes both.
void resize_influences(Mesh& mesh, size_t size, const char* what) {
  if (size != 0 && !mesh.influences.empty() && size != mesh.influences.size()) {
    throw Error(std::string(what) + " has " + std::to_string(size) + " elements, but the mesh has " +
                std::to_string(mesh.influences.size()) + " influences; give as many, or set joints = [] first");
  }
  mesh.influences.resize(size);
}

void define_meshes(py::module_& module) {
  auto target = keyword_class<MorphTarget>(module, "MorphTarget", "Displacements of a mesh's vertices.");
  target.def_readwrite("name", &MorphTarget::name);
  array_property<float>(target, "positions", &MorphTarget::positions, "(n, 3), metres.");
  array_property<float>(target, "normals", &MorphTarget::normals, "(n, 3).");
  array_property<float>(target, "tangents", &MorphTarget::tangents, "(n, 3).");

  auto mesh = keyword_class<Mesh>(module, "Mesh", "Triangles with one material. Arrays are read as read-only copies.");
  mesh.def_readwrite("name", &Mesh::name)
      .def_readwrite("material", &Mesh::material, "Index in Scene.materials; -1: the default material.");
  array_property<float>(mesh, "positions", &Mesh::positions, "(n, 3), metres.");
  array_property<float>(mesh, "normals", &Mesh::normals, "(n, 3), unit length; empty: flat shading.");
  array_property<float>(mesh, "tangents", &Mesh::tangents, "(n, 4): direction and handedness.");
  array_property<float>(mesh, "uv0", &Mesh::uv0, "(n, 2); (0, 0) is the top left of a texture.");
  array_property<float>(mesh, "uv1", &Mesh::uv1, "(n, 2).");
  array_property<float>(mesh, "colors", &Mesh::colors, "(n, 4), linear RGBA; multiplies the base colour.");
  array_property<uint32_t>(mesh, "triangles", &Mesh::triangles, "(m, 3), vertex numbers.");
  mesh.def_readwrite("influences_per_vertex", &Mesh::influences_per_vertex, "0: the mesh is not skinned.");
  mesh.def_property(
      "joints",
      [](const Mesh& m) {
        std::vector<uint32_t> joints;
        for (const JointInfluence& influence : m.influences) joints.push_back(influence.joint);
        return copied_array<uint32_t>(joints);
      },
      [](Mesh& m, const py::object& values) {
        const auto joints = vector_from<uint32_t, uint32_t>(flat(values), "joints");
        resize_influences(m, joints.size(), "joints");
        for (size_t i = 0; i < joints.size(); ++i) m.influences[i].joint = joints[i];
      },
      "(n, influences_per_vertex), index in Skin.joints; read as (n * influences_per_vertex).");
  mesh.def_property(
      "weights",
      [](const Mesh& m) {
        std::vector<float> weights;
        for (const JointInfluence& influence : m.influences) weights.push_back(influence.weight);
        return copied_array<float>(weights);
      },
      [](Mesh& m, const py::object& values) {
        const auto weights = vector_from<float, float>(flat(values), "weights");
        resize_influences(m, weights.size(), "weights");
        for (size_t i = 0; i < weights.size(); ++i) m.influences[i].weight = weights[i];
      },
      "As joints; the weights of a vertex sum to 1.");
  tuple_property(mesh, "morph_targets", &Mesh::morph_targets,
                 "Copies of the MorphTarget objects; assign a sequence to change them.");
  mesh.def("__repr__", [](const Mesh& m) {
    return "<relume.Mesh '" + m.name + "': " + std::to_string(m.positions.size()) + " vertices, " +
           std::to_string(m.triangles.size()) + " triangles>";
  });
  auto skin = keyword_class<Skin>(module, "Skin", "Joints that deform the meshes of a node.");
  skin.def_readwrite("name", &Skin::name);
  tuple_property(skin, "joints", &Skin::joints, "Node numbers.");
  tuple_property(skin, "inverse_bind", &Skin::inverse_bind, "A (4, 4) matrix per joint.");
}

void define_lights(py::module_& module) {
  auto light = keyword_class<PunctualLight>(module, "Light", "A light that shines along its node's -Z axis.");
  choice(light, "type", &PunctualLight::type, kLightTypes, "'point', 'spot' or 'directional'.");
  light.def_readwrite("name", &PunctualLight::name)
      .def_readwrite("intensity", &PunctualLight::intensity, "RGB; point, spot: W/sr; directional: W/m².")
      .def_readwrite("inner_cone_rad", &PunctualLight::inner_cone_rad, "Half-angle of full intensity.")
      .def_readwrite("outer_cone_rad", &PunctualLight::outer_cone_rad, "Half-angle without light outside.")
      .def_readwrite("angular_diameter_rad", &PunctualLight::angular_diameter_rad, "Directional; 0: a delta light.");
  auto sky = keyword_class<SunSky>(module, "SunSky", "Daylight. A radiance of 1 is 1 kcd/m².");
  sky.def_readwrite("sun_elevation_rad", &SunSky::sun_elevation_rad, "Above the horizon.")
      .def_readwrite("sun_azimuth_rad", &SunSky::sun_azimuth_rad, "From +Z towards +X.")
      .def_readwrite("turbidity", &SunSky::turbidity, "1.7 (clear) to 10 (hazy).")
      .def_readwrite("sky_scale", &SunSky::sky_scale, "Factor of the sky's radiance.")
      .def_readwrite("sun_scale", &SunSky::sun_scale, "Factor of the sun's radiance.")
      .def_readwrite("sun_angular_diameter_rad", &SunSky::sun_angular_diameter_rad, "0.00925 as seen from the Earth.")
      .def_readwrite("ground_albedo", &SunSky::ground_albedo, "RGB, in [0, 1].");
  auto environment = keyword_class<Environment>(module, "Environment", "Light from infinity.");
  choice(environment, "kind", &Environment::kind, kEnvironmentKinds,
         "'none', 'constant', 'map', 'sun-sky', 'studio' or 'automatic'.");
  environment.def_readwrite("color", &Environment::color, "'constant': radiance; others: factor.")
      .def_readwrite("rotation_rad", &Environment::rotation_rad, "About +Y, counter-clockwise from above.")
      .def_readwrite("sun_sky", &Environment::sun_sky, "'sun-sky': the daylight.");
  environment.def_property(
      "map",
      [](const Environment& e) {
        py::array_t<float> map({static_cast<py::ssize_t>(e.height), static_cast<py::ssize_t>(e.width), py::ssize_t{3}});
        std::memcpy(map.mutable_data(), e.map.data(), e.map.size() * sizeof(Rgb));
        map.attr("flags").attr("writeable") = false;
        return map;
      },
      [](Environment& e, const InputArray<float>& map) {
        if (map.ndim() != 3 || map.shape(2) != 3)
          throw Error("an environment map has the shape " + shape_text(map) + "; give one of (height, width, 3)");
        e.height = static_cast<int>(map.shape(0));
        e.width = static_cast<int>(map.shape(1));
        e.map.resize(static_cast<size_t>(e.width) * static_cast<size_t>(e.height));
        std::memcpy(static_cast<void*>(e.map.data()), map.data(), e.map.size() * sizeof(Rgb));
        e.kind = EnvironmentKind::map;
      },
      "Equirectangular radiance, (height, width, 3); row 0 is +Y, the centre looks along -Z. Sets the kind to 'map'.");
}

void define_cameras(py::module_& module) {
  auto camera = keyword_class<Camera>(module, "Camera", "Looks along its node's -Z axis, with +Y up.");
  choice(camera, "projection", &Camera::projection, kProjections, "'perspective', 'orthographic' or 'panoramic'.");
  camera.def_readwrite("name", &Camera::name)
      .def_readwrite("fov_y_rad", &Camera::fov_y_rad, "Full vertical angle.")
      .def_readwrite("half_height", &Camera::half_height, "Orthographic, metres.")
      .def_readwrite("aspect_ratio", &Camera::aspect_ratio, "Default width over height of images; 0: any.")
      .def_readwrite("lens_radius", &Camera::lens_radius, "Metres; 0: pinhole.")
      .def_readwrite("focus_distance", &Camera::focus_distance, "Metres.");
  auto pose = keyword_class<CameraPose>(module, "CameraPose", "A camera and its place in the world.");
  pose.def_readwrite("camera", &CameraPose::camera, "Projection and lens.")
      .def_readwrite("to_world", &CameraPose::to_world, "(4, 4) matrix from the camera to the world.");
}

void define_nodes(py::module_& module) {
  auto transform = keyword_class<Transform>(module, "Transform", "From a node to its parent.");
  transform.def_readwrite("translation", &Transform::translation, "Metres.")
      .def_readwrite("rotation", &Transform::rotation, "Unit quaternion (x, y, z, w).")
      .def_readwrite("scale", &Transform::scale, "Factors of (x, y, z).");
  auto node = keyword_class<Node>(module, "Node", "A place in the hierarchy. References are indices; -1: none.");
  node.def_readwrite("name", &Node::name)
      .def_readwrite("parent", &Node::parent, "Index in Scene.nodes.")
      .def_readwrite("transform", &Node::transform, "From the node to its parent.")
      .def_readwrite("matrix", &Node::matrix, "(4, 4) matrix that replaces the transform, or None.")
      .def_readwrite("light", &Node::light, "Index in Scene.lights.")
      .def_readwrite("camera", &Node::camera, "Index in Scene.cameras.")
      .def_readwrite("skin", &Node::skin, "Index in Scene.skins.")
      .def_readwrite("visible", &Node::visible, "Whether the node and its descendants are rendered.");
  tuple_property(node, "meshes", &Node::meshes, "Indices in Scene.meshes.");
  tuple_property(node, "instances", &Node::instances, "A (4, 4) matrix per copy of the meshes; empty: one copy.");
  array_property<float>(node, "morph_weights", &Node::morph_weights, "(n).");
}

}  // namespace

void define_scene_parts(py::module_& module) {
  define_meshes(module);
  define_lights(module);
  define_cameras(module);
  define_nodes(module);
}

void define_animation(py::module_& module) {
  auto channel = keyword_class<AnimationChannel>(module, "AnimationChannel", "Key frames of one property of one node.");
  choice(channel, "property", &AnimationChannel::property, kAnimatedProperties,
         "'translation', 'rotation', 'scale', 'morph-weight' or 'visible'.");
  choice(channel, "interpolation", &AnimationChannel::interpolation, kInterpolations,
         "'step', 'linear' or 'cubic-spline'.");
  channel.def_readwrite("node", &AnimationChannel::node, "Index in Scene.nodes.")
      .def_readwrite("morph_target", &AnimationChannel::morph_target, "'morph-weight': its number.")
      .def_readwrite("clip", &AnimationChannel::clip, "Index in Scene.clips; -1: part of every clip.");
  array_property<float>(channel, "times", &AnimationChannel::times, "(n), seconds, strictly increasing.");
  array_property<float>(channel, "values", &AnimationChannel::values,
                        "(n, 4), one row per key; (3n, 4) for 'cubic-spline': in-tangent, value, out-tangent.");
  auto parameter = keyword_class<ParameterChannel>(module, "ParameterChannel",
                                                   "Key frames of a parameter of a material, light or camera.");
  choice(parameter, "part", &ParameterChannel::part, kAnimatedParts, "'material', 'light' or 'camera'.");
  choice(parameter, "interpolation", &ParameterChannel::interpolation, kInterpolations,
         "'step', 'linear' or 'cubic-spline'.");
  parameter.def_readwrite("index", &ParameterChannel::index, "Index in the scene's list of such parts.")
      .def_readwrite("parameter", &ParameterChannel::parameter, "'roughness', 'intensity', 'fov_y', …")
      .def_readwrite("clip", &ParameterChannel::clip, "Index in Scene.clips; -1: part of every clip.");
  array_property<float>(parameter, "times", &ParameterChannel::times, "(n), seconds, strictly increasing.");
  array_property<float>(parameter, "values", &ParameterChannel::values, "(n, 4), one row per key.");
}

}  // namespace relume::python
