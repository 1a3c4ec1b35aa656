#pragma once

namespace polyfly {

/// Calls work(context) on up to `threads` threads of TBB at once, the calling one among them, `threads` times
/// in all. A later call may begin when an earlier one has ended. `work` does not throw.
///
/// A file of its own, and no std::function, because the thread sanitizer must not look into it: TBB's library
/// is not built for it, so it misses how TBB orders things and would report races inside TBB. What `work`
/// does is checked like all else.
void runOnPool(int threads, void (*work)(void*), void* context);

}  // namespace polyfly
