// No setting is ignored: each has a context in which another value gives other bits. Rendering is deterministic to the
// bit, so nothing but the setting can have made the difference.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "render/build_pipeline.h"
#include "render/session.h"
#include "settings/rooms.h"
#include "support/measure.h"
#include "support/test_name.h"

namespace relume::support {
namespace {

/// What moves in the middle frames; before and after them pixels gather samples.
enum class Motion { none, camera, lamp };

/// Where a setting takes effect. What it has here is one of the values that are compared.
struct Context {
  /// A name, or a prefix that ends in a dot. A setting's own context adds its changes to those of the prefix; all else
  /// is its own.
  std::string_view setting;
  std::string_view with = "";    ///< changes from small_settings()
  std::string_view others = "";  ///< values to compare with; empty: what other_values() says
  Motion motion = Motion::none;
  std::string_view buffer = "";  ///< where to look: the picture, or a buffer of the last frame
  Scene (*scene)() = build_busy_room;
};

/// Prefixes stand before what they are completed by.
const Context kContexts[] = {
    {"width"},
    {"height"},
    {"camera", "", "side"},
    {"scene-time", "max-bounces=0", "1", Motion::none, "", build_curtain},  // random numbers depend on it too
    {"texture-filter"},
    {"seed"},
    {"stratify"},
    {"dither"},
    {"estimator"},
    {"lights", "static-lists.cell-size=2 static-lists.rays=64"},
    {"guide"},
    {"cache"},
    {"allocation", "adaptive.max=6"},
    {"history", "", "", Motion::camera},
    {"denoise"},
    {"max-bounces"},
    {"path."},
    {"bdpt.", "estimator=bdpt"},
    {"nee."},
    // A list of every lamp for each of many cells would take longer than all else together.
    {"static-lists.", "lights=static-lists static-lists.cell-size=2 static-lists.rays=64"},
    {"static-lists.rays", "", "4096"},  // a few rays more make no difference where there are many lights

    // Small pictures have few samples, and regions should be many.
    {"octree.", "lights=vlc octree.scale=off octree.split=64 octree.collapse=32"},
    {"octree.collapse", "octree.collapse=64", "", Motion::camera},
    // Only what is above a thousand samples a region is scaled down.
    {"octree.scale", "width=64 height=64 octree.vertices=4 octree.split=4096 octree.collapse=2048"},
    {"vlc.", "lights=vlc octree.scale=off octree.split=64 octree.collapse=32"},
    {"vlc.hysteresis", "vlc.bucket-size=4 vlc.memory=0"},  // numbers of buckets go up and down
    {"vlc.even-buckets", "vlc.bucket-size=4"},
    {"vlc.change-weight", "", "", Motion::lamp},
    {"cdq.", "guide=cdq octree.scale=off octree.split=64 octree.collapse=32"},
    // Every leaf must have samples, or what gives way weighs nothing.
    {"cdq.stability", "cdq.bits=32 octree.split=4096 octree.collapse=2048", "0.01"},
    {"cdq.view", "", "", Motion::none, "directions"},
    {"cdq.view-x", "cdq.view=on", "", Motion::none, "directions"},
    {"cdq.view-y", "cdq.view=on", "", Motion::none, "directions"},

    {"psf.", "cache=psf psf.cell-size=4"},
    {"psf.normal-bins", "", "0 1 8"},
    {"psf.direction-bins", "", "8"},
    {"psf.max-age", "psf.cell-size=1"},  // such cells have no samples in some frames
    {"psf.inherited-samples", "", "", Motion::camera},
    {"psf.thin-cells", "psf.cell-size=1"},
    {"psf.change-detection", "psf.change-detection=0.5", "0 4", Motion::lamp},
    {"psf.min-roughness", "", "0 1"},
    {"apsf.", "cache=apsf apsf.min-samples=16"},
    // "one" is what "automatic" stands for, and a step needs cells whose variance lies between the thresholds.
    {"apsf.blend", "apsf.blend-v1=6", "zero step one-over-square"},
    {"apsf.blend-v0", "apsf.blend=step apsf.blend-v1=6", "5"},
    {"apsf.blend-v1", "apsf.blend=step", "6"},
    {"apsf.survival-v0", "", "1"},
    {"apsf.survival-v1", "", "6"},
    {"apsf.survival-floor", "", "0.9"},
    {"apg.", "cache=apg"},

    {"adaptive.", "allocation=adaptive adaptive.max=6"},
    {"adaptive.max", "adaptive.method=paper", "32"},
    {"adaptive.exposure", "adaptive.metric=display", "8"},
    {"firefly.limit", "", "0.5 2"},
    {"reproject.", "history=reproject", "", Motion::camera},
    {"reproject.error", "", "0 1000", Motion::camera},
    {"reproject.light-error", "", "0.0001 1000", Motion::lamp},
    {"reproject.exposure", "", "-8 8", Motion::camera},
    {"reproject.max-distance", "", "0 1", Motion::camera},
    {"reproject.max-samples-changed", "", "", Motion::lamp},

    {"features.", "denoise=svgf"},
    {"bmfr.", "denoise=bmfr", "", Motion::camera},
    {"bmfr.max-history-changed", "", "", Motion::lamp},
    {"svgf.", "denoise=svgf", "", Motion::camera},
    {"svgf.max-history-changed", "", "", Motion::lamp},
};

/// What no context can show.
struct Exemption {
  std::string_view setting;
  std::string_view reason;
  std::string_view other;  ///< a value that is held to give the same bits
};
const Exemption kExemptions[] = {
    {"threads", "the same bits with any number of threads are a promise", "3"},
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

/// "name=value name=value"
void apply(std::string_view changes, RenderSettings& settings) {
  for (const std::string& change : words(changes)) {
    const size_t equals = change.find('=');
    set(settings, change.substr(0, equals), change.substr(equals + 1));
  }
}

/// The other names of a choice, the other of two truths, the least of an integer, half way there of a number; the next
/// one where that is the least already.
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

void move(Session& session, Motion motion, int step) {
  if (motion == Motion::lamp) session.set_time(0.2f * static_cast<float>(step));
  if (motion != Motion::camera) return;
  CameraPose camera = session.camera();
  camera.to_world[3] += Vec4(0.17f, 0.03f, -0.45f, 0);  // also nearer: cells of another size
  session.set_camera(camera);
}

using Bits = std::vector<std::byte>;

Bits rendered(const Context& context, const RenderSettings& settings) {
  constexpr int kStill = 4;  // frames before the motion
  constexpr int kMoving = 3;
  constexpr int kFrames = 8;
  Session session(context.scene(), settings);
  for (int frame = 0; frame < kFrames; ++frame) {
    if (frame >= kStill && frame < kStill + kMoving) move(session, context.motion, frame - kStill + 1);
    session.render_frame();
  }
  if (!context.buffer.empty()) {
    const Buffer* buffer = buffer_table(session).find(context.buffer);
    if (!buffer) throw std::runtime_error("there is no buffer " + std::string(context.buffer));
    return {buffer->bytes().begin(), buffer->bytes().end()};
  }
  const Image image = session.image();
  Bits bits(image.pixels.size() * sizeof(Rgb));
  std::memcpy(bits.data(), image.pixels.data(), bits.size());
  return bits;
}

std::vector<std::string> setting_names() {
  RenderSettings settings;
  std::vector<std::string> names;
  for (const Setting& setting : describe(settings)) names.push_back(setting.name);
  return names;
}

std::string setting_name(const ::testing::TestParamInfo<std::string>& info) { return test_name(info.param); }

/// The last of the contexts that are for a setting, with what all of them change. Without one, its name is empty.
Context context_of(std::string_view name, RenderSettings& settings) {
  Context found{""};
  for (const Context& context : kContexts) {
    if (!is_for(context, name)) continue;
    apply(context.with, settings);
    found = context;
  }
  return found;
}

/// The settings of a context, for messages.
std::string described(RenderSettings& settings) {
  RenderSettings plain = small_settings(settings.width, settings.height);
  const SettingList list = describe(settings);
  std::string text;
  for (const Setting* setting : differing_settings(list, describe(plain)))
    text += " " + setting->name + "=" + to_string(*setting);
  return text.empty() ? " the defaults" : text;
}

class EverySetting : public ::testing::TestWithParam<std::string> {};

TEST_P(EverySetting, TakesEffectSomewhere) {
  const std::string& name = GetParam();
  RenderSettings settings = small_settings(32, 32);
  if (const Exemption* exempt = exemption_of(name)) {
    RenderSettings changed = settings;
    set(changed, name, exempt->other);
    EXPECT_TRUE(rendered({name}, changed) == rendered({name}, settings))
        << name << " takes effect after all; give it a context. It had none because " << exempt->reason;
    return;
  }
  const Context context = context_of(name, settings);
  ASSERT_FALSE(context.setting.empty()) << "give " << name
                                        << " a context in which it takes effect, or an exemption with its reason";
  const SettingList list = describe(settings);
  const Setting& setting = require_setting(list, name, "");
  const Bits before = rendered(context, settings);
  int compared = 0;
  for (const std::string& other : context.others.empty() ? other_values(setting) : words(context.others)) {
    RenderSettings changed = settings;
    set(changed, name, other);
    if (name == "denoise" && !refusal(changed).empty()) continue;  // a library that is not installed
    ++compared;
    EXPECT_FALSE(rendered(context, changed) == before)
        << name << " = " << other << " gives the same bits as " << to_string(setting) << " with" << described(settings)
        << "; give it a context in which it takes effect, or an exemption with its reason";
  }
  EXPECT_GT(compared, 0) << "nothing to compare " << name << " with";
}

INSTANTIATE_TEST_SUITE_P(All, EverySetting, ::testing::ValuesIn(setting_names()), setting_name);

TEST(Contexts, AreOfSettingsThatExist) {
  const std::vector<std::string> names = setting_names();
  for (const Context& context : kContexts) {
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
  const Context curtain{"", "", "", Motion::none, "", build_curtain};
  EXPECT_TRUE(rendered(curtain, reseeded) == rendered(curtain, settings));
}

}  // namespace
}  // namespace relume::support
