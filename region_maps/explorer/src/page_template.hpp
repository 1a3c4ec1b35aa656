#pragma once

namespace polyfly {

/// The page with the marks @FACTS@ and @MAP@, once each. embed_page.py writes it.
extern const char kPageTemplate[];

}  // namespace polyfly
