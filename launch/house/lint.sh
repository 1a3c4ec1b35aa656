# shellcheck shell=bash
# ./run lint: what a reviewer should not have to look for.

# Our C++ files, from git, so that nothing that was built is looked at.
cppFiles() { git ls-files --cached --others --exclude-standard '*.cpp' '*.hpp'; }
checkFormat() { cppFiles | xargs -r clang-format --dry-run --Werror; }
lintBuild() { configurePreset "$1" && buildPreset "$1" all; }

lintCommand() {
  planInstall run lint
  plan format 5
  planBuilding clang 120 clang
  planBuilding tidy 400 tidy
  requirePackages run lint
  own clang
  own tidy
  step format "checking the formatting" checkFormat
  step clang "building with clang, every warning an error" lintBuild clang
  step tidy "building with clang-tidy, every finding an error" lintBuild tidy
  say "Nothing found."
}
