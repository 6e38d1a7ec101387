#pragma once

namespace nsfd
{
  /** Most that a process may use. */
  struct ProcessLimits {
    double seconds = 0.; ///< of CPU
    double memory = 0.;  ///< bytes of data
  };

  /**
   * From here on this process has these limits, leaves no core, cannot write a
   * byte to a file, and ends with the process that started it. Where the kernel
   * knows filters of system calls, it can start no program either, nor make,
   * change or remove files, nor open a socket.
   */
  void lock_process(const ProcessLimits &limits);
} // namespace nsfd
