// SPDX-License-Identifier: BSD-3-Clause
// fork, pipe, poll.
#include "physics/process_pool.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <exception>
#include <stdexcept>

namespace otg::physics {
namespace {

using Clock = std::chrono::steady_clock;

struct Running {
  std::size_t job;
  pid_t pid;
  int fd;
  Clock::time_point start;
  std::string output;
  bool tooSlow = false;
};

[[noreturn]] void runChild(int fd, const std::function<std::string(std::size_t)>& job, std::size_t index) {
  // The first byte says whether the rest is the result or what went wrong.
  std::string text;
  try {
    text += '+';
    text += job(index);
  } catch (const std::exception& e) {
    text = '-';
    text += e.what();
  }
  for (std::size_t written = 0; written < text.size();) {
    const ssize_t n = write(fd, text.data() + written, text.size() - written);
    if (n < 0 && errno != EINTR) break;
    if (n > 0) written += static_cast<std::size_t>(n);
  }
  // Nothing that the parent registered must run twice.
  _exit(0);
}

Running start(const std::function<std::string(std::size_t)>& job, std::size_t index) {
  int fds[2];
  if (pipe(fds) != 0) throw std::runtime_error(std::string("pipe: ") + std::strerror(errno));
  const pid_t pid = fork();
  if (pid < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
  if (pid == 0) {
    close(fds[0]);
    // ODE writes its messages to stderr before it aborts; the outcome says as much.
    if (!std::freopen("/dev/null", "w", stderr)) _exit(1);
    runChild(fds[1], job, index);
  }
  close(fds[1]);
  return {index, pid, fds[0], Clock::now(), {}};
}

JobOutcome finish(Running& running, double timeout) {
  close(running.fd);
  int status = 0;
  while (waitpid(running.pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (running.tooSlow) return {{}, fmt::format("took more than {:g} s", timeout)};
  if (WIFSIGNALED(status))
    return {{}, fmt::format("ended by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)))};
  if (running.output.empty()) return {{}, fmt::format("ended with status {}", WEXITSTATUS(status))};
  if (running.output[0] == '-') return {{}, running.output.substr(1)};
  return {running.output.substr(1), {}};
}

}  // namespace

void runInProcesses(std::size_t count, int workers, double timeout, const std::function<std::string(std::size_t)>& job,
                    const std::function<void(std::size_t, JobOutcome)>& done) {
  std::vector<Running> running;
  std::size_t next = 0;
  while (next < count || !running.empty()) {
    while (next < count && static_cast<int>(running.size()) < workers) running.push_back(start(job, next++));
    std::vector<pollfd> waiting;
    waiting.reserve(running.size());
    for (const Running& r : running) waiting.push_back({r.fd, POLLIN, 0});
    poll(waiting.data(), waiting.size(), 200);
    for (std::size_t i = running.size(); i-- > 0;) {
      Running& r = running[i];
      bool ended = false;
      if (waiting[i].revents != 0) {
        char bytes[65536];
        const ssize_t n = read(r.fd, bytes, sizeof bytes);
        if (n > 0) r.output.append(bytes, static_cast<std::size_t>(n));
        ended = n == 0 || (n < 0 && errno != EINTR);
      }
      if (!ended && !r.tooSlow && std::chrono::duration<double>(Clock::now() - r.start).count() > timeout) {
        kill(r.pid, SIGKILL);
        r.tooSlow = true;  // its end of the pipe closes, which ends it above
      }
      if (!ended) continue;
      JobOutcome outcome = finish(r, timeout);
      const std::size_t index = r.job;
      running.erase(running.begin() + static_cast<std::ptrdiff_t>(i));
      done(index, std::move(outcome));
    }
  }
}

}  // namespace otg::physics
