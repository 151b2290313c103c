// Textures and materials.
#include "names.h"
#include "properties.h"
#include "scene.h"

namespace relume::python {
namespace {

size_t texel_bytes(PixelFormat format) { return format == PixelFormat::rgba32_float ? 16 : 4; }

/// Texels as an array of shape (height, width, 4).
py::array texels_of(const Texture& texture) {
  const std::vector<py::ssize_t> shape{texture.height, texture.width, 4};
  const bool is_float = texture.format == PixelFormat::rgba32_float;
  py::array array = is_float ? py::array(py::array_t<float>(shape)) : py::array(py::array_t<uint8_t>(shape));
  if (static_cast<size_t>(array.nbytes()) != texture.texels.size())
    throw Error("texture '" + texture.name + "' has texels of another format than its own; set its texels again");
  std::memcpy(array.mutable_data(), texture.texels.data(), texture.texels.size());
  array.attr("flags").attr("writeable") = false;
  return array;
}

/// Adds alpha 1 to RGB texels and copies them.
template <typename Scalar>
void copy_texels(Texture& texture, const InputArray<Scalar>& array, Scalar opaque) {
  const bool fits = array && array.ndim() == 3 && (array.shape(2) == 3 || array.shape(2) == 4) && array.size() > 0;
  if (!fits) throw Error("texels must be an array of shape (height, width, 3) or (height, width, 4)");
  texture.height = static_cast<int>(array.shape(0));
  texture.width = static_cast<int>(array.shape(1));
  const auto pixels = static_cast<size_t>(array.shape(0) * array.shape(1));
  const auto channels = static_cast<size_t>(array.shape(2));
  texture.texels.resize(pixels * texel_bytes(texture.format));
  texture.file = nullptr;
  auto* target = reinterpret_cast<Scalar*>(texture.texels.data());
  for (size_t i = 0; i < pixels; ++i) {
    for (size_t c = 0; c < 4; ++c) target[4 * i + c] = c < channels ? array.data()[channels * i + c] : opaque;
  }
}

/// The type of the array selects the format: bytes keep a format of bytes, others become floats.
void set_texels(Texture& texture, const py::object& object) {
  const auto any = py::array::ensure(object);
  if (!any) throw py::error_already_set();
  const char kind = any.dtype().kind();
  if (kind == 'u' && any.itemsize() == 1) {
    if (texture.format == PixelFormat::rgba32_float) texture.format = PixelFormat::rgba8_srgb;
    return copy_texels<uint8_t>(texture, InputArray<uint8_t>::ensure(any), 255);
  }
  if (kind != 'f') {
    throw Error("texels have elements of type " + std::string(py::str(any.dtype())) +
                "; give uint8 values from 0 to 255, or linear floats");
  }
  texture.format = PixelFormat::rgba32_float;
  copy_texels<float>(texture, InputArray<float>::ensure(any), 1.0f);
}

/// Throws Error if the texture has texels of another size.
void set_format(Texture& texture, PixelFormat format) {
  if (!texture.texels.empty() && texel_bytes(format) != texel_bytes(texture.format)) {
    throw Error("texture '" + texture.name + "' has texels of the format " +
                std::string(kPixelFormats[static_cast<size_t>(texture.format)]) +
                "; set its texels, whose type selects bytes or floats");
  }
  texture.format = format;
}

void define_textures(py::module_& module) {
  auto texture = keyword_class<Texture>(module, "Texture", "An image for surface look-ups.");
  texture.def_readwrite("name", &Texture::name);
  texture.def_property(
      "format", [](const Texture& t) { return std::string(kPixelFormats[static_cast<size_t>(t.format)]); },
      [](Texture& t, const std::string& name) { set_format(t, named(kPixelFormats, name, "format", PixelFormat{})); },
      "Storage: 'rgba8-srgb' (colours), 'rgba8-linear' (data) or 'rgba32-float'.");
  choice(texture, "wrap_u", &Texture::wrap_u, kWrapModes, "'repeat', 'clamp' or 'mirror'.");
  choice(texture, "wrap_v", &Texture::wrap_v, kWrapModes, "'repeat', 'clamp' or 'mirror'.");
  choice(texture, "filter", &Texture::filter, kFilterModes, "'nearest' or 'linear'.");
  texture.def_property("texels", &texels_of, &set_texels,
                       "Array of shape (height, width, 4), row 0 on top: uint8 or linear float32. Reading gives a "
                       "read-only copy. RGB gets alpha 1.");
  auto reference = keyword_class<TextureRef>(module, "TextureRef",
                                             "A material's use of a texture, with a transform of its coordinates.");
  reference.def_readwrite("texture", &TextureRef::texture, "Index in Scene.textures; -1: none.")
      .def_readwrite("uv_set", &TextureRef::uv_set, "0 or 1.")
      .def_readwrite("offset", &TextureRef::offset, "(u, v), added after scale and rotation.")
      .def_readwrite("scale", &TextureRef::scale, "Factors of (u, v).")
      .def_readwrite("rotation_rad", &TextureRef::rotation_rad, "Counter-clockwise, radians.");
}

/// Clearcoat, anisotropy, sheen, iridescence, diffuse transmission and mixtures.
void define_layers(Class<Material>& m) {
  m.def_readwrite("clearcoat", &Material::clearcoat, "Strength, in [0, 1].")
      .def_readwrite("clearcoat_texture", &Material::clearcoat_texture, "R.")
      .def_readwrite("clearcoat_roughness", &Material::clearcoat_roughness, "Perceptual, in [0, 1].")
      .def_readwrite("clearcoat_roughness_texture", &Material::clearcoat_roughness_texture, "G.")
      .def_readwrite("clearcoat_normal_texture", &Material::clearcoat_normal_texture,
                     "As normal_texture; none: the unmapped normal.")
      .def_readwrite("clearcoat_normal_scale", &Material::clearcoat_normal_scale, "Factor of its X and Y.")
      .def_readwrite("anisotropy", &Material::anisotropy, "Strength, in [0, 1].")
      .def_readwrite("anisotropy_rotation_rad", &Material::anisotropy_rotation_rad,
                     "Counter-clockwise from the tangent.")
      .def_readwrite("anisotropy_texture", &Material::anisotropy_texture, "RG direction, B strength.")
      .def_readwrite("sheen_color", &Material::sheen_color, "RGB; black: no sheen.")
      .def_readwrite("sheen_color_texture", &Material::sheen_color_texture, "RGB.")
      .def_readwrite("sheen_roughness", &Material::sheen_roughness, "Perceptual, in [0, 1].")
      .def_readwrite("sheen_roughness_texture", &Material::sheen_roughness_texture, "A.")
      .def_readwrite("iridescence", &Material::iridescence, "Strength, in [0, 1].")
      .def_readwrite("iridescence_texture", &Material::iridescence_texture, "R.")
      .def_readwrite("iridescence_ior", &Material::iridescence_ior, "Index of refraction of the film.")
      .def_readwrite("iridescence_thickness_min_nm", &Material::iridescence_thickness_min_nm,
                     "Thickness where the texture is 0, nanometres.")
      .def_readwrite("iridescence_thickness_nm", &Material::iridescence_thickness_nm,
                     "Thickness where the texture is 1, or without a texture, nanometres.")
      .def_readwrite("iridescence_thickness_texture", &Material::iridescence_thickness_texture, "G.")
      .def_readwrite("diffuse_transmission", &Material::diffuse_transmission, "In [0, 1].")
      .def_readwrite("diffuse_transmission_texture", &Material::diffuse_transmission_texture, "A.")
      .def_readwrite("diffuse_transmission_color", &Material::diffuse_transmission_color, "RGB.")
      .def_readwrite("diffuse_transmission_color_texture", &Material::diffuse_transmission_color_texture, "RGB.")
      .def_readwrite("mix_first", &Material::mix_first,
                     "Index in Scene.materials; -1: no mixture. At each hit a coin chooses a part of a mixture.")
      .def_readwrite("mix_second", &Material::mix_second, "Index in Scene.materials.")
      .def_readwrite("mix_share", &Material::mix_share, "Probability of the second part, in [0, 1].")
      .def_readwrite("mix_texture", &Material::mix_texture, "R.");
}

}  // namespace

void define_materials(py::module_& module) {
  define_textures(module);
  auto m = keyword_class<Material>(module, "Material",
                                   "A glTF 2.0 material with extensions. Colours are linear RGB in [0, 1], emission is "
                                   "a radiance. Textures multiply their factors.");
  choice(m, "alpha_mode", &Material::alpha_mode, kAlphaModes, "'opaque', 'mask' or 'blend'.");
  choice(m, "microfacet_model", &Material::microfacet_model, kMicrofacetModels, "'ggx' or 'beckmann'.");
  m.def_readwrite("name", &Material::name)
      .def_readwrite("base_color", &Material::base_color, "RGB.")
      .def_readwrite("alpha", &Material::alpha, "Coverage, in [0, 1]; see alpha_mode.")
      .def_readwrite("base_color_texture", &Material::base_color_texture, "RGB colour, A alpha.")
      .def_readwrite("metallic", &Material::metallic, "In [0, 1].")
      .def_readwrite("roughness", &Material::roughness, "Perceptual, in [0, 1].")
      .def_readwrite("metallic_roughness_texture", &Material::metallic_roughness_texture, "G roughness, B metallic.")
      .def_readwrite("normal_texture", &Material::normal_texture, "RGB: the normal in tangent space.")
      .def_readwrite("normal_scale", &Material::normal_scale, "Factor of the X and Y of normal_texture.")
      .def_readwrite("emission", &Material::emission, "Radiance.")
      .def_readwrite("emission_texture", &Material::emission_texture, "RGB.")
      .def_readwrite("alpha_cutoff", &Material::alpha_cutoff, "'mask': smaller alpha is transparent.")
      .def_readwrite("double_sided", &Material::double_sided, "Whether the back emits, too.")
      .def_readwrite("cull_back_faces", &Material::cull_back_faces, "Whether the camera does not see back faces.")
      .def_readwrite("unlit", &Material::unlit, "Emits the base colour, reflects nothing.")
      .def_readwrite("ior", &Material::ior, "Index of refraction.")
      .def_readwrite("dispersion", &Material::dispersion, "20 / Abbe number.")
      .def_readwrite("specular", &Material::specular, "Strength of the reflection of dielectrics, in [0, 1].")
      .def_readwrite("specular_texture", &Material::specular_texture, "A.")
      .def_readwrite("specular_color", &Material::specular_color,
                     "RGB of the reflection of dielectrics at normal incidence.")
      .def_readwrite("specular_color_texture", &Material::specular_color_texture, "RGB.")
      .def_readwrite("transmission", &Material::transmission, "In [0, 1].")
      .def_readwrite("transmission_texture", &Material::transmission_texture, "R.")
      .def_readwrite("thickness", &Material::thickness, "0: thin-walled, no refraction; otherwise a closed surface.")
      .def_readwrite("attenuation_color", &Material::attenuation_color,
                     "RGB of white light after the attenuation distance.")
      .def_readwrite("attenuation_distance", &Material::attenuation_distance, "Metres.");
  define_layers(m);
}

}  // namespace relume::python
