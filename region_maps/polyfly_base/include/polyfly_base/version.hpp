#pragma once

namespace polyfly {

/// Version of the project, which the manifests of all packages repeat.
constexpr char kVersion[] = "0.3.0";

}  // namespace polyfly
