#include "compare/shared_results.h"

#include <concepts>
#include <cstdint>
#include <sstream>
#include <type_traits>
#include <utility>

#include "core/stream_io.h"
#include "relume/error.h"

namespace relume {
namespace {

template <typename Any, typename T>
concept SameOrConst = std::same_as<std::remove_const_t<Any>, T>;

void check_complete(const std::istream& in) {
  if (!in) throw Error("a result of another rank is incomplete; give all ranks the same version of relume");
}

void write_text(std::ostream& out, const std::string& text) {
  write_vector(out, std::vector<char>(text.begin(), text.end()));
}

std::string read_text(std::istream& in) {
  std::vector<char> text;
  read_vector(in, text);
  return {text.begin(), text.end()};
}

size_t read_size(std::istream& in) {
  uint64_t size = 0;
  read_value(in, size);
  check_complete(in);
  return size;
}

void write_image(std::ostream& out, const Image& image) {
  write_value(out, image.width);
  write_value(out, image.height);
  write_vector(out, image.pixels);
}

Image read_image(std::istream& in) {
  Image image;
  read_value(in, image.width);
  read_value(in, image.height);
  read_vector(in, image.pixels);
  return image;
}

/// Calls `visit` with each member of fixed size.
template <typename Visit>
void visit_numbers(SameOrConst<Reference> auto& r, const Visit& visit) {
  visit(r.mse);
  visit(r.rel_mse);
  visit(r.spp);
  visit(r.cached);
  visit(r.render_s);
}
template <typename Visit>
void visit_numbers(SameOrConst<Repetition> auto& r, const Visit& visit) {
  visit(r.seed);
  visit(r.frames);
  visit(r.samples);
  visit(r.time_s);
  visit(r.rays);
  visit(r.mse);
  visit(r.rel_mse);
  visit(r.mape);
  visit(r.flip);
  visit(r.temporal_error);
  visit(r.nonfinite);
}

void write_repetition(std::ostream& out, const Repetition& r) {
  visit_numbers(r, [&](const auto& value) { write_value(out, value); });
  write_vector(out, r.curve);
  write_value(out, uint64_t{r.passes.size()});
  for (const PassTime& pass : r.passes) {
    write_text(out, pass.name);
    write_value(out, pass.seconds);
    write_value(out, pass.idle_s);
  }
}

Repetition read_repetition(std::istream& in) {
  Repetition r;
  visit_numbers(r, [&](auto& value) { read_value(in, value); });
  read_vector(in, r.curve);
  const size_t passes = read_size(in);
  for (size_t i = 0; i < passes && in; ++i) {
    PassTime pass;
    pass.name = read_text(in);
    read_value(in, pass.seconds);
    read_value(in, pass.idle_s);
    r.passes.push_back(std::move(pass));
  }
  return r;
}

}  // namespace

std::string to_bytes(const RunResult& result) {
  std::ostringstream out;
  write_value(out, result.threads);
  write_value(out, uint64_t{result.repetitions.size()});
  for (size_t i = 0; i < result.repetitions.size(); ++i) {
    write_repetition(out, result.repetitions[i]);
    write_image(out, result.images[i]);
  }
  return out.str();
}

RunResult run_result_from(const std::string& bytes) {
  std::istringstream in(bytes);
  RunResult result;
  read_value(in, result.threads);
  const size_t contenders = read_size(in);
  for (size_t i = 0; i < contenders && in; ++i) {
    result.repetitions.push_back(read_repetition(in));
    result.images.push_back(read_image(in));
  }
  check_complete(in);
  return result;
}

std::string to_bytes(const ReferenceHalf& half) {
  std::ostringstream out;
  write_image(out, half.image);
  write_value(out, uint64_t{half.surface.size()});
  for (const ExrChannel& channel : half.surface) {
    write_text(out, channel.name);
    write_vector(out, channel.values);
  }
  return out.str();
}

ReferenceHalf reference_half_from(const std::string& bytes) {
  std::istringstream in(bytes);
  ReferenceHalf half;
  half.image = read_image(in);
  const size_t channels = read_size(in);
  for (size_t i = 0; i < channels && in; ++i) {
    ExrChannel channel;
    channel.name = read_text(in);
    read_vector(in, channel.values);
    half.surface.push_back(std::move(channel));
  }
  check_complete(in);
  return half;
}

std::string to_bytes(const std::vector<Reference>& references) {
  std::ostringstream out;
  write_value(out, uint64_t{references.size()});
  for (const Reference& reference : references) {
    write_image(out, reference.image);
    write_image(out, reference.squared_error);
    visit_numbers(reference, [&](const auto& value) { write_value(out, value); });
    write_vector(out, reference.surface.motion);
    write_vector(out, reference.surface.depth);
    write_vector(out, reference.surface.normal);
  }
  return out.str();
}

std::vector<Reference> references_from(const std::string& bytes) {
  std::istringstream in(bytes);
  std::vector<Reference> references;
  const size_t count = read_size(in);
  for (size_t i = 0; i < count && in; ++i) {
    Reference reference;
    reference.image = read_image(in);
    reference.squared_error = read_image(in);
    visit_numbers(reference, [&](auto& value) { read_value(in, value); });
    read_vector(in, reference.surface.motion);
    read_vector(in, reference.surface.depth);
    read_vector(in, reference.surface.normal);
    references.push_back(std::move(reference));
  }
  check_complete(in);
  return references;
}

std::string to_bytes(const EqualTime& equal) {
  std::ostringstream out;
  write_vector(out, equal.frames);
  write_vector(out, equal.time_s);
  return out.str();
}

EqualTime equal_time_from(const std::string& bytes) {
  std::istringstream in(bytes);
  EqualTime equal;
  read_vector(in, equal.frames);
  read_vector(in, equal.time_s);
  check_complete(in);
  return equal;
}

std::string to_bytes(const std::vector<std::string>& texts) {
  std::ostringstream out;
  write_value(out, uint64_t{texts.size()});
  for (const std::string& text : texts) write_text(out, text);
  return out.str();
}

std::vector<std::string> texts_from(const std::string& bytes) {
  std::istringstream in(bytes);
  std::vector<std::string> texts;
  const size_t count = read_size(in);
  for (size_t i = 0; i < count && in; ++i) texts.push_back(read_text(in));
  check_complete(in);
  return texts;
}

}  // namespace relume
