#include "run_gnuplot.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "polyfly_base/error.hpp"

extern char** environ;

namespace polyfly {
namespace {

// Characters of gnuplot's message that an error quotes, at most.
constexpr std::size_t kMessageLength = 400;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using TemporaryFile = std::unique_ptr<std::FILE, CloseFile>;

// Files without a name instead of pipes: no deadlock when both sides write, and nothing to clean up.
TemporaryFile openTemporary() {
  TemporaryFile file(std::tmpfile());
  if (!file) {
    throw Error(std::string("gnuplot: cannot open a temporary file: ") + std::strerror(errno));
  }
  return file;
}

std::string contents(std::FILE* file) {
  std::string bytes;
  char buffer[65536];
  std::rewind(file);
  for (std::size_t count = 0; (count = std::fread(buffer, 1, sizeof buffer, file)) > 0;) {
    bytes.append(buffer, count);
  }
  return bytes;
}

class SpawnActions {
 public:
  SpawnActions() { posix_spawn_file_actions_init(&actions_); }
  ~SpawnActions() { posix_spawn_file_actions_destroy(&actions_); }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;
  void redirect(std::FILE* file, int to) { posix_spawn_file_actions_adddup2(&actions_, fileno(file), to); }
  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_;
};

int waitFor(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) {
      throw Error(std::string("gnuplot: cannot wait for it: ") + std::strerror(errno));
    }
  }
  return status;
}

}  // namespace

std::string runGnuplot(const std::string& script) {
  const TemporaryFile input = openTemporary();
  const TemporaryFile output = openTemporary();
  const TemporaryFile errors = openTemporary();
  if (std::fwrite(script.data(), 1, script.size(), input.get()) != script.size() ||
      std::fflush(input.get()) != 0) {
    throw Error(std::string("gnuplot: cannot write its commands: ") + std::strerror(errno));
  }
  std::rewind(input.get());

  SpawnActions actions;
  actions.redirect(input.get(), STDIN_FILENO);
  actions.redirect(output.get(), STDOUT_FILENO);
  actions.redirect(errors.get(), STDERR_FILENO);
  char program[] = "gnuplot";
  char defaults[] = "-d";  // leave the user's own gnuplot settings out
  char* arguments[] = {program, defaults, nullptr};
  pid_t child = 0;
  const int spawned = posix_spawnp(&child, program, actions.get(), nullptr, arguments, environ);
  if (spawned != 0) {
    throw Error(std::string("gnuplot: cannot be started (Debian package gnuplot-nox): ") +
                std::strerror(spawned));
  }
  const int status = waitFor(child);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw Error("gnuplot: failed: " + contents(errors.get()).substr(0, kMessageLength));
  }
  std::string image = contents(output.get());
  if (image.empty()) {
    throw Error("gnuplot: wrote no picture: " + contents(errors.get()).substr(0, kMessageLength));
  }
  return image;
}

}  // namespace polyfly
