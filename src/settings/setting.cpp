#include "settings/setting.h"

namespace relume {

SettingList with_prefix(std::string_view prefix, SettingList list) {
  for (Setting& setting : list) setting.name = std::string(prefix) + "." + setting.name;
  return list;
}

}  // namespace relume
