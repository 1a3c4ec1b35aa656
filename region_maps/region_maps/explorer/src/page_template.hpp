#pragma once

#include <initializer_list>
#include <string_view>

namespace polyfly {

/// The page in pieces, one after the other, with the marks @FACTS@ and @MAP@, once each. embed_page.py writes it.
extern const std::initializer_list<std::string_view> kPageTemplate;

}  // namespace polyfly
