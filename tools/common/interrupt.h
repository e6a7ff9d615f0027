#pragma once

namespace burnish::tools {

/// Makes the first SIGINT or SIGTERM a request to stop (see interrupted()); a second one ends the
/// program at once. A signal that was ignored when the program started stays ignored.
void install_interrupt_handler();

/// The signal that asked to stop, or 0.
int interrupted();

/// Throws Cancelled if a signal asked to stop. For the gaps between stages that have a Progress.
void throw_if_interrupted();

}  // namespace burnish::tools
