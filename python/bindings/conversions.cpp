#include "conversions.h"

#include <limits>

namespace relume::python {

std::string shape_text(const py::array& array) { return py::str(array.attr("shape")); }

void check_unsigned(const py::array& array, const char* what) {
  if (!array || array.size() == 0) return PyErr_Clear();
  const char kind = array.dtype().kind();
  if (kind != 'i' && kind != 'u')
    throw Error(std::string(what) + " has elements of type " + std::string(py::str(array.dtype())) + "; give integers");
  const auto least = array.attr("min")().cast<int64_t>();
  const auto most = array.attr("max")().cast<int64_t>();
  if (least < 0 || most > std::numeric_limits<uint32_t>::max()) {
    throw Error(std::string(what) + " has the element " + std::to_string(least < 0 ? least : most) +
                "; give numbers from 0 to 4294967295");
  }
}

}  // namespace relume::python
