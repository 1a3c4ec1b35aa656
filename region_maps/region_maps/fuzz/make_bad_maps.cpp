// Writes the corpus of bad maps, and the good map that they derive from, as files for a fuzzer or another
// reader.
#include <filesystem>
#include <fstream>
#include <iostream>

#include "bad_maps.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/write_map.hpp"
#include "synthetic_map.hpp"

namespace {

void save(const std::filesystem::path& path, const std::vector<std::byte>& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file.flush()) throw polyfly::Error(path.string() + ": cannot be written");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: make_bad_maps DIR\n";
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    std::filesystem::create_directories(folder);
    std::size_t count = 0;
    for (const auto& maps : {polyfly::mapsWithBadFrame(), polyfly::mapsWithBadStructure()}) {
      for (const polyfly::BadMap& map : maps) {
        save(folder / (map.name + ".map"), map.bytes);
        ++count;
      }
    }
    save(folder / "good.map", polyfly::layOut(polyfly::makeSmallMap()));
    std::cout << folder.string() << ": " << count << " bad maps and good.map\n";
  } catch (const std::exception& error) {
    std::cerr << "make_bad_maps: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
