// Tests that every setting has an effect: in some context, another value changes the bits. Rendering is deterministic,
// so only the setting can cause the difference.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "render/build_pipeline.h"
#include "render/session.h"
#include "settings/rooms.h"
#include "settings/settings_json.h"
#include "support/measure.h"
#include "support/technique_checks.h"
#include "support/test_name.h"

namespace relume::support {
namespace {

/// A SettingCheck in a scene.
struct Context : SettingCheck {
  Scene (*scene)() = build_busy_room;
};

/// Contexts of settings outside techniques; checks.json has those of techniques.
std::vector<Context> general_contexts() {
  std::vector<Context> list;
  for (const char* name : {"width", "height", "texture-filter", "seed", "stratify", "dither", "estimator", "guide",
                           "reuse", "cache", "denoise", "max-bounces"})
    list.push_back({{name}});
  list.push_back({{"camera", "", "side"}});
  list.push_back({{"scene-time", "max-bounces=0", "1"}, build_curtain});  // also affects random numbers
  list.push_back({{"shutter", "max-bounces=0 scene-time=0.3", "1"}, build_curtain});
  list.push_back({{"shutter-keys", "max-bounces=0 scene-time=0.3 shutter=1"}, build_curtain});
  list.push_back({{"animation", "max-bounces=0 scene-time=1", "go"}, build_curtain_with_clips});
  list.push_back({{"lights", "static-lists.cell-size=2 static-lists.rays=64"}});
  list.push_back({{"allocation", "adaptive.max=6"}});
  list.push_back({{"history", "", "", CheckMotion::camera}});
  return list;
}

const std::vector<Context>& contexts() {
  static const std::vector<Context> all = [] {
    std::vector<Context> list = general_contexts();
    for (const SettingCheck& check : technique_checks().settings) list.push_back({check});
    return list;
  }();
  return all;
}

/// A setting without visible effect.
struct Exemption {
  std::string_view setting;
  std::string_view reason;
  std::string_view other;  ///< value that must give the same bits, except for `different` pixels
  size_t different = 0;
};
const Exemption kExemptions[] = {
    {"threads", "the same bits with any number of threads are a promise", "3"},
    {"accel", "hits differ at edges only, few in a million", "bvh", 2},
    {"device", "a GPU gives the bits of relume's BVH on the processor", "auto", 2},
    {"scalar-kernels", "both forms of a kernel give the same bits", "on"},
};

bool is_for(const Context& context, std::string_view name) {
  return context.setting == name || (context.setting.ends_with('.') && name.starts_with(context.setting));
}

const Exemption* exemption_of(std::string_view name) {
  for (const Exemption& exemption : kExemptions) {
    if (exemption.setting == name) return &exemption;
  }
  return nullptr;
}

std::vector<std::string> words(std::string_view text) {
  std::istringstream stream{std::string(text)};
  std::vector<std::string> list;
  for (std::string word; stream >> word;) list.push_back(word);
  return list;
}

void set(RenderSettings& settings, std::string_view name, std::string_view value) {
  const SettingList list = describe(settings);
  assign(require_setting(list, name, "context"), value, "context");
}

/// Applies "name=value name=value".
void apply_changes(std::string_view changes, RenderSettings& settings) {
  for (const std::string& change : words(changes)) {
    const size_t equals = change.find('=');
    set(settings, change.substr(0, equals), change.substr(equals + 1));
  }
}

/// Other values: all other names of a choice, the negated boolean, the minimum of an integer, or the midpoint to a
/// number's minimum. A value at the minimum is increased by 1.
std::vector<std::string> other_values(const Setting& setting) {
  if (const auto* flag = std::get_if<bool*>(&setting.value)) return {**flag ? "off" : "on"};
  if (const auto* choice = std::get_if<ChoiceRef>(&setting.value)) {
    std::vector<std::string> names(choice->names.begin(), choice->names.end());
    names.erase(names.begin() + *choice->value);
    return names;
  }
  const double least = setting.traits.min;
  std::ostringstream text;
  if (const auto* number = std::get_if<int*>(&setting.value)) {
    text << (**number > least ? least : **number + 1);
  } else if (const auto* real = std::get_if<float*>(&setting.value)) {
    const auto value = static_cast<double>(**real);
    text << (value > least ? 0.5 * (value + least) : value + 1);
  }
  return {text.str()};
}

void move(Session& session, CheckMotion motion, int step) {
  if (motion == CheckMotion::lamp) session.set_time(0.2f * static_cast<float>(step));
  if (motion != CheckMotion::camera) return;
  CameraPose camera = session.camera();
  camera.to_world[3] += Vec4(0.17f, 0.03f, -0.45f, 0);  // also closer: changes cell sizes
  session.set_camera(camera);
}

using Bits = std::vector<std::byte>;

constexpr int kStill = 4;  // frames before the motion
constexpr int kMoving = 3;
constexpr int kFrames = 8;

/// Renders the frames of a context one after another.
class Frames {
 public:
  Frames(const Context& context, const RenderSettings& settings)
      : context_(context), session_(context.scene(), settings) {}

  void render_next() {
    if (next_ >= kStill && next_ < kStill + kMoving) move(session_, context_.motion, next_ - kStill + 1);
    session_.render_frame();
    ++next_;
  }
  /// Bits of the last frame: of the context's buffer, or of the image.
  Bits bits() const {
    if (!context_.buffer.empty()) {
      const Buffer* buffer = buffer_table(session_).find(context_.buffer);
      if (!buffer) throw std::runtime_error("there is no buffer " + std::string(context_.buffer));
      return {buffer->bytes().begin(), buffer->bytes().end()};
    }
    const Image image = session_.image();
    Bits bits(image.pixels.size() * sizeof(Rgb));
    std::memcpy(bits.data(), image.pixels.data(), bits.size());
    return bits;
  }

 private:
  const Context& context_;
  Session session_;
  int next_ = 0;
};

/// The first frame whose bits are compared: the first moved one if the scene or the camera moves. Buffers are compared
/// after the last frame.
int first_compared(const Context& context) {
  if (!context.buffer.empty()) return kFrames - 1;
  return context.motion == CheckMotion::none ? 0 : kStill;
}

/// Bits of all compared frames. Rendered once per process: many settings have the same context.
const std::vector<Bits>& compared_frames(const Context& context, RenderSettings& settings) {
  using Key = std::tuple<uintptr_t, CheckMotion, std::string, std::string>;
  static std::map<Key, std::vector<Bits>> known;
  const Key key(reinterpret_cast<uintptr_t>(context.scene), context.motion, context.buffer,
                settings_to_json(describe(settings)));
  if (const auto found = known.find(key); found != known.end()) return found->second;
  std::vector<Bits> compared;
  Frames frames(context, settings);
  for (int frame = 0; frame < kFrames; ++frame) {
    frames.render_next();
    if (frame >= first_compared(context)) compared.push_back(frames.bits());
  }
  return known.emplace(key, std::move(compared)).first->second;
}

/// Whether a frame with `changed` settings has other bits than `before`. The first such frame ends the rendering.
bool changes_bits(const Context& context, const RenderSettings& changed, const std::vector<Bits>& before) {
  Frames frames(context, changed);
  for (int frame = 0; frame < kFrames; ++frame) {
    frames.render_next();
    if (frame < first_compared(context)) continue;
    if (frames.bits() != before[static_cast<size_t>(frame - first_compared(context))]) return true;
  }
  return false;
}

Bits rendered(const Context& context, const RenderSettings& settings) {
  Frames frames(context, settings);
  for (int frame = 0; frame < kFrames; ++frame) frames.render_next();
  return frames.bits();
}

/// Number of pixels of two images whose bits differ.
size_t different_pixels(const Bits& a, const Bits& b) {
  size_t count = 0;
  for (size_t i = 0; i < a.size(); i += sizeof(Rgb)) count += std::memcmp(&a[i], &b[i], sizeof(Rgb)) != 0 ? 1 : 0;
  return count;
}

std::vector<std::string> setting_names() {
  RenderSettings settings;
  std::vector<std::string> names;
  for (const Setting& setting : describe(settings)) names.push_back(setting.name);
  return names;
}

std::string setting_name(const ::testing::TestParamInfo<std::string>& info) { return test_name(info.param); }

/// The last context for a setting, with the changes of all its contexts. Its name is empty if none exists.
Context context_of(std::string_view name, RenderSettings& settings) {
  Context found;
  for (const Context& context : contexts()) {
    if (!is_for(context, name)) continue;
    apply_changes(context.with, settings);
    found = context;
  }
  return found;
}

/// Settings of a context, for messages.
std::string described(RenderSettings& settings) {
  RenderSettings plain = small_settings(settings.width, settings.height);
  const SettingList list = describe(settings);
  std::string text;
  for (const Setting* setting : differing_settings(list, describe(plain)))
    text += " " + setting->name + "=" + to_string(*setting);
  return text.empty() ? " the defaults" : text;
}

class EverySetting : public ::testing::TestWithParam<std::string> {};

TEST_P(EverySetting, HasAnEffect) {
  const std::string& name = GetParam();
  RenderSettings settings = small_settings(32, 32);
  if (const Exemption* exempt = exemption_of(name)) {
    RenderSettings changed = settings;
    set(changed, name, exempt->other);
    const std::vector<Bits> before = compared_frames({{name}}, settings);
    const std::vector<Bits> after = compared_frames({{name}}, changed);
    size_t different = 0;
    for (size_t i = 0; i < before.size(); ++i) different = std::max(different, different_pixels(after[i], before[i]));
    EXPECT_LE(different, exempt->different)
        << name << " takes effect after all; give it a context. It had none because " << exempt->reason;
    return;
  }
  const Context context = context_of(name, settings);
  ASSERT_FALSE(context.setting.empty()) << "give " << name
                                        << " a context in which it takes effect, or an exemption with its reason";
  const SettingList list = describe(settings);
  const Setting& setting = require_setting(list, name, "");
  const std::vector<Bits>& before = compared_frames(context, settings);
  int compared = 0;
  for (const std::string& other : context.others.empty() ? other_values(setting) : words(context.others)) {
    RenderSettings changed = settings;
    set(changed, name, other);
    if (name == "denoise" && !refusal(changed).empty()) continue;  // library not installed
    ++compared;
    EXPECT_TRUE(changes_bits(context, changed, before))
        << name << " = " << other << " gives the same bits as " << to_string(setting) << " with" << described(settings)
        << "; give it a context in which it takes effect, or an exemption with its reason";
  }
  EXPECT_GT(compared, 0) << "nothing to compare " << name << " with";
}

INSTANTIATE_TEST_SUITE_P(All, EverySetting, ::testing::ValuesIn(setting_names()), setting_name);

TEST(Contexts, NameExistingSettings) {
  const std::vector<std::string> names = setting_names();
  for (const Context& context : contexts()) {
    EXPECT_TRUE(std::any_of(names.begin(), names.end(), [&](const std::string& name) { return is_for(context, name); }))
        << context.setting;
  }
  for (const Exemption& exemption : kExemptions)
    EXPECT_NE(std::find(names.begin(), names.end(), exemption.setting), names.end()) << exemption.setting;
}

TEST(Contexts, TheCurtainLooksTheSameWithAnyRandomNumbers) {
  RenderSettings settings = small_settings(32, 32);
  settings.path.max_bounces = 0;
  RenderSettings reseeded = settings;
  reseeded.seed = 1;
  const Context curtain{{}, build_curtain};
  EXPECT_TRUE(rendered(curtain, reseeded) == rendered(curtain, settings));
}

}  // namespace
}  // namespace relume::support
