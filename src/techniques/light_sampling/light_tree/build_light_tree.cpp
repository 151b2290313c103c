#include "techniques/light_sampling/light_tree/build_light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/box.h"

namespace relume {
namespace {

constexpr int kBins = 12;

/// Surface area, plus a small term for boxes without area.
double area_of(const Box& box) {
  const glm::dvec3 e(box.extent());
  return 2 * (e.x * e.y + e.y * e.z + e.z * e.x) + 1e-3 * glm::dot(e, e);
}

/// Normals within `o` of the axis; light spreads by `e` around each. Radians.
struct Cone {
  Vec3 axis{0, 0, 1};
  double o = -1;  ///< negative: empty cone
  double e = 0;

  /// Extends to the smallest common cone ([Conty18], listing 1).
  void add(const Cone& other) {
    if (other.o < 0) return;
    if (o < 0) {
      *this = other;
      return;
    }
    const bool wider = o >= other.o;
    const Cone a = wider ? *this : other;
    const Cone b = wider ? other : *this;
    e = std::max(a.e, b.e);
    const Vec3 normal = glm::cross(a.axis, b.axis);
    const double sine = std::sqrt(static_cast<double>(length_squared(normal)));
    const double cosine = static_cast<double>(glm::dot(a.axis, b.axis));
    const double between = std::atan2(sine, cosine);
    axis = a.axis;
    o = a.o;
    if (std::min(between + b.o, M_PI) <= a.o) return;
    const double angle = 0.5 * (a.o + between + b.o);
    constexpr double kParallel = 1e-6;
    if (angle >= M_PI || (sine < kParallel && cosine < 0)) {
      o = M_PI;
      return;
    }
    if (sine < kParallel) {
      o = between + b.o;
      return;
    }
    const float turn = static_cast<float>(angle - a.o);
    const Vec3 across = glm::normalize(glm::cross(glm::normalize(normal), a.axis));
    axis = glm::normalize(a.axis * std::cos(turn) + across * std::sin(turn));
    o = angle;
  }

  /// Cosine-weighted solid angle of the directions of emission ([Conty18], eq. 1).
  double measure() const {
    const double w = std::min(o + e, M_PI);
    return 2 * M_PI * (1 - std::cos(o)) +
           M_PI / 2 * (2 * w * std::sin(o) - std::cos(o - 2 * w) - 2 * o * std::sin(o) + std::cos(o));
  }
};

struct Item {
  Box box;
  Cone cone;
  bool two_sided = false;
  double intensity = 0;  ///< along the axis, W/sr
  LightId light = kNoLight;

  Vec3 center() const { return box.center(); }
  void add(const Item& other) {
    box.add(other.box);
    cone.add(other.cone);
    two_sided = two_sided || other.two_sided;
    intensity += other.intensity;
  }
  double cost() const { return intensity * area_of(box) * cone.measure(); }
};

Item item_of(const LightExtent& extent, LightId id) {
  return {extent.box, {extent.axis, extent.theta_o, extent.theta_e}, extent.two_sided, extent.intensity, id};
}

/// Extends a cone with the normals at the keys `k` and k + 1 of the shutter to those between. Up to their lengths,
/// these are a quadratic Bézier curve, which lies in every convex cone around its three control points.
void add_normals_between(const LightsView& lights, LightId id, uint32_t k, Cone& cone) {
  const TriangleLight& light = lights.lights[id].triangle;
  const LightKey& a = lights.keys[lights.first_keys[id] + k];
  const LightKey& b = lights.keys[lights.first_keys[id] + k + 1];
  const float orientation = glm::dot(glm::cross(light.e1, light.e2), light.normal) < 0.0f ? -1.0f : 1.0f;
  const Vec3 between = (glm::cross(a.e1, b.e2) + glm::cross(b.e1, a.e2)) * orientation;
  if (length_squared(between) > 0.0f) cone.add({glm::normalize(between), 0, cone.e});
}

Item item_of(const LightsView& lights, LightId id) {
  const auto watts = static_cast<double>(selection_weight(lights, id));
  Item item = item_of(extent_of(lights.lights[id], watts), id);
  if (!moves(lights, id)) return item;
  // While the shutter is open, the light must have bounds for all times: bidirectional weights do not compensate for a
  // light that is never chosen.
  const double intensity = item.intensity;
  for (uint32_t k = 0; k < lights.key_count; ++k) {
    const float time = static_cast<float>(k) / static_cast<float>(lights.key_count - 1);
    item.add(item_of(extent_of(moved_light(lights, id, time), watts), id));
    if (k > 0) add_normals_between(lights, id, k - 1, item.cone);
  }
  if (item.cone.o > M_PI / 2) item.cone.o = M_PI;  // wider cones are not convex
  item.intensity = intensity;
  return item;
}

LightBounds bounds_of_item(const Item& item) {
  LightBounds b;
  b.center = item.center();
  b.radius = 0.5f * glm::length(item.box.extent());
  b.axis = item.cone.axis;
  b.cos_o = static_cast<float>(std::cos(item.cone.o));
  // Slightly widened, so that rounding never hides a light, even a spot without a soft edge.
  constexpr double kCosineError = 4e-7;
  b.cos_e = static_cast<float>(std::min(std::cos(std::min(item.cone.e + 1e-4, M_PI)), 1 - kCosineError));
  b.intensity = static_cast<float>(item.intensity);
  b.two_sided = item.two_sided ? 1.0f : 0.0f;
  return b;
}

struct BinaryNode {
  Item item;
  uint32_t first = 0;
  uint32_t count = 0;
  uint32_t left = 0;  ///< left child, followed by the right one; 0: a leaf
  uint32_t depth = 0;
};

class Builder {
 public:
  Builder(const LightsView& lights, LightsAtInfinity infinity) {
    for (LightId i = 0; i < lights.first_infinite; ++i) {
      const Item item = item_of(lights, i);
      if (item.intensity > 0) items_.push_back(item);
    }
    data_.place.assign(lights.first_infinite, light_tree::kNoParent);
    data_.infinite = build_infinite_lights(lights, infinity);
    if (items_.empty()) return;
    split();
    for (const Item& item : items_) {
      data_.lights.push_back(item.light);
      data_.bounds.push_back(bounds_of_item(item));
    }
    widen();
  }

  LightTreeData take() { return std::move(data_); }

 private:
  void split() {
    binary_.push_back(BinaryNode{{}, 0, static_cast<uint32_t>(items_.size())});
    for (size_t i = 0; i < binary_.size(); ++i) {
      for (uint32_t k = 0; k < binary_[i].count; ++k) binary_[i].item.add(items_[binary_[i].first + k]);
      if (binary_[i].count <= kLightTreeLeafSize) continue;
      const uint32_t middle = partition(binary_[i]);
      const BinaryNode node = binary_[i];
      binary_[i].left = static_cast<uint32_t>(binary_.size());
      binary_.push_back(BinaryNode{{}, node.first, middle - node.first, 0, node.depth + 1});
      binary_.push_back(BinaryNode{{}, middle, node.first + node.count - middle, 0, node.depth + 1});
    }
  }

  /// Splits the items at the cheapest plane between bins. Halves them if no plane separates them, and at great depth to
  /// keep paths within LightTree::kMostLevels.
  uint32_t partition(const BinaryNode& node) {
    if (node.depth >= LightTree::kMostLevels / 2) return node.first + node.count / 2;
    Box centers;
    for (uint32_t k = 0; k < node.count; ++k) centers.add(items_[node.first + k].center());
    const Vec3 extent = centers.extent();
    double best = HUGE_VAL;
    int best_axis = -1;
    int best_bin = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(extent[axis] > 0)) continue;
      std::array<Item, kBins> bins;
      for (uint32_t k = 0; k < node.count; ++k) {
        const Item& item = items_[node.first + k];
        bins[static_cast<size_t>(bin_of(item, axis, centers))].add(item);
      }
      std::array<double, kBins> right{};
      Item sum;
      for (int b = kBins - 1; b > 0; --b) {
        sum.add(bins[static_cast<size_t>(b)]);
        right[static_cast<size_t>(b)] = sum.intensity > 0 ? sum.cost() : HUGE_VAL;
      }
      Item left;
      const double regular = static_cast<double>(max_component(extent) / extent[axis]);
      for (int b = 0; b + 1 < kBins; ++b) {
        left.add(bins[static_cast<size_t>(b)]);
        if (!(left.intensity > 0)) continue;
        const double cost = regular * (left.cost() + right[static_cast<size_t>(b) + 1]);
        if (cost < best) {
          best = cost;
          best_axis = axis;
          best_bin = b;
        }
      }
    }
    const auto begin = items_.begin() + node.first;
    const auto end = begin + node.count;
    if (best_axis >= 0) {
      const auto middle = std::stable_partition(
          begin, end, [&](const Item& item) { return bin_of(item, best_axis, centers) <= best_bin; });
      if (middle != begin && middle != end) return static_cast<uint32_t>(middle - items_.begin());
    }
    return node.first + node.count / 2;
  }

  static int bin_of(const Item& item, int axis, const Box& centers) {
    const float t = (item.center()[axis] - centers.low[axis]) / (centers.high[axis] - centers.low[axis]);
    return std::clamp(static_cast<int>(t * kBins), 0, kBins - 1);
  }

  void widen() {
    struct Task {
      uint32_t binary;
      uint32_t parent;
    };
    std::vector<Task> tasks{{0, light_tree::kNoParent}};
    for (size_t i = 0; i < tasks.size(); ++i) {
      const uint32_t number = static_cast<uint32_t>(data_.nodes.size());
      LightTreeNode wide{};
      wide.parent = tasks[i].parent;
      if (wide.parent != light_tree::kNoParent) data_.nodes[wide.parent / 8].child[wide.parent % 8] = number;
      const std::vector<uint32_t> children = children_of(tasks[i].binary);
      for (uint32_t c = 0; c < children.size(); ++c) {
        const BinaryNode& child = binary_[children[c]];
        put(wide, c, bounds_of_item(child.item));
        if (child.left == 0) {
          wide.child[c] = child.first;
          wide.lights[c] = child.count;
          for (uint32_t k = 0; k < child.count; ++k) data_.place[items_[child.first + k].light] = 8 * number + c;
        } else {
          tasks.push_back({children[c], 8 * number + c});
        }
      }
      data_.nodes.push_back(wide);
    }
  }

  /// Up to eight descendants that cover the node, by opening the costliest one first.
  std::vector<uint32_t> children_of(uint32_t node) const {
    if (binary_[node].left == 0) return {node};
    std::vector<uint32_t> children{binary_[node].left, binary_[node].left + 1};
    while (children.size() < kLightTreeWidth) {
      size_t widest = children.size();
      for (size_t c = 0; c < children.size(); ++c) {
        const BinaryNode& child = binary_[children[c]];
        if (child.left == 0) continue;
        if (widest == children.size() || child.item.cost() > binary_[children[widest]].item.cost()) widest = c;
      }
      if (widest == children.size()) break;
      const uint32_t left = binary_[children[widest]].left;
      children[widest] = left;
      children.push_back(left + 1);
    }
    return children;
  }

  static void put(LightTreeNode& node, uint32_t c, const LightBounds& b) {
    for (int axis = 0; axis < 3; ++axis) {
      node.center[axis][c] = b.center[axis];
      node.axis[axis][c] = b.axis[axis];
    }
    node.radius[c] = b.radius;
    node.cos_o[c] = b.cos_o;
    node.cos_e[c] = b.cos_e;
    node.intensity[c] = b.intensity;
    node.two_sided[c] = b.two_sided;
  }

  std::vector<Item> items_;
  std::vector<BinaryNode> binary_;
  LightTreeData data_;
};

}  // namespace

LightTree LightTreeData::view(const LightsView& all) const {
  LightTree tree;
  tree.nodes = view_of(nodes);
  tree.bounds = view_of(bounds);
  tree.lights = view_of(lights);
  tree.place = view_of(place);
  tree.infinite = make_infinite_lights(all, view_of(infinite), !nodes.empty());
  return tree;
}

void LightTreeArrays::assign(const LightTreeData& data) {
  nodes_.assign(data.nodes);
  bounds_.assign(data.bounds);
  lights_.assign(data.lights);
  place_.assign(data.place);
  infinite_.assign(data.infinite);
}

LightTree LightTreeArrays::view(const LightsView& all) const {
  LightTree tree;
  tree.nodes = nodes_.view();
  tree.bounds = bounds_.view();
  tree.lights = lights_.view();
  tree.place = place_.view();
  tree.infinite = make_infinite_lights(all, infinite_.view(), !nodes_.empty());
  return tree;
}

size_t LightTreeArrays::memory_bytes() const {
  return nodes_.memory_bytes() + bounds_.memory_bytes() + lights_.memory_bytes() + place_.memory_bytes() +
         infinite_.memory_bytes();
}

LightBounds bounds_of(const LightsView& lights, LightId id) { return bounds_of_item(item_of(lights, id)); }

LightTreeData build_light_tree(const LightsView& lights, LightsAtInfinity infinity) {
  return Builder(lights, infinity).take();
}

}  // namespace relume
