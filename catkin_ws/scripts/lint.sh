# shellcheck shell=bash
# ./run lint: what a reviewer should not have to look for.

# Our C++ files, from git, so that nothing that was built is looked at.
cppFiles() { git ls-files --cached --others --exclude-standard "$@" | awk '/\.(cpp|hpp)$/'; }
checkFormat() { cppFiles "$@" | xargs -r clang-format --dry-run --Werror; }
checkNames() { python3 test/glossary_test.py; }
checkHeaderComments() { doxygen Doxyfile; }
clangBuild() { configurePreset clang && buildPreset clang all; }
clangTidy() { configurePreset clang && python3 catkin_ws/scripts/tidy.py build/clang build/tidy "$@"; }

# lintCommand [PATH...]: all, or the format and clang-tidy's findings below these.
lintCommand() {
  startCommand $(($# > 0 ? 3 : 5)) run lint
  own clang
  own tidy
  own doxygen
  step format "checking the formatting" checkFormat "$@"
  step names "checking names against the glossary" checkNames
  [ $# -gt 0 ] || step comments "checking the comments of public headers" checkHeaderComments
  [ $# -gt 0 ] || step clang "building with clang, every warning an error" clangBuild
  step tidy "looking with clang-tidy at what changed since it was found clean" clangTidy "$@"
  say "Nothing found."
}
