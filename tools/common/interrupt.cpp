#include "common/interrupt.h"

#include <csignal>

#include <signal.h>

#include "burnish/precompute/progress.h"

namespace burnish::tools {
namespace {

volatile std::sig_atomic_t stop_signal = 0;

extern "C" void request_stop(int signal_number) { stop_signal = signal_number; }

}  // namespace

void install_interrupt_handler() {
  for (const int number : {SIGINT, SIGTERM}) {
    struct sigaction action = {};
    if (sigaction(number, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = request_stop;
    // Reset: the second signal takes its default action. Restart: a write under way is not broken.
    action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(number, &action, nullptr);
  }
}

int interrupted() { return stop_signal; }

void throw_if_interrupted() {
  if (stop_signal != 0) throw Cancelled();
}

}  // namespace burnish::tools
