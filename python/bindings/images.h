// Images as NumPy arrays.
#pragma once

#include <memory>

#include "conversions.h"
#include "relume/image.h"

namespace relume::python {

/// Copies an array of shape (height, width, 3). Throws Error that names `what` for other shapes.
Image image_from(const py::object& array, const char* what);
/// A read-only array of shape (height, width, 3) that shares the image's memory.
py::array image_array(std::shared_ptr<const Image> image);
/// A writable array of that shape that takes the image's memory.
py::array image_array(Image&& image);
/// An array of shape (height, width) that takes the values' memory.
py::array plane_array(std::vector<float>&& values, int width, int height);

void define_images(py::module_& module);

}  // namespace relume::python
