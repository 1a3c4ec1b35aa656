# shellcheck shell=bash
# ./run package: Debian packages of this release, made of a copy of the sources, and tried in a clean root.

packages=build/packages

# copySources: what is to be packaged, in $packages/source, beside what was built there before.
copySources() {
  mkdir -p "$packages/source"
  find "$packages/source" -mindepth 1 -maxdepth 1 ! -name build -exec rm -rf {} + || return
  copyTree "$packages/source" || return
  fillInMaintainer "$packages/source"
}

# maintainer: "NAME <ADDRESS>", which the publisher writes into debian/maintainer; empty until then.
maintainer() { grep -v '^#' debian/maintainer | head -n 1 || true; }

forSed() { sed 's|[&/\\]|\\&|g' <<< "$1"; }

# fillInMaintainer FOLDER: into the files that name one.
fillInMaintainer() {
  local name address
  [[ "$(maintainer)" =~ ^(.+)\ \<(.+@.+)\>$ ]] || return 0
  name=$(forSed "${BASH_REMATCH[1]}") address=$(forSed "${BASH_REMATCH[2]}")
  find -L "$1"/{debian,catkin_ws/src/*} -maxdepth 1 \( -name control -o -name changelog -o -name package.xml \) \
    -exec sed -i "s/The Polyfly authors/$name/; s/polyfly@example.org/$address/" {} +
}

# debhelper has a home of its own; the compiler cache is that of ./run build.
buildPackages() {
  local cache
  cache=$(ccache --get-config cache_dir 2> /dev/null || true)
  rm -f "$packages"/*.deb "$packages"/*.changes "$packages"/*.buildinfo
  (cd "$packages/source" && CCACHE_DIR="${CCACHE_DIR:-$cache}" DEB_BUILD_OPTIONS="parallel=$(jobs_at_once) noautodbgsym" \
    dpkg-buildpackage --build=binary --no-sign --no-pre-clean)
}

lookAtPackages() { lintian --fail-on error,warning --info "$packages"/*.changes; }

# indexPackages: so that apt takes the folder as a repository.
indexPackages() { (cd "$packages" && dpkg-scanpackages --multiversion . > Packages); }

packageCommand() {
  startCommand 5 run package
  own packages
  step sources "copying the sources" copySources
  step packages "building the packages" buildPackages
  step lintian "looking at the packages with lintian" lookAtPackages
  step index "making the folder a repository for apt" indexPackages
  step package_root "installing and flying them in a clean root" runCheck packages test/package_test.sh "$packages"
  tail -n 1 build/.run/log/package_root.log
  [ "$(cat build/.run/results/packages.status)" -eq 0 ] || die "the packages failed in a clean root: build/.run/log/package_root.log"
  [ -n "$(maintainer)" ] || say "No maintainer: before you publish the packages, write your name and address into debian/maintainer."
  say "Packages: $(cd "$packages" && ls -- *.deb | tr '\n' ' ')"
  say "For apt: echo 'deb [trusted=yes] file:$root/$packages ./' > /etc/apt/sources.list.d/polyfly.list"
}
