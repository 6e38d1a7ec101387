#pragma once

// NSFD_CLONES before a function: it is compiled for several levels of x86-64,
// and the one for the processor at hand is chosen when the program starts. By
// level, not by processor: the names of processors are those of one vendor, and
// machines of another would get the oldest code.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define NSFD_CLONES                                                            \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#define NSFD_INLINE inline __attribute__((always_inline))
#else
#define NSFD_CLONES
#define NSFD_INLINE inline
#endif
