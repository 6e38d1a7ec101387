#pragma once

namespace nsfd
{
  /**
   * Bytes that this process may still take: the least of what the machine has
   * free, of what the control groups of the process leave (a container, a job
   * of a batch system), and of its own limit of address space. What can be
   * taken back from caches of files counts as free. Infinite where nothing is
   * known.
   */
  double available_memory();
} // namespace nsfd
