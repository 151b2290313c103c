// Contents of the files in lab/report/page.
#pragma once

#include <string_view>

namespace relume::page_assets {

extern const std::string_view kPage;    ///< HTML with @TITLE@, @STYLE@, @DATA@ and @SCRIPT@
extern const std::string_view kStyle;   ///< CSS
extern const std::string_view kScript;  ///< JavaScript

}  // namespace relume::page_assets
