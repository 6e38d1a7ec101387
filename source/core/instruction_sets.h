#pragma once

// NSFD_CLONES before a function: it is compiled for several levels of x86-64,
// and the one for the processor at hand is chosen when the program starts. By
// level, not by processor: the names of processors are those of one vendor, and
// machines of another would get the oldest code.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define NSFD_CLONES                                                            \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
// NSFD_LEVEL_3, NSFD_LEVEL_4: for that level alone, and whether it is there;
// for what is called through a pointer. What it calls has to be NSFD_INLINE, a
// lambda NSFD_INLINED.
#define NSFD_LEVEL_4 __attribute__((target("arch=x86-64-v4")))
#define NSFD_LEVEL_3 __attribute__((target("arch=x86-64-v3")))
#define NSFD_HAS_LEVEL_4 __builtin_cpu_supports("x86-64-v4")
#define NSFD_HAS_LEVEL_3 __builtin_cpu_supports("x86-64-v3")
#define NSFD_INLINED __attribute__((always_inline))
#define NSFD_INLINE inline NSFD_INLINED
#else
#define NSFD_CLONES
#define NSFD_LEVEL_4
#define NSFD_LEVEL_3
#define NSFD_HAS_LEVEL_4 false
#define NSFD_HAS_LEVEL_3 true
#define NSFD_INLINED
#define NSFD_INLINE inline
#endif
