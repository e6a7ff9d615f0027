// Compiled into every program of a sanitizer build: the runtimes look these functions up by name.

// Reports that are silenced belong to libraries that are not ours; each names its reason.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libhdf5_serial\n";  // HDF5 1.10 does not free what it had read of a damaged object
                                   // header
}

extern "C" const char* __asan_default_options() {
  return "detect_stack_use_after_return=1:strict_string_checks=1:check_initialization_order=1";
}

extern "C" const char* __ubsan_default_options() { return "print_stacktrace=1"; }
