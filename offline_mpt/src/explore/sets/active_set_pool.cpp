#include "explore/sets/active_set_pool.hpp"

#include <algorithm>
#include <limits>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kFirstSlots = 64;
// The table grows when more than kFull of kFullOf slots are taken.
constexpr std::size_t kFull = 3;
constexpr std::size_t kFullOf = 4;

std::uint32_t hashOf(RowSpan set) {
  std::uint64_t hash = 1469598103934665603ull ^ set.count;
  for (const std::uint16_t row : set) hash = (hash ^ row) * 1099511628211ull;
  hash ^= hash >> 32;
  hash *= 0x9e3779b97f4a7c15ull;
  return static_cast<std::uint32_t>(hash >> 32);
}

}  // namespace

ActiveSetPool::ActiveSetPool(CountedMemory& memory)
    : arena_(memory), sets_(&memory), table_(kFirstSlots, Slot{}, &memory) {}

// Where the set is in the table, or the free slot where it belongs.
std::size_t ActiveSetPool::placeOf(RowSpan set, std::uint32_t hash) const {
  const std::size_t mask = table_.size() - 1;
  std::size_t place = hash & mask;
  for (; table_[place].set != 0; place = (place + 1) & mask) {
    if (table_[place].hash != hash) continue;
    const RowSpan other = (*this)[table_[place].set - 1];
    if (std::equal(set.begin(), set.end(), other.begin(), other.end())) break;
  }
  return place;
}

void ActiveSetPool::prefetch(RowSpan set) const {
  __builtin_prefetch(&table_[hashOf(set) & (table_.size() - 1)]);
}

std::optional<std::uint32_t> ActiveSetPool::find(RowSpan set) const {
  const Slot& slot = table_[placeOf(set, hashOf(set))];
  if (slot.set == 0) return std::nullopt;
  return slot.set - 1;
}

bool ActiveSetPool::insert(RowSpan set) {
  if (sets_.size() == std::numeric_limits<std::uint32_t>::max()) {
    throw Error("exploration: more than 4294967295 active sets");
  }
  if ((sets_.size() + 1) * kFullOf > table_.size() * kFull) grow();
  const std::uint32_t hash = hashOf(set);
  const std::size_t place = placeOf(set, hash);
  if (table_[place].set != 0) return false;
  std::uint16_t* const copy = arena_.allocate(set.count + 1);
  copy[0] = static_cast<std::uint16_t>(set.count);
  std::copy(set.begin(), set.end(), copy + 1);
  sets_.push_back(copy);
  table_[place] = {size(), hash};
  return true;
}

void ActiveSetPool::grow() {
  std::pmr::vector<Slot> larger(2 * table_.size(), Slot{}, table_.get_allocator());
  const std::size_t mask = larger.size() - 1;
  for (const Slot& slot : table_) {
    if (slot.set == 0) continue;
    std::size_t place = slot.hash & mask;
    while (larger[place].set != 0) place = (place + 1) & mask;
    larger[place] = slot;
  }
  table_.swap(larger);
}

}  // namespace polyfly
