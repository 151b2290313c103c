#include "images.h"

#include "relume/image_io.h"
#include "relume/merge.h"
#include "relume/tone_map.h"

namespace relume::python {
namespace {

/// Keeps `value` alive for arrays that share its memory.
template <typename T>
py::capsule owner_of(std::unique_ptr<T> value) {
  return py::capsule(value.release(), [](void* memory) { delete static_cast<T*>(memory); });
}

ToneMap tone_map_named(const std::string& name) {
  for (size_t i = 0; i < kToneMapNames.size(); ++i) {
    if (kToneMapNames[i] == name) return static_cast<ToneMap>(i);
  }
  throw Error("there is no tone map '" + name + "'; choose one of none, reinhard, aces, agx, neutral");
}

py::dict exr_to_python(ExrFile&& exr) {
  py::dict channels;
  for (ExrChannel& channel : exr.channels)
    channels[py::str(channel.name)] = plane_array(std::move(channel.values), exr.width, exr.height);
  return channels;
}

void write_exr_channels(const std::filesystem::path& file, const py::dict& channels, const py::dict& attributes) {
  ExrFile exr;
  for (const auto& [name, values] : channels) {
    const auto array = InputArray<float>::ensure(values);
    if (!array) throw py::error_already_set();
    const std::string text = py::str(name);
    if (array.ndim() != 2)
      throw Error("EXR channel '" + text + "' has the shape " + shape_text(array) + "; give one of (height, width)");
    if (exr.channels.empty()) {
      exr.height = static_cast<int>(array.shape(0));
      exr.width = static_cast<int>(array.shape(1));
    } else if (array.shape(0) != exr.height || array.shape(1) != exr.width) {
      throw Error("EXR channel '" + text + "' has the shape " + shape_text(array) + ", others have (" +
                  std::to_string(exr.height) + ", " + std::to_string(exr.width) + "); give channels of one size");
    }
    exr.channels.push_back({text, {array.data(), array.data() + array.size()}});
  }
  for (const auto& [name, text] : attributes) exr.attributes[py::str(name)] = py::str(text);
  const py::gil_scoped_release released;
  write_exr(file, exr);
}

uint32_t merge(const std::vector<std::filesystem::path>& parts, const std::filesystem::path& output, bool keep_sums) {
  const py::gil_scoped_release released;
  return merge_images(parts, output, keep_sums).samples;
}

}  // namespace

Image image_from(const py::object& object, const char* what) {
  const auto any = py::array::ensure(object);
  if (!any) throw py::error_already_set();
  if (any.dtype().kind() != 'f') {
    throw Error(std::string(what) + " has elements of type " + std::string(py::str(any.dtype())) +
                "; an image has linear floats (divide 8-bit values by 255, and decode their transfer function)");
  }
  const auto array = InputArray<float>::ensure(any);
  if (array.ndim() != 3 || array.shape(2) != 3 || array.size() == 0) {
    throw Error(std::string(what) + " has the shape " + shape_text(array) +
                "; an image has the shape (height, width, 3)");
  }
  Image image(static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)));
  std::memcpy(static_cast<void*>(image.pixels.data()), array.data(), image.pixels.size() * sizeof(Rgb));
  return image;
}

py::array image_array(std::shared_ptr<const Image> image) {
  const std::vector<py::ssize_t> shape{image->height, image->width, 3};
  const auto* memory = reinterpret_cast<const float*>(image->pixels.data());
  return shared_array(shape, memory, owner_of(std::make_unique<std::shared_ptr<const Image>>(std::move(image))));
}

py::array image_array(Image&& image) {
  auto owned = std::make_unique<Image>(std::move(image));
  const std::vector<py::ssize_t> shape{owned->height, owned->width, 3};
  const auto* memory = reinterpret_cast<const float*>(owned->pixels.data());
  return py::array_t<float>(shape, memory, owner_of(std::move(owned)));
}

py::array plane_array(std::vector<float>&& values, int width, int height) {
  auto owned = std::make_unique<std::vector<float>>(std::move(values));
  const float* memory = owned->data();
  return py::array_t<float>(std::vector<py::ssize_t>{height, width}, memory, owner_of(std::move(owned)));
}

void define_images(py::module_& module) {
  module.def(
      "read_image",
      [](const std::filesystem::path& file) { return image_array(without_gil([&] { return read_image(file); })); },
      py::arg("file"));
  module.def(
      "write_image",
      [](const std::filesystem::path& file, const py::object& image) {
        const Image written = image_from(image, "image");
        const py::gil_scoped_release released;
        write_image(file, written);
      },
      py::arg("file"), py::arg("image"));
  module.def(
      "read_exr_channels",
      [](const std::filesystem::path& file) { return exr_to_python(without_gil([&] { return read_exr(file); })); },
      py::arg("file"));
  module.def(
      "read_exr_attributes",
      [](const std::filesystem::path& file) { return without_gil([&] { return read_exr(file).attributes; }); },
      py::arg("file"));
  module.def("merge", &merge, py::arg("parts"), py::arg("output"), py::arg("keep_sums"));
  module.def("write_exr_channels", &write_exr_channels, py::arg("file"), py::arg("channels"), py::arg("attributes"));
  module.def(
      "tone_map",
      [](const py::object& image, const std::string& curve, float exposure) {
        const Image radiance = image_from(image, "image");
        const ToneMap map = tone_map_named(curve);
        return image_array(without_gil([&] { return tone_map(radiance, map, exposure); }));
      },
      py::arg("image"), py::arg("curve"), py::arg("exposure"));
  module.def(
      "encode_png",
      [](const py::object& image) {
        const Image shown = image_from(image, "image");
        const std::vector<uint8_t> bytes = without_gil([&] { return encode_png(shown); });
        return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      },
      py::arg("image"));
  module.def("writable_alias", [](const py::array& array) {
    const auto shape = std::vector<py::ssize_t>(array.shape(), array.shape() + array.ndim());
    const auto strides = std::vector<py::ssize_t>(array.strides(), array.strides() + array.ndim());
    // In a tuple: an array as the base would make the alias read-only, too.
    return py::array(array.dtype(), shape, strides, array.data(), py::make_tuple(array));
  });
}

}  // namespace relume::python
